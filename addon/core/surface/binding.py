# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversions between samples and bindings."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import package
from .arrays import Floats, Ints, SurfaceArrays
from .frames import frames, shading, transport
from .records import Binding, Placed


def attached_to(surface: SurfaceArrays, faces: Ints, weights: Floats) -> Binding:
    """Binding to faces (n,) of a surface with barycentrics (n, 3) and no angles."""
    corners, loops = surface.faces[faces], surface.face_corners[faces]
    return Binding(corners, np.asarray(weights), np.zeros(len(corners)), loops)


def binding_of(samples: Any, surface: SurfaceArrays) -> Binding:
    """Binding of dapple.Samples of a surface, without angles."""
    return attached_to(surface, samples.faces, samples.barycentric)


def placed_of(samples: Any, surface: SurfaceArrays) -> Placed:
    """Places of dapple.Samples with the triangles that a keyframe stores."""
    return Placed(np.asarray(samples.faces, dtype=np.int32), binding_of(samples, surface))


def samples_of(binding: Binding, surface: Any, ids: Ints, classes: Ints) -> Any:
    """dapple.Samples of a stored binding on a dapple.Surface."""
    return package().Samples(surface, *places_on(surface, binding), ids=ids, classes=classes)


def places_on(surface: Any, binding: Binding) -> tuple[Ints, Floats]:
    """Faces (n,) of a dapple.Surface and barycentrics (n, 3) of a stored binding.

    A quad may be cut along the other diagonal than when the points were bound. Points whose
    triangle no longer exists move to the closest place of the surface.
    """
    faces, weights = _matched(binding, surface.faces)
    lost = faces < 0
    if lost.any():
        points = binding.positions(surface.vertices)[lost]
        closest = package().project(surface, points)
        faces[lost], weights[lost] = closest.faces, closest.barycentric
    return faces, weights


def rebound(before: Binding, first: SurfaceArrays, surface: SurfaceArrays) -> Binding:
    """Binding to the nearest places of another surface, for points bound to the first.

    The points' directions are turned as little as the normals allow.
    """
    old = frames(before, first.vertices, shading(first))
    after = bound_nearest(before.positions(first.vertices), surface)
    new = frames(after, surface.vertices, shading(surface))
    direction = transport(old.direction(before.angle), old.normal, new.normal)
    return replace(after, angle=new.angle(direction))


def bound_nearest(points: Floats, surface: SurfaceArrays) -> Binding:
    """Binding of points (n, 3) to the nearest places of a surface."""
    native = package().Surface(surface.vertices, surface.faces)
    closest = package().project(native, points)
    return attached_to(surface, closest.faces, closest.barycentric)


def _matched(binding: Binding, faces: Ints) -> tuple[Ints, Floats]:
    """Faces (n,) with the binding's corners, -1 if there is none, and their barycentrics."""
    found = faces_with_corners(binding.corners, faces)
    weights = normalized(binding.barycentric)
    order = np.argsort(binding.corners, axis=1)
    place = np.argsort(np.argsort(faces[found], axis=1), axis=1)
    in_order = np.take_along_axis(weights, order, axis=1)
    return found, np.take_along_axis(in_order, place, axis=1)


def faces_with_corners(corners: Ints, faces: Ints) -> Ints:
    """Index of the face with the same three vertices in any order, -1 if there is none."""
    wanted, have = np.sort(corners, axis=1), np.sort(faces, axis=1)
    _, label = np.unique(np.concatenate([have, wanted]), axis=0, return_inverse=True)
    label = label.reshape(-1)
    table = np.full(int(np.max(label, initial=-1)) + 1, -1, dtype=np.int32)
    table[label[: len(have)][::-1]] = np.arange(len(have), dtype=np.int32)[::-1]
    return table[label[len(have) :]]


def normalized(weights: Floats) -> Floats:
    """Stored barycentrics (single precision), made nonnegative with sum 1."""
    clipped = np.clip(weights, 0.0, None)
    total = clipped.sum(axis=1, keepdims=True)
    if (total <= 0.0).any():
        point = int(np.argmax(total[:, 0] <= 0.0))
        raise ScatterError(f"dapple_barycentric[{point}] sums to 0: {weights[point]}")
    return clipped / total
