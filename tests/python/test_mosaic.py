# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles in Python: arrays, options, errors. Their geometry is tested in tests/native."""

import warnings

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from checks import check_array


def polygons(mosaic):
    return np.split(mosaic.corners, mosaic.starts[1:-1])


def area(mosaic, polygon) -> float:
    points = mosaic.vertices[polygon]
    return float(np.linalg.norm(np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)) / 2)


def test_arrays(surface, samples):
    spacing = samples.report.spacing
    made = dapple.mosaic(surface, samples, grout=0.1 * spacing)
    check_array(made.vertices, np.float64, (len(made.vertices), 3))
    check_array(made.starts, np.int32, (len(made) + 1,))
    check_array(made.corners, np.int32, (made.starts[-1],))
    for name in ("sites", "classes", "faces", "sides"):
        check_array(getattr(made, name), np.int32, (len(made),))
    for name, kind in (("areas", float), ("cell_areas", float), ("parts", int), ("loops", int)):
        assert getattr(made, name).shape == (len(samples),)
        assert np.issubdtype(getattr(made, name).dtype, np.dtype(kind).type.__mro__[1])
    assert (np.diff(made.starts) >= 3).all()
    assert made.corners.max() == len(made.vertices) - 1
    assert set(made.sites) == set(range(len(samples)))
    assert not made.sides.any()


def test_areas_are_those_of_the_polygons(surface, samples):
    made = dapple.mosaic(surface, samples, grout=0.1 * samples.report.spacing)
    found = np.bincount(made.sites, [area(made, polygon) for polygon in polygons(made)])
    np.testing.assert_allclose(found, made.areas, rtol=1e-9)
    np.testing.assert_allclose(made.cell_areas.sum(), surface.area, rtol=1e-9)
    assert (made.areas < made.cell_areas).all()


def test_cells_are_those_of_the_energy(surface, samples):
    made = dapple.mosaic(surface, samples, shortest_edge=0)
    energy = dapple.evaluate_energy(surface, samples.positions, samples.faces)
    np.testing.assert_allclose(made.cell_areas, energy.capacities, rtol=1e-9)
    np.testing.assert_allclose(made.areas, energy.capacities, rtol=1e-6)


def test_classes_and_sides(surface):
    samples = dapple.sample_classes(
        surface, [dapple.SampleClass(30), dapple.SampleClass(10)], max_evaluations=3
    )
    made = dapple.mosaic(surface, samples, grout=0.01, thickness=0.02)
    np.testing.assert_array_equal(made.classes, samples.classes[made.sites])
    assert set(made.sides) == {0, 1, 2}
    assert (made.sides == 0).sum() == (made.sides == 2).sum()


def test_insets(surface, samples):
    insets = np.zeros(len(samples))
    insets[7] = 0.2 * samples.report.spacing
    plain = dapple.mosaic(surface, samples)
    made = dapple.mosaic(surface, samples, insets=insets)
    changed = np.flatnonzero(~np.isclose(made.areas, plain.areas, rtol=1e-12))
    assert changed.tolist() == [7]


def test_pieces_are_convex_without_merging(surface, samples):
    made = dapple.mosaic(surface, samples, merge=False, shortest_edge=0)
    assert len(made) > len(surface.faces)
    for polygon, face in zip(polygons(made), made.faces, strict=True):
        corners = surface.vertices[surface.faces[face]]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        edges = np.roll(made.vertices[polygon], -1, axis=0) - made.vertices[polygon]
        turns = np.cross(edges, np.roll(edges, -1, axis=0)) @ (normal / np.linalg.norm(normal))
        assert turns.min() > -1e-9


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"grout": -1}, "grout is -1: it must be finite and >= 0"),
        ({"thickness": np.nan}, "thickness is nan"),
        ({"insets": [0.0]}, "insets has 1 entries and samples has 300"),
        ({"insets": np.full(300, -0.5)}, r"insets\[0\] is -0.5"),
        ({"insets": np.zeros((300, 2))}, r"insets has the shape \(300, 2\)"),
        ({"cells": "square"}, "cells is 'square'"),
    ],
)
def test_refuses(surface, samples, options, message):
    with pytest.raises(ValueError, match=message):
        dapple.mosaic(surface, samples, **options)


def test_cancel(surface, samples):
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.mosaic(surface, samples, context=context)


def open_edges(mosaic) -> int:
    """Edges that no other polygon has the other way around, where vertices at one place are one."""
    _, places = np.unique(mosaic.vertices, axis=0, return_inverse=True)
    ends = [
        (a, b)
        for polygon in polygons(mosaic)
        for a, b in zip(*(places.ravel()[np.roll(polygon, k)] for k in (0, -1)), strict=True)
    ]
    there = {end: 0 for end in ends}
    for a, b in ends:
        there[a, b] += 1
    return sum(count != there.get((b, a), 0) for (a, b), count in there.items())


def cube(cuts: int) -> dapple.Surface:
    """Sides of so many squares along each edge, each with vertices of its own."""
    steps = np.arange(cuts + 1) / cuts
    u, v = (axis.ravel() for axis in np.meshgrid(steps, steps, indexing="ij"))
    corner = (np.arange(cuts)[:, None] * (cuts + 1) + np.arange(cuts)).ravel()
    far = corner + cuts + 2
    squares = [[corner, corner + cuts + 1, far], [corner, far, corner + 1]]
    faces = np.stack(squares, axis=2).T.reshape(-1, 3)
    vertices, all_faces = [], []
    for axis in range(3):
        for side in (0.0, 1.0):
            places = np.roll(np.stack([np.full(len(u), side), u, v], axis=1), axis, axis=1)
            vertices.append(places)
            all_faces.append(faces[:, :: 1 if side else -1] + len(all_faces) * len(u))
    return dapple.Surface(np.concatenate(vertices), np.concatenate(all_faces))


@pytest.mark.parametrize("given", [
    {}, {"merge": False}, {"shortest_edge": 0.0}, {"shortest_edge": 0.1}, {"cells": "euclidean"},
    {"insets": np.zeros(500)},
], ids=str)  # fmt: skip
@pytest.mark.parametrize("thin", [1.0, 0.02])
def test_tiles_without_grout_are_closed_where_they_touch(given, thin):
    """Tiles removed their short edges one by one, each to a place of its own."""
    vertices, faces = shapes.torus(48, 24)
    for surface in (dapple.Surface(vertices * [1, 1, thin], faces), cube(1), cube(6)):
        samples = dapple.sample(surface, 500, max_evaluations=20)
        assert open_edges(dapple.mosaic(surface, samples, **given)) == 0


def test_tiles_without_grout_are_closed_but_for_the_border():
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(9.0), np.arange(9.0)))
    vertices = np.stack([x, y, np.sin(x)], axis=1)
    corner = (np.arange(8)[:, None] * 9 + np.arange(8)).ravel()
    faces = np.concatenate([
        np.stack([corner, corner + 1, corner + 10], axis=1),
        np.stack([corner, corner + 10, corner + 9], axis=1),
    ])  # fmt: skip
    surface = dapple.Surface(vertices, faces)
    made = dapple.mosaic(surface, dapple.sample(surface, 60), merge=False)
    around = 0
    for polygon in polygons(made):
        for a, b in zip(made.vertices[polygon], made.vertices[np.roll(polygon, -1)], strict=True):
            around += any(a[k] == b[k] and a[k] in (0.0, 8.0) for k in (0, 1))
    assert open_edges(made) == around


def test_two_sheets_at_one_place_stay_apart():
    """Points of both are at the same place, but no edge leads from one to the other."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    vertices = np.concatenate([square, square])
    faces = [[0, 1, 2], [0, 2, 3], [5, 4, 6], [6, 4, 7]]
    surface = dapple.Surface(vertices, faces, weld=None, merge_doubled=False)
    made = dapple.mosaic(surface, dapple.sample(surface, 40))
    assert made.areas.sum() == pytest.approx(2.0, rel=1e-6)


def test_a_grout_that_takes_whole_tiles_is_said(surface, samples):
    spacing = samples.report.spacing
    with pytest.warns(
        UserWarning, match=rf"^{len(samples)} of {len(samples)} tiles are empty: nothing"
    ):
        made = dapple.mosaic(surface, samples, grout=2.0 * spacing)
    assert made.empty == len(samples)
    insets = np.zeros(len(samples))
    insets[:3] = spacing
    with pytest.warns(UserWarning, match=rf"^3 of {len(samples)} tiles are empty: nothing is left"):
        made = dapple.mosaic(surface, samples, insets=insets)
    assert made.empty == 3
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert dapple.mosaic(surface, samples, grout=0.1 * spacing).empty == 0
        assert dapple.mosaic(surface, samples).empty == 0
