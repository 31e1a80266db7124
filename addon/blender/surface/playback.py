# SPDX-License-Identifier: GPL-3.0-or-later
"""Where points are shown now: at their own binding, or at the keyframes of a bake."""

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.bake.keys import Baked
from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats
from ...core.surface.records import Binding
from ...core.surface.sources import sources_from
from ..base.mesh_arrays import read_points, to_world
from ..base.times import time_of
from ..scatter.key_stores import check_keys, frames, read_baked, stored_object
from ..scatter.object import surface_of
from ..scatter.points import own_points
from .current_binding import current_binding
from .mesh import read_mesh, read_outline


def places_now(obj: bpy.types.Object, rows: list[int], context: bpy.types.Context) -> Floats:
    """World positions (k, 3) of points on the current surface.

    Raises:
        ScatterError: the surface does not have the faces that the points are bound to.
    """
    surface = surface_of(obj)
    arrays = read_mesh(surface)
    if not obj.dapple.baked_keys:
        binding, _ = current_binding(obj, surface, arrays)
        return binding.rows_at(rows).positions(arrays.vertices)
    check_keys(obj)
    first, second, share = _around(obj, rows, time_of(context.scene))
    corners = np.concatenate([first.corners, second.corners])
    if corners.min() < 0 or corners.max() >= len(arrays.vertices):
        raise ScatterError(
            f"Surface '{surface.name}' has {len(arrays.vertices)} vertices, not those of the bake"
        )
    before, after = (one.positions(arrays.vertices) for one in (first, second))
    return (1.0 - share) * before + share * after


def points_now(obj: bpy.types.Object, known: dict[int, Baked]) -> tuple[Floats, NDArray[np.bool_]]:
    """World positions (n, 3) of all points of a scatter as it is shown, and which of them exist.

    If the faces of its surface have changed, these are the positions of the optimization. `known`
    caches keyframes by session_uid.
    """
    stored, all_there = to_world(obj, read_points(obj.data)), np.ones(len(obj.data.vertices), bool)
    if not obj.dapple.baked_keys and _is_as_solved(obj):
        return stored, all_there
    try:
        return _played(obj, known)
    except (ScatterError, IndexError):
        return stored, all_there & own_points(obj)


def _is_as_solved(obj: bpy.types.Object) -> bool:
    solved = sources_from(obj.dapple.solved_from)
    return solved is None or solved.frame == time_of(bpy.context.scene)


def _played(obj: bpy.types.Object, known: dict[int, Baked]) -> tuple[Floats, NDArray[np.bool_]]:
    surface = surface_of(obj)
    if not obj.dapple.baked_keys:
        arrays = read_mesh(surface)
        binding, _ = current_binding(obj, surface, arrays)
        return binding.positions(arrays.vertices), np.ones(len(binding.corners), dtype=bool)
    vertices = read_outline(surface).vertices
    if obj.session_uid not in known:
        known[obj.session_uid] = read_baked(obj)
    baked, count = known[obj.session_uid], len(obj.data.vertices)
    at = min(max(time_of(bpy.context.scene) - obj.dapple.baked_start, 0.0), baked.frame_count - 1.0)
    first, second, share = baked.binding(int(at), count)
    share += (at - int(at)) / max(int(baked.frames["dapple_span"][int(at)]), 1)
    before, after = (one.positions(vertices) for one in (first, second))
    return (1.0 - share) * before + share * after, baked.there(int(at), count)


def _around(obj: bpy.types.Object, rows: list[int], time: float) -> tuple[Binding, Binding, float]:
    """For some points: both keyframes around a time, and the weight of the second."""
    table = frames(obj)
    at = min(max(time - obj.dapple.baked_start, 0.0), len(table["dapple_key"]) - 1.0)
    key, since, span = (int(table[f"dapple_{name}"][int(at)]) for name in ("key", "since", "span"))
    share = (since + at - int(at)) / span if span else 0.0
    return _of_key(obj, rows, key), _of_key(obj, rows, key + min(span, 1)), share


def _of_key(obj: bpy.types.Object, rows: list[int], key: int) -> Binding:
    """A few rows of a keyframe, without reading the whole bake."""
    keys, triangles = (stored_object(obj, name).data for name in ("Keys", "Triangles"))
    at = [key * len(obj.data.vertices) + row for row in rows]
    faces = [keys.attributes["dapple_face"].data[row].value for row in at]
    places = np.array([keys.vertices[row].co for row in at], dtype=np.float64)
    corners = [
        [triangles.attributes[f"dapple_v{k}"].data[f].value for k in range(3)] for f in faces
    ]
    first = 1.0 - places[:, 0] - places[:, 1]
    weights = np.column_stack([first, places[:, 0], places[:, 1]])
    return Binding(np.array(corners, dtype=np.int32), weights, places[:, 2])
