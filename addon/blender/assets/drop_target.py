# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface that an artist means who drops a scatter somewhere."""

from collections.abc import Collection, Iterator

import bpy
from mathutils import Vector

from ..scatter.object import is_surface

_NEAR = 0.01  # of an object's size: what lies so near to it lies on it
_HITS = 32  # objects that a ray goes through at most
_DOWN = Vector((0.0, 0.0, -1.0))


def presumed_surface(
    place: Vector, passed_over: Collection[bpy.types.Object], otherwise: bpy.types.Object | None
) -> bpy.types.Object | None:
    """What a place lies on, else what is below it, else the given object; None: nobody knows."""
    there = [
        obj
        for obj in bpy.context.view_layer.objects
        if is_surface(obj) and obj.visible_get() and obj not in passed_over
    ]
    own = otherwise if otherwise in there else None
    return _nearest(place, there) or _below(place, there) or own


def _nearest(place: Vector, there: list[bpy.types.Object]) -> bpy.types.Object | None:
    found = [(away, k) for k, obj in enumerate(there) for away in _distance(place, obj)]
    return there[min(found)[1]] if found else None


def _distance(place: Vector, obj: bpy.types.Object) -> Iterator[float]:
    """How far a place is from an object, if it lies on it; boxes are quick to look at."""
    corners = [obj.matrix_world @ Vector(corner) for corner in obj.bound_box]
    low, high = (Vector(map(pick, zip(*corners, strict=True))) for pick in (min, max))
    near = _NEAR * (high - low).length
    if any(not a - near <= x <= b + near for a, x, b in zip(low, place, high, strict=True)):
        return
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    try:
        found, at, *_ = evaluated.closest_point_on_mesh(obj.matrix_world.inverted_safe() @ place)
    except RuntimeError:  # it has no faces
        return
    away = (obj.matrix_world @ at - place).length
    if found and away <= near:
        yield away


def _below(place: Vector, there: list[bpy.types.Object]) -> bpy.types.Object | None:
    depsgraph, start = bpy.context.evaluated_depsgraph_get(), place
    for _ in range(_HITS):
        hit, at, _, _, obj, _ = bpy.context.scene.ray_cast(depsgraph, start, _DOWN)
        if not hit:
            break
        if obj.original in there:
            return obj.original
        start = at + 1e-4 * max(1.0, at.length) * _DOWN
    return None
