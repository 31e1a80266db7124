# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks on the command line: points are in the range and nowhere else, on the faces of the file."""

import json
import math

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done, refused, run
from dapple3d.cli import points
from dapple3d.density import Nearest, border_edges, noise
from mask_checks import CUBE, CUBE_FACES, SQUARE, TWO
from shapes import grid, torus


@pytest.fixture
def square(tmp_path):
    """Two large faces, with two densities."""
    path = tmp_path / "square.npz"
    np.savez(path, vertices=SQUARE, faces=TWO, left=[1.0, 0, 0, 1.0], half=[1.0, 0.5])
    return path


@pytest.fixture
def ring(tmp_path):
    path = tmp_path / "ring.npz"
    vertices, faces = torus(60, 30)
    np.savez(path, vertices=vertices, faces=faces)
    return path


def sampled(mesh, *arguments, count=300):
    out = mesh.parent / "out.npz"
    done("sample", mesh, out, "-n", count, *arguments)
    found = points.read_points(out)
    with np.load(mesh) as arrays:
        surface = dapple.Surface(arrays["vertices"], arrays["faces"])
    assert len(found.positions) == count
    assert found.faces.max() < len(surface.faces)
    there = np.einsum("nk,nkd->nd", found.barycentric, surface.vertices[surface.faces[found.faces]])
    np.testing.assert_allclose(found.positions, there, atol=1e-6), "on the faces of the file"
    return found, surface


def spacing_of(surface, count=300):
    return math.sqrt(2 * surface.area / (math.sqrt(3) * count))


def test_a_sharp_slope_has_all_points_on_the_faces_in_it(tmp_path):
    cube = tmp_path / "cube.npz"
    np.savez(cube, vertices=CUBE, faces=CUBE_FACES)
    for low, high, z in ((0, 45, 1.0), (135, 180, -1.0)):
        found, _ = sampled(cube, "--slope", low, high)
        np.testing.assert_allclose(found.positions[:, 2], z)
    found, _ = sampled(cube, "--slope", 90, 90)  # both ends are included
    assert (np.abs(found.positions[:, :2]).max(axis=1) > 1 - 1e-12).all()
    found, _ = sampled(cube, "--slope", 0, 45, "--slope-invert")
    assert (found.positions[:, 2] < 1 - 1e-12).all() or found.normals[:, 2].max() < 0.5


def test_an_end_of_a_slope_holds_for_coordinates_in_single_precision(tmp_path):
    tipped = tmp_path / "tipped.npz"
    turn = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    np.savez(tipped, vertices=(SQUARE @ turn.T * 1.1).astype(np.float32), faces=TWO)
    angle = math.degrees(math.acos(0.8))
    sampled(tipped, "--slope", 0, angle)
    sampled(tipped, "--slope", angle, 180)
    assert "--slope" in refused("sample", tipped, tmp_path / "o.npz", "-n", 9, "--slope", 0, 36)


def test_heights_have_no_points_beyond_either_end(ring):
    found, surface = sampled(ring, "--height", -0.1, 0.2)
    z = found.positions[:, 2]
    assert (z.min(), z.max()) == pytest.approx((-0.1, 0.2), abs=0.5 * spacing_of(surface))
    off = 0.01 * spacing_of(surface)
    assert ((z > -0.1 - off) & (z < 0.2 + off)).all()
    above, _ = sampled(ring, "--height", 0.2, "inf")
    assert above.positions[:, 2].min() > 0.2 - off
    outside, _ = sampled(ring, "--height", -0.1, 0.2, "--height-invert")
    assert not (
        (outside.positions[:, 2] > -0.1 + off) & (outside.positions[:, 2] < 0.2 - off)
    ).any()


def test_a_floor_at_the_end_of_a_height_is_in_it(tmp_path):
    cube = tmp_path / "cube.npz"
    np.savez(cube, vertices=CUBE, faces=CUBE_FACES)
    found, _ = sampled(cube, "--height", 1, 5)
    np.testing.assert_allclose(found.positions[:, 2], 1.0)


def test_a_falloff_thins(square):
    found, _ = sampled(square, "--border", 0, 0.2, "--border-falloff", 1.8, count=2000)
    away = 2 - np.abs(found.positions[:, :2]).max(axis=1)
    counts, _ = np.histogram(away, [0.0, 0.2, 0.8, 1.4, 2.0])
    ring = np.array([2.0, 1.8, 1.2, 0.6, 0.0])
    area = 4 * (ring[:-1] ** 2 - ring[1:] ** 2)
    assert (np.diff(counts / area) < 0).all()


def test_strength_leaves_a_share(square):
    found, _ = sampled(square, "--border", 0, 0.5, "--border-strength", 0.75, count=2000)
    inner = np.abs(found.positions[:, :2]).max(axis=1) < 1.5
    assert inner.mean() == pytest.approx(9 * 0.25 / (7 + 9 * 0.25), abs=0.02)


@pytest.mark.parametrize("suffix", ["obj", "csv", "npz", "ply"])
def test_distances_to_meshes_and_to_points(square, tmp_path, suffix):
    at = np.array([[0.5, 0.5, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.2, 0.0]])
    path = tmp_path / f"target.{suffix}"
    if suffix == "obj":
        dapple.write_mesh(path, at, np.array([[0, 1, 2]], dtype=np.int32))
        nearest = Nearest([(at, np.array([[0, 1, 2]], dtype=np.int32))])
    else:
        points.write_points(path, points.Points(positions=at))
        nearest = Nearest(segments=np.repeat(at[:, None], 2, axis=1))
    found, surface = sampled(square, "--distance", path, 0.2, 0.7)
    apart = nearest.distances(found.positions)
    off = 0.1 * spacing_of(surface)
    assert ((apart > 0.2 - off) & (apart < 0.7 + off)).all()
    raised = tmp_path / f"raised.{suffix}"
    if suffix == "obj":
        dapple.write_mesh(raised, at + np.array([0, 0, 9.0]), np.array([[0, 1, 2]], dtype=np.int32))
    else:
        points.write_points(raised, points.Points(positions=at + np.array([0, 0, 9.0])))
    again, _ = sampled(square, "--distance", raised, 0.2, 0.7, "--distance-ignore-height")
    np.testing.assert_allclose(again.positions, found.positions, atol=1e-6)


def test_patches_of_noise_and_their_seed(square):
    found, _ = sampled(square, "--noise", 0.5, 1, "--noise-size", 0.7, count=1000)
    values = noise(found.positions / 0.7, 2, 0)
    assert (values > 0.4).all()
    other, _ = sampled(
        square, "--noise", 0.5, 1, "--noise-size", 0.7, "--noise-seed", 4, "--noise-detail", 0,
        count=1000,
    )  # fmt: skip
    assert (noise(other.positions / 0.7, 0, 4) > 0.45).all()
    assert (noise(other.positions / 0.7, 2, 0) < 0.4).any()


def test_aspect_is_of_the_compass(ring):
    found, _ = sampled(ring, "--aspect", 90, 0, 30, "--slope", 20, 160)
    east = np.degrees(np.arctan2(found.normals[:, 1], found.normals[:, 0]))
    assert np.abs(east).max() < 40


def test_masks_and_a_density_are_multiplied(square):
    found, _ = sampled(square, "--density", "left", "--border", 0.5, "inf")
    assert (np.abs(found.positions[:, :2]) < 1.5 + 1e-2).all()
    assert found.positions[:, 0].mean() < -0.2


def test_a_spacing_is_that_in_the_masks(square, tmp_path):
    out, report = tmp_path / "out.npz", tmp_path / "report.json"
    done("sample", square, out, "--spacing", 0.1, "--border", 1, "inf", "--json", report)
    told = json.loads(report.read_text())
    exact = 4 / (math.sqrt(3) / 2 * 0.1**2)
    assert told["settings"]["count"] == pytest.approx(exact, rel=0.02)
    assert told["settings"]["masks"] == {"border": [1.0, "inf"]}
    assert told["input"]["faces"] == 2


def test_the_same_bytes_on_any_number_of_threads(square, tmp_path):
    for threads in (1, 2):
        done("sample", square, tmp_path / f"{threads}.npz", "-n", 200, "--noise", 0.3, 0.9,
             "--noise-size", 0.5, "--border", 0.2, "inf", "--threads", threads)  # fmt: skip
    assert (tmp_path / "1.npz").read_bytes() == (tmp_path / "2.npz").read_bytes()


def test_classes_have_their_densities_in_the_masks(square, tmp_path):
    out = tmp_path / "out.npz"
    done("classes", square, out, "--class", "100:density=left", "--class", "150:radius=0.02",
         "--density", "half", "--border", 0.5, "inf")  # fmt: skip
    found = points.read_points(out)
    np.testing.assert_array_equal(np.bincount(found.classes), [100, 150])
    assert (np.abs(found.positions[:, :2]) < 1.5 + 0.02).all()
    assert found.faces.max() < 2
    first, second = (found.positions[found.classes == k] for k in (0, 1))
    assert first[:, 0].mean() < -0.2
    assert (second[:, 0] > second[:, 1]).mean() == pytest.approx(2 / 3, abs=0.08)


def test_resample_and_relax_keep_to_the_masks(square, tmp_path):
    before, out = tmp_path / "before.npz", tmp_path / "after.npz"
    done("sample", square, before, "-n", 300)
    done("resample", square, before, out, "-n", 200, "--border", 0.5, "inf")
    found = points.read_points(out)
    assert len(found.positions) == 200
    assert (np.abs(found.positions[:, :2]) < 1.5 + 0.02).all()
    assert found.faces.max() < 2
    done(
        "relax", square, before, out, "--changed", "0,1", "--height", -1, 1, "--border", 0.5, "inf"
    )
    found = points.read_points(out)
    assert (np.abs(found.positions[:, :2]) < 1.5 + 0.02).all()
    assert found.faces.max() < 2
    done("relax", square, before, out, "--changed", "0", "--class", "250", "--border", 0.5, "inf")
    assert len(points.read_points(out).positions) == 250


@pytest.mark.parametrize("together", [(), ("--together",)])
def test_masks_go_with_a_motion(tmp_path, together):
    vertices, faces = grid(8)
    frames = [vertices + np.array([0, 0, 0.1]) * k * np.sin(3 * vertices[:, :1]) for k in range(3)]
    walk, out = tmp_path / "walk.npz", tmp_path / "out.npz"
    np.savez(walk, vertices=frames, faces=faces)
    done("track", walk, out, "-n", 150, "--border", 0.2, "inf", *together)
    with np.load(out) as found:
        assert found["positions"].shape == (3, 150, 3)
        for k, moved in enumerate(frames):
            there = moved[faces[found["faces"][k]]]
            there = np.einsum("nk,nkd->nd", found["barycentric"][k], there)
            np.testing.assert_allclose(found["positions"][k], there, atol=1e-9)
            flat = np.einsum(
                "nk,nkd->nd", found["barycentric"][k], vertices[faces[found["faces"][k]]]
            )
            assert (np.abs(flat[:, :2] - 0.5) < 0.3 + 0.01).all()
    found = run("track", walk, out, "-n", 9, "--keep-density", "--slope", 0, 9)
    assert found.exit_code == 2
    assert "not with --keep-density" in found.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--slope", 45, 0), "'--slope': MIN is 45, MAX 0: MIN must not be larger than MAX"),
        (("--slope", 0, 200), "200.0 is not in the range 0.0<=x<=180.0"),
        (("--height", "nan", 1), "nan is not a number"),
        (("--height", 0, 1, "--height-falloff", -1), "-1.0 is not in the range x>=0.0"),
        (("--height", 0, 1, "--height-falloff", "inf"), "inf is not a finite number"),
        (("--border", -1, 1), "-1.0 is not in the range x>=0.0"),
        (("--noise", 0, 1.5), "1.5 is not in the range 0.0<=x<=1.0"),
        (("--noise", 0, 1, "--noise-size", 0), "0.0 is not in the range x>0.0"),
        (("--aspect", "inf", 0, 10), "inf is not a finite number"),
        (("--slope-falloff", 3), "--slope-falloff needs --slope"),
        (("--noise-size", 3), "--noise-size needs --noise"),
        (("--distance", "none.obj", 0, 1), "'none.obj' does not exist"),
        (("--height", 1), "'--height' requires 2 arguments"),
    ],
)
def test_faults_in_options_are_named(square, tmp_path, arguments, said):
    found = run("sample", square, tmp_path / "out.npz", "-n", 9, *arguments)
    assert found.exit_code == 2, found.output
    assert said in found.stderr.replace("\n", " ")


def test_a_mask_that_leaves_nothing_names_file_and_options(square, ring, tmp_path):
    out = tmp_path / "out.npz"
    said = refused("sample", square, out, "-n", 9, "--height", 1, 2, "--slope", 0, 180)
    assert said == (
        f"Error: {square}, in --slope, --height: density is 0 wherever the faces have area: "
        "nothing can be placed\n"
    )
    said = refused("sample", ring, out, "-n", 9, "--border", 0, 1)
    assert said == f"Error: {ring}: is closed, so it has no border for --border\n"
    target = tmp_path / "target.npz"
    np.savez(target, vertices=SQUARE, faces=TWO + 2)
    assert refused("sample", square, out, "-n", 9, "--distance", target, 0, 1).startswith(
        f"Error: {target}: "
    )
    assert "is read as an input" in refused(
        "sample", square, square, "-n", 9, "--distance", square, 0, 1
    )
    assert not out.exists()


@pytest.mark.parametrize("name", ["sample", "classes", "relax", "resample", "track"])
def test_help_has_a_section_of_masks(name):
    text = done(name, "--help").stdout
    options, masks = text.split("\nMasks:\n")
    assert "--slope" not in options.split("\nOptions:\n")[1]
    for mask in ("slope", "height", "distance", "border", "aspect", "noise"):
        assert f"--{mask}-falloff" in masks


@pytest.mark.parametrize(("mesh_file", "low", "high"), [("face", 0.1, 0.3), ("lilium", 0.02, 0.1)])
def test_found_meshes_by_border_and_height(data, tmp_path, mesh_file, low, high):
    path = data / "meshes" / f"{mesh_file}.ply"
    surface = dapple.Surface(*dapple.read_mesh(path))
    size = float(np.ptp(surface.vertices, axis=0).max())
    out = tmp_path / "out.npz"
    done("sample", path, out, "-n", 400, "--border", low * size, high * size)
    found = points.read_points(out)
    away = Nearest(segments=border_edges(surface.vertices, surface.faces)).distances(
        found.positions
    )
    off = 0.1 * found_spacing(surface, 400)
    assert len(away) == 400
    assert ((away > low * size - off) & (away < high * size + off)).all()
    z = surface.vertices[:, 2]
    low_z, high_z = np.quantile(z, [0.4, 0.7])
    done("sample", path, out, "-n", 400, "--height", low_z, high_z, "--slope", 0, 120)
    found = points.read_points(out)
    heights = found.positions[:, 2]
    assert ((heights > low_z - off) & (heights < high_z + off)).all()


def found_spacing(surface, count):
    return math.sqrt(2 * surface.area / (math.sqrt(3) * count))
