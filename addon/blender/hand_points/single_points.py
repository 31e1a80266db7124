# SPDX-License-Identifier: GPL-3.0-or-later
"""Adding, moving and removing single points."""

from collections.abc import Iterable, Sequence

import bmesh
import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats, Ints
from ..base.mesh_arrays import read_points, to_local
from ..scatter.linked_data import own_mesh
from ..scatter.object import surface_of
from ..scatter.points import point_columns_of
from ..surface.current_binding import binding_now
from ..surface.reading import read
from .hand_placed import take_in


def add_point(obj: bpy.types.Object, place: Floats, kind: int) -> int:
    """Add a point of an object type at the nearest place of the surface; returns its id."""
    (identity,) = add_points(obj, place[None], kind)
    return int(identity)


def add_points(obj: bpy.types.Object, places: Floats, kind: int) -> Ints:
    """The same for several places (k, 3); returns the ids (k,)."""
    mesh, there = own_mesh(obj), len(obj.data.vertices)
    local = np.concatenate([read_points(mesh), to_local(obj, places)])
    mesh.vertices.add(len(places))
    mesh.vertices.foreach_set("co", local.astype(np.float32).ravel())
    try:
        take_in(obj, np.zeros(len(local), dtype=bool), kind)
    except ScatterError:
        _remove(obj, range(there, len(local)))
        raise
    return point_columns_of(obj)["id"][there:]


def nearest_point(obj: bpy.types.Object, place: Floats, within: float) -> int | None:
    """The id of the point nearest to a place, if it is within a distance; otherwise None."""
    surface = surface_of(obj)
    arrays = read(surface)
    away = binding_now(obj, surface, arrays).positions(arrays.vertices) - place
    distances = np.linalg.norm(away, axis=1)
    if not len(distances) or distances.min() > within:
        return None
    return int(point_columns_of(obj)["id"][distances.argmin()])


def move_point(obj: bpy.types.Object, identity: int, place: Floats) -> None:
    """Move a point to the nearest place of the surface."""
    row = _row_of(obj, identity)
    moved = np.zeros(len(obj.data.vertices), dtype=bool)
    moved[row] = True
    point = own_mesh(obj).vertices[row]
    before = point.co.copy()
    point.co = to_local(obj, place[None])[0]
    try:
        take_in(obj, moved)
    except ScatterError:
        own_mesh(obj).vertices[row].co = before
        raise


def remove_point(obj: bpy.types.Object, identity: int) -> None:
    """Remove a point."""
    remove_points(obj, [_row_of(obj, identity)])


def remove_points(obj: bpy.types.Object, rows: Sequence[int]) -> None:
    """Remove the points of these rows."""
    surface = surface_of(obj)
    arrays = read(surface)
    lost = binding_now(obj, surface, arrays).positions(arrays.vertices)[rows]
    _remove(obj, rows)
    take_in(obj, np.zeros(len(obj.data.vertices), dtype=bool), lost=lost)


def _row_of(obj: bpy.types.Object, identity: int) -> int:
    found = np.flatnonzero(point_columns_of(obj)["id"] == identity)
    if not len(found):
        raise ScatterError(f"Scatter '{obj.name}' has no point {identity}")
    return int(found[0])


def _remove(obj: bpy.types.Object, rows: Iterable[int]) -> None:
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    edited.verts.ensure_lookup_table()
    bmesh.ops.delete(edited, geom=[edited.verts[row] for row in rows], context="VERTS")
    edited.to_mesh(own_mesh(obj))
    edited.free()
