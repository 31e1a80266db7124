# SPDX-License-Identifier: GPL-3.0-or-later
"""Where points are played now: by their own binding, or by the keys of a bake."""

import bpy
import numpy as np

from ...core.errors import ScatterError
from ...core.records import Binding
from ...core.surface import Floats
from ..base.times import time_of
from ..data.key_stores import check_keys, frames, stored_object
from ..data.scatter import surface_of
from .bound import current_binding
from .surface_mesh import read_surface


def places_now(obj: bpy.types.Object, rows: list[int], context: bpy.types.Context) -> Floats:
    """World positions (k, 3) of points on the surface as it is at the moment.

    Raises:
        ScatterError: the surface has not the faces that they are bound to.
    """
    surface = surface_of(obj)
    arrays = read_surface(surface, context.evaluated_depsgraph_get())
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


def _around(obj: bpy.types.Object, rows: list[int], time: float) -> tuple[Binding, Binding, float]:
    """Of some points: both keys around a time, and the share of the second."""
    table = frames(obj)
    at = min(max(time - obj.dapple.baked_start, 0.0), len(table["dapple_key"]) - 1.0)
    key, since, span = (int(table[f"dapple_{name}"][int(at)]) for name in ("key", "since", "span"))
    share = (since + at - int(at)) / span if span else 0.0
    return _of_key(obj, rows, key), _of_key(obj, rows, key + min(span, 1)), share


def _of_key(obj: bpy.types.Object, rows: list[int], key: int) -> Binding:
    """A few rows, without reading all that a bake holds."""
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
