# SPDX-License-Identifier: GPL-3.0-or-later
"""The spray brush of the add-on: which points a stroke adds or removes."""

import numpy as np
import pytest

from addon.core.base.errors import ScatterError
from addon.core.spray import Adding, Brush, Cells, Contact, Removing, kept_apart

UP = np.array([0.0, 0.0, 1.0])
BRUSH = Brush(radius=1.0, gap=0.2)


def on_plane(begins, ends):
    """Where lines meet the plane z = 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = begins[:, 2] / (begins[:, 2] - ends[:, 2])
        there = (share >= 0.0) & (share <= 1.0)
        places = begins + share[:, None] * (ends - begins)
    return np.where(there[:, None], places, np.nan), np.tile(UP, (len(begins), 1))


def at(x, y=0.0):
    return Contact(np.array([x, y, 0.0]), UP)


def nearest(points):
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    return apart.min(axis=1)


def stroke(brush=BRUSH, points=None, seed=0, pressure=1.0, dabs=9):
    made = Adding(np.empty((0, 3)) if points is None else points, brush, seed, on_plane)
    for k in range(dabs):
        made.dab(at(0.25 * k), pressure)
    return made.places


def lattice():
    x, y = np.meshgrid(np.linspace(-2.0, 4.0, 40), np.linspace(-2.0, 2.0, 30))
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])


def test_points_are_inside_the_stroke_and_apart_from_each_other():
    found = stroke()
    assert nearest(found).min() >= BRUSH.gap
    assert np.linalg.norm(found - np.clip(found, (0, 0, 0), (2, 0, 0)), axis=1).max() <= 1.0
    assert (found[0] == 0.0).all()


def test_a_stroke_is_packed_like_an_even_pattern():
    """Candidates in a random order would fill at most 0.603 of hexagonal packing."""
    found = stroke(Brush(radius=1.0, gap=0.1), dabs=25)
    inside = (np.abs(found[:, 1]) < 0.5) & (np.abs(found[:, 0] - 3.0) < 2.0)
    assert inside.sum() * np.sqrt(0.75) * 0.1**2 / 4.0 > 0.61
    assert nearest(found)[inside].std() < 0.08 * nearest(found)[inside].mean()


def test_points_that_are_there_keep_their_distance():
    there = np.random.default_rng(0).uniform((-1, -1, 0), (3, 1, 0), size=(60, 3))
    found = stroke(points=there)
    assert np.linalg.norm(found[:, None] - there[None], axis=2).min() >= BRUSH.gap
    assert len(stroke(points=lattice())) == 0


def test_the_same_seed_gives_the_same_points():
    assert (stroke(seed=3) == stroke(seed=3)).all()
    assert stroke(seed=3)[1:].tolist() != stroke(seed=4)[1:].tolist()


def test_pressure_takes_from_the_radius_or_from_the_strength():
    light = {"pressure": 0.3, "dabs": 1}
    assert len(stroke(dabs=1)) == len(stroke(**light))
    narrow = stroke(Brush(1.0, 0.2, pressure_sizes=True), **light)
    assert np.linalg.norm(narrow, axis=1).max() <= 0.3
    thin = Brush(1.0, 0.2, strength=0.1, pressure_strengthens=True)
    assert 1 <= len(stroke(thin, **light)) < 0.5 * len(stroke(dabs=1))
    for brush in (Brush(1.0, 0.2, pressure_sizes=True), thin):
        assert len(stroke(brush, pressure=0.0)) == 0
    assert len(stroke(Brush(1.0, 0.2, strength=0.0))) == 0


def test_a_small_brush_puts_a_point_where_it_is():
    (found,) = stroke(Brush(0.01, 0.2), dabs=1)
    assert (found == 0.0).all()


def test_a_face_seen_from_behind_is_passed_through():
    """A lid over the plane, as where the brush is inside a fold."""

    def under_lid(begins, ends):
        below, high = begins[:, 2] <= 0.3, np.array([0.0, 0.0, 0.3])
        places, normals = on_plane(begins, ends)
        lid = on_plane(begins - high, ends - high)[0] + high
        normals[~below] = -UP
        return np.where(below[:, None], places, lid), normals

    made = Adding(np.empty((0, 3)), BRUSH, 0, under_lid)
    made.dab(at(0.0))
    assert len(made.places) > 30
    assert np.abs(made.places[:, 2]).max() < 1e-12


def removed(brush=BRUSH, normals=None, pressure=1.0, dabs=1):
    points = lattice()
    made = Removing(points, np.tile(UP, (len(points), 1)) if normals is None else normals, brush, 0)
    for _ in range(dabs):
        made.dab(at(0.0), pressure)
    return made.chosen


def test_points_inside_the_brush_are_removed():
    inside = np.linalg.norm(lattice(), axis=1) <= 1.0
    assert (removed() == inside).all()
    assert not removed(normals=np.tile(-UP, (len(lattice()), 1))).any()
    assert (removed(Brush(1.0, 0.2, pressure_sizes=True), pressure=0.5).sum()) < inside.sum() / 3
    half = removed(Brush(1.0, 0.2, strength=0.5))
    assert 0.3 * inside.sum() < half.sum() < 0.7 * inside.sum()
    assert (removed(Brush(1.0, 0.2, strength=0.5), dabs=40) == inside).all()


@pytest.mark.parametrize("size", [0.05, 0.3, 2.0, 1e-300])
def test_cells_find_what_a_search_through_all_finds(size):
    rng = np.random.default_rng(1)
    points = rng.normal(size=(400, 3)) * (1.0, 2.0, 0.1)
    cells = Cells(points, size)
    for place in rng.normal(size=(30, 3)):
        for distance in (0.0, 0.5 * size, size, 1.5 * size):
            wanted = np.flatnonzero(np.linalg.norm(points - place, axis=1) <= distance)
            assert cells.within(place, distance).tolist() == wanted.tolist()
    assert not len(cells.within(np.full(3, 1e300), 1.0))
    assert not len(Cells(np.empty((0, 3)), 1.0).within(np.zeros(3), 1.0))


def test_nothing_is_left_that_could_be_added():
    candidates = np.random.default_rng(2).uniform(size=(500, 3))
    rows = kept_apart(candidates, np.zeros((1, 3)), 0.3)
    there = np.concatenate([candidates[rows], np.zeros((1, 3))])
    assert np.linalg.norm(candidates[:, None] - there[None], axis=2).min(axis=1).max() < 0.3
    assert kept_apart(np.empty((0, 3)), there, 0.3) == []


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_lengths_that_are_none_are_refused(bad):
    with pytest.raises(ScatterError, match="The radius of the brush must be a positive number"):
        Brush(bad, 0.2)
    with pytest.raises(ScatterError, match="The gap of the brush must be a positive number"):
        Brush(1.0, bad)
    if bad != 0.0:
        with pytest.raises(ScatterError, match="strength of the brush must be from 0 to 1"):
            Brush(1.0, 0.2, bad)
