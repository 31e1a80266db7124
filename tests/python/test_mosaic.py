# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles in Python: arrays, options, errors. Their geometry is tested in tests/native."""

import dapple3d as dapple
import numpy as np
import pytest
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
    made = dapple.mosaic(surface, samples, tolerance=0)
    energy = dapple.energy(surface, samples.positions, samples.faces)
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
    made = dapple.mosaic(surface, samples, merge=False, tolerance=0)
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
