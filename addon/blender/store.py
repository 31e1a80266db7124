# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing results into the file: the scatter object and its baked keys."""

import bpy
import numpy as np

from ..core.records import (
    POINT_ATTRIBUTES,
    ROW_ATTRIBUTES,
    SCHEMA,
    SCHEMA_KEY,
    Binding,
    Columns,
    binding_from,
    check_binding,
    joined,
)
from ..core.solve import Report, Scattered
from ..core.surface import SurfaceArrays
from ..nodes import GROUP_NAME, ensure_group, get_input, set_input
from .meshio import read_columns, to_local, write_columns, write_points
from .properties import scatter_modifier, write_instance_inputs, write_report


def new_scatter(surface: bpy.types.Object, collection: bpy.types.Collection) -> bpy.types.Object:
    """Empty scatter object on a surface."""
    name = f"{surface.name} Scatter"
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    obj.data[SCHEMA_KEY] = SCHEMA
    collection.objects.link(obj)
    obj.dapple.surface = surface
    _ensure_modifier(obj)
    return obj


def _ensure_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier:
    modifier = scatter_modifier(obj)
    if modifier is None:
        modifier = obj.modifiers.new(GROUP_NAME, "NODES")
        modifier.node_group = ensure_group()
    return modifier


def write_scattered(obj: bpy.types.Object, arrays: SurfaceArrays, solved: Scattered) -> None:
    """Store a result: points, bindings, figures. Keys of an older result go."""
    clear_keys(obj)
    write_points(obj.data, to_local(obj, solved.positions))
    write_columns(obj.data, solved.columns, POINT_ATTRIBUTES)
    write_columns(obj.data, solved.binding.rows(), ROW_ATTRIBUTES)
    obj.data[SCHEMA_KEY] = SCHEMA
    obj.dapple.surface_vertices = len(arrays.vertices)
    write_report(obj, solved.report)
    modifier = _ensure_modifier(obj)
    set_input(modifier, "Surface", obj.dapple.surface)
    set_input(modifier, "Surface Vertices", len(arrays.vertices))
    set_input(modifier, "Spacing", solved.report.spacing)
    write_instance_inputs(obj)


def read_binding(obj: bpy.types.Object, vertex_count: int) -> tuple[Binding, Columns]:
    """Stored binding and point columns, checked against the surface."""
    binding = binding_from(read_columns(obj.data, ROW_ATTRIBUTES))
    check_binding(binding, vertex_count, obj.name)
    return binding, read_columns(obj.data, POINT_ATTRIBUTES)


def write_keys(obj: bpy.types.Object, keys: list[Binding], start: int, report: Report) -> None:
    """Store baked keys, the first of them for the frame start."""
    clear_keys(obj)
    name = f"{obj.name} Keys"
    store = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    columns = joined(keys)
    write_points(store.data, np.zeros((len(columns["dapple_carry"]), 3)))
    write_columns(store.data, columns, ROW_ATTRIBUTES)
    modifier = _ensure_modifier(obj)
    set_input(modifier, "Keys", store)
    set_input(modifier, "Key Points", len(obj.data.vertices))
    set_input(modifier, "First Frame", start)
    obj.dapple.baked_start, obj.dapple.baked_keys = start, len(keys)
    write_report(obj, report)
    obj.update_tag()


def clear_keys(obj: bpy.types.Object) -> None:
    """Forget baked keys; the points ride on the binding they were optimised with."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    store = get_input(modifier, "Keys")
    set_input(modifier, "Keys", None)
    obj.dapple.baked_keys = 0
    obj.update_tag()
    if store is not None and store.users == 0:
        mesh = store.data
        bpy.data.objects.remove(store)
        bpy.data.meshes.remove(mesh)
