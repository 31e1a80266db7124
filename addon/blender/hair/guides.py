# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair guides: points of a scatter as curves, attached to its surface as Blender's own hair is."""

from dataclasses import dataclass, replace

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.hair import first_points, on_base, straight_curves
from ...core.surface.arrays import Floats, Ints
from ...core.surface.records import Binding
from ..base.mesh_arrays import to_local
from ..base.object_handles import ObjectHandle
from ..scatter.object import surface_of
from ..scatter.points import own_columns
from ..surface.current_binding import current_binding, other_faces, with_rest
from ..surface.reading import read
from ..surface.rest_position import rest_position
from .base_mesh import BaseMesh, check_can_have_hair, read_base, shared_coordinates

_LENGTH = 0.1  # of the surface's size


@dataclass(frozen=True)
class Guides:
    """The result of Add Hair Guides."""

    obj: bpy.types.Object
    count: int
    shared: int  # number of guides whose texture coordinates belong to several places


def add_guides(scatter: bpy.types.Object, count: int, length: float, points: int) -> Guides:
    """Make hair curves of the first `count` points of a scatter in its progressive order, or all if
    that is 0; their length is a tenth of the surface's size if that is 0.

    Raises:
        ScatterError: there are no points, they do not fit the surface, or the surface cannot have
            hair.
    """
    surface = surface_of(scatter)
    check_can_have_hair(surface)
    base = read_base(surface)
    with rest_position(ObjectHandle(surface), "REST"):
        roots, ids = _roots(scatter, surface, base, count)
        length = length or _LENGTH * float(np.linalg.norm(np.ptp(base.arrays.vertices, axis=0)))
        places = straight_curves(base.arrays, roots, length, points)
        made = new_hair(surface, f"{scatter.name} Hair")
        write_curves(made, places, roots.interpolated(base.uv[roots.loops]), ids)
    made.data.surface_uv_map = base.uv_map
    return Guides(made, len(ids), int(shared_coordinates(base, roots).sum()))


def _roots(
    scatter: bpy.types.Object, surface: bpy.types.Object, base: BaseMesh, count: int
) -> tuple[Binding, Ints]:
    """The roots on the base, in the progressive order, and the ids of their points."""
    if not len(scatter.data.vertices):
        raise ScatterError(f"Scatter '{scatter.name}' has no points: optimize it first")
    now = read(surface)
    if (reason := other_faces(scatter, now)) and scatter.dapple.attached_to != "REST":
        raise ScatterError(f"Scatter '{scatter.name}' is out of date: {reason}. Optimize it first")
    binding, columns = current_binding(scatter, surface, now)
    ranks = own_columns(scatter, {"dapple_rank": "FLOAT"})["dapple_rank"]
    rows = first_points(ranks, columns["id"], count)
    same = now.topology == base.arrays.topology
    now = replace(now, rest=None) if same else with_rest(now, surface)
    return on_base(binding.rows_at(rows), now, base.arrays), columns["id"][rows]


def new_hair(surface: bpy.types.Object, name: str) -> bpy.types.Object:
    """A new hair object without curves, made active, as Add > Curve > Empty Hair makes it: with
    its surface as parent, and a modifier that deforms it with the surface.
    """
    known = {obj.session_uid for obj in bpy.data.objects}
    with bpy.context.temp_override(active_object=surface, object=surface):
        bpy.ops.object.curves_empty_hair_add()
    made = next(obj for obj in bpy.data.objects if obj.session_uid not in known)
    made.name = made.data.name = name
    bpy.context.view_layer.update()
    return made


def write_curves(made: bpy.types.Object, places: Floats, uv: Floats, ids: Ints) -> None:
    """Fill a hair object with curves (n, points, 3) in world space, with texture coordinates (n, 2)
    of their roots, and ids.
    """
    count, points = places.shape[:2]
    curves, local = made.data, to_local(made, places.reshape(-1, 3))
    curves.add_curves([points] * count)
    curves.position_data.foreach_set("vector", local.astype(np.float32).ravel())
    coordinates = curves.attributes.new("surface_uv_coordinate", "FLOAT2", "CURVE")
    coordinates.data.foreach_set("vector", uv.astype(np.float32).ravel())
    attribute = curves.attributes.new("dapple_id", "INT", "CURVE")
    attribute.data.foreach_set("value", np.ascontiguousarray(ids, dtype=np.int32))
    curves.update_tag()
