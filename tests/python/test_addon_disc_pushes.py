# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a frame are pushed apart where their discs overlap."""

import dapple3d as dapple
import numpy as np
from shapes import grid

from addon.core.bake.disc_pushes import Places, allowed_on, pushed_apart
from addon.core.bake.overlaps import Discs, normals_of

RADII = np.array([0.08, 0.03, 0.0])


def crowd(count=150, seed=0):
    """Random discs on a square, many of which overlap."""
    surface = dapple.Surface(*grid(8))
    random = np.random.default_rng(seed)
    faces = random.integers(len(surface.faces), size=count).astype(np.int32)
    places = Places(faces, random.dirichlet((1.0, 1.0, 1.0), count))
    classes = np.repeat(np.arange(3, dtype=np.int32), count // 3)
    classes[10 : count // 3] = 2
    return surface, discs_of(surface, places, classes), places


def discs_of(surface, places, classes):
    corners = surface.vertices[surface.faces[places.faces]]
    points = np.einsum("nk,nkd->nd", places.barycentric, corners)
    ids = np.arange(len(points), dtype=np.int32)
    return Discs(points, normals_of(corners), RADII[classes], classes, ids)


def anywhere(rows, _places):
    return np.ones(len(rows), dtype=bool)


def test_discs_that_have_room_do_not_overlap():
    surface, discs, places = crowd()
    assert discs.worst(3)[0].max() > 0.5
    after = pushed_apart(discs, places, lambda: surface, anywhere)
    found = discs_of(surface, after, discs.classes)
    assert found.worst(3)[0].max() < 0.003
    far = np.linalg.norm(found.points - discs.points, axis=1)
    assert far.max() < 0.3
    assert (far == 0.0).sum() > 30  # those that are not in the way


def test_discs_that_do_not_overlap_stay_where_they_are():
    surface, discs, places = crowd()
    after = pushed_apart(discs, places, lambda: surface, anywhere)
    again = discs_of(surface, after, discs.classes)
    assert pushed_apart(again, after, lambda: surface, anywhere) is after


def test_points_are_not_pushed_off_their_density():
    corners, faces = grid(8)
    middle = np.median(corners[:, 0])
    left = (corners[:, 0] <= middle + 1e-9).astype(float)
    masked = dapple.density.MaskedSurface(dapple.Surface(corners, faces, left), count=100)
    surface, discs, places = crowd()
    allowed = allowed_on(masked, discs.classes, ["", "", ""])
    before = allowed(np.arange(150), places)
    after = pushed_apart(discs, places, lambda: surface, allowed)
    now = allowed(np.arange(150), after)
    assert now[before].all()
    assert 20 < before.sum() < 130
