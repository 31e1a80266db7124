# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals are those of the surface as it is shaded. The rules are tested in tests/native."""

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done


def cube(split: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """A cube of 12 triangles, of 8 vertices, or with four to each side as files have it."""
    vertices, faces = [], []
    for axis in range(3):
        for side in (-1.0, 1.0):
            corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
            for u, v in corners if side > 0 else corners[::-1]:
                vertices.append(np.roll([side, u, v], axis))
            k = len(vertices) - 4
            faces += [(k, k + 1, k + 2), (k, k + 2, k + 3)]
    points, triangles = np.array(vertices, dtype=float), np.array(faces)
    if split:
        return points, triangles
    unique, index = np.unique(points, axis=0, return_inverse=True)
    return unique, index.reshape(-1)[triangles]


def flat_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize("split", [False, True])
def test_samples_stand_upright_on_the_faces_of_a_cube(split):
    vertices, faces = cube(split)
    samples = dapple.sample(dapple.Surface(vertices, faces), 300)
    expected = flat_normals(vertices, faces)[samples.faces]
    np.testing.assert_allclose(samples.normals, expected, atol=1e-12)


def test_a_cube_is_judged_alike_with_welded_and_split_vertices():
    vertices, faces = cube()
    samples = dapple.sample(dapple.Surface(vertices, faces), 300)
    one = dapple.analyze(dapple.Surface(vertices, faces), samples)
    split = dapple.Surface(vertices[faces].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    other = dapple.analyze(split, dapple.Samples(split, samples.faces, samples.barycentric))
    for name in ("bond_order", "alpha_min", "alpha_mean", "capacity_variation"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-6), name


def test_edges_up_to_the_angle_are_smooth():
    vertices, faces = cube()
    smooth = dapple.Surface(vertices, faces, sharp_angle=90)
    assert smooth.sharp_angle == 90.0
    outward = vertices[faces] / np.sqrt(3.0)
    assert np.einsum("fki,fki->fk", smooth.corner_normals, outward).min() > 0.8


def test_given_normals_are_those_of_samples_and_stay_off_moved_surfaces():
    vertices, faces = cube()
    normals = np.broadcast_to(5.0 * np.array([0.6, 0.0, 0.8]), (len(faces), 3, 3))
    surface = dapple.Surface(vertices, faces, normals=normals)
    np.testing.assert_allclose(surface.corner_normals, normals / 5.0, atol=1e-15)
    samples = dapple.sample(surface, 20)
    np.testing.assert_allclose(samples.normals, normals[samples.faces, 0] / 5.0, atol=1e-12)
    moved = surface.deformed(vertices + 1.0)  # smooth, because the given normals have no jumps
    outward = vertices[faces] / np.sqrt(3.0)
    assert np.einsum("fki,fki->fk", moved.corner_normals, outward).min() > 0.8
    again = surface.deformed(vertices + 1.0, normals=normals)
    np.testing.assert_allclose(again.corner_normals, normals / 5.0, atol=1e-15)


def test_names_what_is_wrong_with_normals():
    vertices, faces = cube()
    with pytest.raises(ValueError, match=r"normals has the shape \(8, 3\): \(m, 3, 3\) is needed"):
        dapple.Surface(vertices, faces, normals=np.ones((8, 3)))
    with pytest.raises(dapple.SurfaceError, match="normals has 33 rows for 36 corners"):
        dapple.Surface(vertices, faces, normals=np.ones((11, 3, 3)))
    broken = np.ones((12, 3, 3))
    broken[2, 1, 0] = np.nan
    with pytest.raises(dapple.SurfaceError, match=r"normals\[7\] is not finite"):
        dapple.Surface(vertices, faces, normals=broken)
    with pytest.raises(dapple.SurfaceError, match="sharp_angle is 200"):
        dapple.Surface(vertices, faces, sharp_angle=200)


def test_the_command_line_gives_the_normals_that_edges_make(tmp_path):
    vertices, faces = cube()
    mesh, out = tmp_path / "cube.obj", tmp_path / "points.npz"
    dapple.write_mesh(mesh, vertices, faces)
    done("sample", mesh, out, "-n", "100")
    with np.load(out) as flat:
        assert np.abs(flat["normals"]).max(axis=1).min() > 1.0 - 1e-12
    done("sample", mesh, out, "-n", "100", "--sharp-angle", "90")
    with np.load(out) as smooth:
        assert np.abs(smooth["normals"]).max(axis=1).min() < 0.9
