# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array
from shapes import grid, on_faces, random_points


def test_gives_arrays_per_point(mesh, surface):
    found = dapple.project(surface, np.random.default_rng(0).normal(size=(70, 3)))
    check_array(found.positions, np.float64, (70, 3))
    check_array(found.faces, np.int32, (70,))
    check_array(found.barycentric, np.float64, (70, 3))
    check_array(found.distances, np.float64, (70,))
    there = on_faces(*mesh, found.faces, found.barycentric)
    np.testing.assert_allclose(found.positions, there, atol=1e-14)
    assert found.barycentric.min() >= 0


def test_is_no_farther_than_any_point_of_the_surface(mesh, surface):
    points = 2 * np.random.default_rng(1).uniform(-1, 1, (50, 3))
    found = dapple.project(surface, points)
    np.testing.assert_allclose(
        np.linalg.norm(found.positions - points, axis=1), found.distances, rtol=1e-13
    )
    others, _ = random_points(mesh, 20000, seed=2)
    nearest = np.linalg.norm(points[:, None] - others[None], axis=2).min(axis=1)
    assert np.all(found.distances <= nearest)
    assert np.all(found.distances >= nearest - 0.05)  # the density of the other points


def test_leaves_points_of_the_surface_where_they_are(mesh, surface):
    points, _ = random_points(mesh, 500)
    found = dapple.project(surface, points)
    assert found.distances.max() < 1e-14
    np.testing.assert_allclose(found.positions, points, atol=1e-14)


def test_gives_ties_to_the_lowest_face():
    vertices, faces = grid(4)
    for order in (np.arange(32), np.arange(32)[::-1], np.random.default_rng(3).permutation(32)):
        found = dapple.project(dapple.Surface(vertices, faces[order]), [[0.5, 0.5, 3.0]])
        middle = np.flatnonzero((faces[order] == 12).any(axis=1))
        assert found.faces[0] == middle.min()


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0), (1e6, 0), (1, 1e6)])
def test_does_not_depend_on_units(mesh, surface, scale, shift):
    points = np.random.default_rng(4).uniform(-1.5, 1.5, (200, 3))
    moved = dapple.project(dapple.Surface(scale * mesh[0] + shift, mesh[1]), scale * points + shift)
    expected = dapple.project(surface, points).distances
    np.testing.assert_allclose(moved.distances / scale, expected, atol=1e-13 + 1e-15 * shift)


def test_of_no_points(surface):
    assert dapple.project(surface, np.zeros((0, 3))).positions.shape == (0, 3)


@pytest.mark.parametrize(
    ("points", "match"),
    [
        ([[0, 0, 0], [0, 0, np.nan]], r"points\[1\].*nan"),
        ([[0, 0, 0], [0, 0, -np.inf]], r"points\[1\].*-inf"),
        ([[0, 0]], r"points.*\(1, 2\)"),
        ([0, 0, 0], r"points.*\(3,\)"),
    ],
)
def test_refuses(surface, points, match):
    with pytest.raises(ValueError, match=match):
        dapple.project(surface, points)
