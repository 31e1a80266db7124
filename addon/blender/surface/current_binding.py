# SPDX-License-Identifier: GPL-3.0-or-later
"""The points' binding to the current surface, by its faces or by its rest shape."""

from dataclasses import replace

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task, run_now
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.records import (
    ROW_ATTRIBUTES,
    Binding,
    Columns,
    binding_from,
    check_binding,
    unbound,
)
from ...core.surface.rest import AtRest, at_rest, bound_at_rest
from ..base.mesh_arrays import to_local
from ..scatter.object import is_fluid
from ..scatter.points import own_columns, point_columns_of, read_at_rest, read_binding
from .mesh import read_rest


def other_faces(obj: bpy.types.Object, arrays: SurfaceArrays) -> str:
    """How the faces differ from those that the points are bound to; empty if they do not."""
    bound, now = obj.dapple.surface_vertices, len(arrays.vertices)
    if bound != now:
        return f"attached to {bound} vertices, surface '{arrays.name}' has {now}"
    known = obj.dapple.surface_topology.split()
    if known and arrays.topology != known[0]:
        return f"surface '{arrays.name}' has {now} vertices as before, but other faces"
    return ""


def with_rest(arrays: SurfaceArrays, obj: bpy.types.Object) -> SurfaceArrays:
    """A surface that was just read, together with its rest shape."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if not is_fluid(obj):
        return replace(arrays, rest=read_rest(obj, depsgraph))
    return replace(arrays, rest=to_local(obj.evaluated_get(depsgraph), arrays.vertices))


def rest_of(
    surface: bpy.types.Object, arrays: SurfaceArrays, binding: Binding, kind: str
) -> AtRest | None:
    """The points' places on the rest shape, if they are to be bound to it."""
    return at_rest(binding, with_rest(arrays, surface)) if kind == "REST" else None


def binding_now(obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays) -> Binding:
    """The binding of all stored points to the current surface.

    Points that were added by hand are included; they have no binding yet.
    """
    reason = other_faces(obj, arrays)
    if reason and obj.dapple.attached_to != "REST":
        raise ScatterError(f"Scatter '{obj.name}' is out of date: {reason}. Optimize it first")
    stored = binding_from(own_columns(obj, ROW_ATTRIBUTES))
    blank = unbound(stored)
    if not reason:
        check_binding(stored.rows_at(~blank), len(arrays.vertices), obj.name)
        return stored
    rest = read_at_rest(obj)
    found = bound_at_rest(rest.columns, replace(with_rest(arrays, surface), rest_parts=rest.parts))
    return replace(found, barycentric=np.where(blank[:, None], 0.0, found.barycentric))


def current_binding(
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays
) -> tuple[Binding, Columns]:
    """The binding of a scatter's points to its current surface, and their columns.

    Points bound to the rest position are located again if the faces have changed.
    """
    found: tuple[Binding, Columns] = run_now(current_steps(obj, surface, arrays))
    return found


def current_steps(obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays) -> Steps:
    """The same in steps."""
    if obj.dapple.attached_to != "REST" or not other_faces(obj, arrays):
        return read_binding(obj, len(arrays.vertices))
    stored, columns = read_at_rest(obj), point_columns_of(obj)
    if arrays.rest is None:
        arrays = with_rest(arrays, surface)
    at_rest_now = replace(arrays, rest_parts=stored.parts)
    found = yield Task(lambda _: bound_at_rest(stored.columns, at_rest_now))
    return found, columns
