# SPDX-License-Identifier: GPL-3.0-or-later
"""From samples to bindings and back."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import package
from .arrays import Floats, Ints, SurfaceArrays
from .frames import frames, shading, transport
from .records import Binding, Placed


def attached_to(surface: SurfaceArrays, faces: Ints, weights: Floats) -> Binding:
    """Binding to faces (n,) of a surface, with barycentrics (n, 3); no angle carried yet."""
    corners, loops = surface.faces[faces], surface.face_corners[faces]
    return Binding(corners, np.asarray(weights), np.zeros(len(corners)), loops)


def binding_of(samples: Any, surface: SurfaceArrays) -> Binding:
    """Binding of dapple.Samples of a surface; no angle carried yet."""
    return attached_to(surface, samples.faces, samples.barycentric)


def placed_of(samples: Any, surface: SurfaceArrays) -> Placed:
    """Where dapple.Samples sit, with the triangles that a key stores."""
    return Placed(np.asarray(samples.faces, dtype=np.int32), binding_of(samples, surface))


def samples_of(binding: Binding, surface: Any, ids: Ints, classes: Ints) -> Any:
    """dapple.Samples of a stored binding on a dapple.Surface.

    A quad may be cut along its other diagonal now than when the points were bound; points whose
    triangle is no longer there take the closest place of the surface.
    """
    faces, weights = _matched(binding, surface.faces)
    lost = faces < 0
    if lost.any():
        points = binding.positions(surface.vertices)[lost]
        closest = package().project(surface, points)
        faces[lost], weights[lost] = closest.faces, closest.barycentric
    return package().Samples(surface, faces, weights, ids=ids, classes=classes)


def rebound(before: Binding, first: SurfaceArrays, surface: SurfaceArrays) -> Binding:
    """Binding to the places of another surface that are nearest to points bound to the first.

    The directions that the points carry are turned as little as the normals ask for.
    """
    old = frames(before, first.vertices, shading(first))
    after = bound_nearest(before.positions(first.vertices), surface)
    new = frames(after, surface.vertices, shading(surface))
    direction = transport(old.direction(before.angle), old.normal, new.normal)
    return replace(after, angle=new.angle(direction))


def bound_nearest(points: Floats, surface: SurfaceArrays) -> Binding:
    """Binding to the places of a surface that are nearest to points (n, 3)."""
    native = package().Surface(surface.vertices, surface.faces)
    closest = package().project(native, points)
    return attached_to(surface, closest.faces, closest.barycentric)


def _matched(binding: Binding, faces: Ints) -> tuple[Ints, Floats]:
    """Faces (n,) with the binding's corners, -1 where there is none, and their barycentrics."""
    found = faces_with_corners(binding.corners, faces)
    weights = normalized(binding.barycentric)
    order = np.argsort(binding.corners, axis=1)
    place = np.argsort(np.argsort(faces[found], axis=1), axis=1)
    in_order = np.take_along_axis(weights, order, axis=1)
    return found, np.take_along_axis(in_order, place, axis=1)


def faces_with_corners(corners: Ints, faces: Ints) -> Ints:
    """Index of the face with the same three vertices in any order, -1 where there is none."""
    wanted, have = np.sort(corners, axis=1), np.sort(faces, axis=1)
    _, label = np.unique(np.concatenate([have, wanted]), axis=0, return_inverse=True)
    label = label.reshape(-1)
    table = np.full(int(np.max(label, initial=-1)) + 1, -1, dtype=np.int32)
    table[label[: len(have)][::-1]] = np.arange(len(have), dtype=np.int32)[::-1]
    return table[label[len(have) :]]


def normalized(weights: Floats) -> Floats:
    """Barycentrics as stored (single precision) -> not negative, sum 1."""
    clipped = np.clip(weights, 0.0, None)
    total = clipped.sum(axis=1, keepdims=True)
    if (total <= 0.0).any():
        point = int(np.argmax(total[:, 0] <= 0.0))
        raise ScatterError(f"dapple_barycentric[{point}] sums to nothing: {weights[point]}")
    return clipped / total
