# SPDX-License-Identifier: GPL-3.0-or-later
"""Editing the points of a scatter in Edit Mode: entering the mode, and leaving it."""

import bmesh
import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats
from ..base.mesh_arrays import read_points, to_local, to_world
from ..freshness.staleness import is_edited
from ..scatter.linked_data import own_mesh
from ..scatter.modifier import scatter_modifier
from ..scatter.object import is_scatter, surface_of
from ..scatter.points import point_columns_of, write_digest
from ..solve.session_solutions import known_as_placed
from ..surface.current_binding import current_binding
from ..surface.reading import read
from .hand_placed import (
    forget_places,
    is_being_edited,
    kind_of_new,
    moved_points,
    new_points,
    note_places,
    take_in,
)

_SAME = 1e-5  # relative to the extent: points that are displaced by less count as unmoved

_begun: dict[int, tuple[np.ndarray, Floats]] = {}  # ids and places, by the scatter's session_uid


def edited_scatter(context: bpy.types.Context) -> bpy.types.Object | None:
    """The active scatter, if its points are being edited."""
    obj = context.object
    return obj if is_scatter(obj) and is_being_edited(obj) else None


def begin_editing(context: bpy.types.Context) -> None:
    """Enter Edit Mode of the active scatter, with its points on the current surface.

    Raises:
        ScatterError: the points cannot be edited; the scene is unchanged.
    """
    obj = context.object
    _check(obj)
    _show_on_surface(obj)
    note_places(obj)
    _show_instances(obj, False)
    _begun[obj.session_uid] = point_columns_of(obj)["id"], read_points(obj.data)
    obj.data.vertices.foreach_set("select", np.zeros(len(obj.data.vertices), dtype=bool))
    context.tool_settings.mesh_select_mode = (True, False, False)
    bpy.ops.object.mode_set(mode="EDIT")


def end_editing(context: bpy.types.Context) -> tuple[int, int]:
    """Leave Edit Mode; returns the numbers of placed and of removed points.

    Raises:
        ScatterError: points cannot be attached; the scene is unchanged.
    """
    obj = context.object
    mode = obj.mode
    bpy.ops.object.mode_set(mode="OBJECT")
    _drop_edges(obj)
    try:
        moved, lost = moved_points(obj), _lost(obj)
        if (moved | new_points(obj)).any() or len(lost):
            kind = kind_of_new(obj)
            moved = take_in(obj, moved, kind, lost)
    except ScatterError:
        bpy.ops.object.mode_set(mode=mode)
        raise
    forget_places(obj)
    _show_instances(obj, True)
    return int(moved.sum()), len(lost)


def add_vertex(obj: bpy.types.Object, place: Floats) -> None:
    """Add a point in Edit Mode at a place in world space, and select only this point."""
    mesh = bmesh.from_edit_mesh(obj.data)
    for vertex in mesh.verts:
        vertex.select = False
    mesh.verts.new(to_local(obj, place[None])[0]).select = True
    mesh.select_flush_mode()
    bmesh.update_edit_mesh(obj.data)


def _check(obj: bpy.types.Object) -> None:
    if not obj.visible_get():
        raise ScatterError(f"Scatter '{obj.name}' is hidden: show it first")
    if obj.dapple.baked_keys:
        raise ScatterError(f"Scatter '{obj.name}' is baked: clear the bake to edit points")
    if is_edited(obj):
        raise ScatterError(
            f"Points of scatter '{obj.name}' were edited by hand: reattach them, or optimize"
        )


def _show_on_surface(obj: bpy.types.Object) -> None:
    """Move the vertices with the surface, which may have moved since the points were solved."""
    surface = surface_of(obj)
    arrays, solved = read(surface), obj.dapple.solved_points
    binding, _ = current_binding(obj, surface, arrays)
    places, before = to_local(obj, binding.positions(arrays.vertices)), read_points(obj.data)
    extent = float(np.ptp(before, axis=0).max(initial=0.0)) if len(before) else 0.0
    if np.abs(places - before).max(initial=0.0) <= _SAME * extent:
        return
    own_mesh(obj).vertices.foreach_set("co", places.astype(np.float32).ravel())
    write_digest(obj)
    known_as_placed(obj, solved, binding)


def _drop_edges(obj: bpy.types.Object) -> None:
    """Delete the edges that an extrusion creates."""
    if not len(obj.data.edges):
        return
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    bmesh.ops.delete(edited, geom=[*edited.edges], context="EDGES_FACES")
    edited.to_mesh(own_mesh(obj))
    edited.free()


def _show_instances(obj: bpy.types.Object, show: bool) -> None:
    """Show or hide instances in Edit Mode, where they would not follow the vertices."""
    modifier = scatter_modifier(obj)
    if modifier is not None:
        modifier.show_in_editmode = show


def _lost(obj: bpy.types.Object) -> Floats:
    """Places of removed points in world space, if they were noted in this session."""
    if obj.session_uid not in _begun:
        return np.empty((0, 3))
    ids, places = _begun[obj.session_uid]
    return to_world(obj, places[~np.isin(ids, point_columns_of(obj)["id"])])
