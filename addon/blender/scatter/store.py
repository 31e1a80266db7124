# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing a solution into the file: a new scatter object, its points and their binding."""

from dataclasses import replace

import bpy

from ...core.solve.solve import Scattered
from ...core.solve.stale import settings_text
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.records import (
    ADDED_ATTRIBUTES,
    MIRROR_ATTRIBUTES,
    POINT_ATTRIBUTES,
    REST_ATTRIBUTES,
    ROW_ATTRIBUTES,
    SCHEMA,
    SCHEMA_KEY,
    Binding,
    Columns,
)
from ...core.surface.rest import AtRest
from ...core.surface.sources import Sources, on_faces, sources_of
from ..base.mesh_arrays import to_local, write_columns, write_points
from .key_writing import clear_keys
from .linked_data import own_mesh
from .modifier import ensure_modifier, write_inputs, write_warning
from .object import write_report
from .points import forget_edited, write_digest


def new_scatter(
    surface: bpy.types.Object, collection: bpy.types.Collection, named: str = ""
) -> bpy.types.Object:
    """A new scatter object without points, named after its surface or as given."""
    name = f"{named or surface.name} Scatter"
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    obj.data[SCHEMA_KEY] = SCHEMA
    collection.objects.link(obj)
    obj.dapple.surface = surface
    ensure_modifier(obj)
    return obj


def write_scattered(
    obj: bpy.types.Object,
    arrays: SurfaceArrays,
    solved: Scattered,
    rest: AtRest | None = None,
    sources: Sources | None = None,
) -> None:
    """Store a result: points, bindings, figures. Keyframes of an older result are deleted.

    The sources of the surface may be known, with the settings but for the count.
    """
    places = to_local(obj, solved.positions)
    clear_keys(obj)
    mesh = own_mesh(obj)
    write_points(mesh, places)
    write_columns(mesh, solved.columns, {**POINT_ATTRIBUTES, **ADDED_ATTRIBUTES})
    _write_mirror(mesh, solved.columns)
    mesh[SCHEMA_KEY] = SCHEMA
    forget_edited(obj)
    obj.dapple.solved_settings = settings_text(solved.settings)
    sources = sources or sources_of(arrays, solved.settings)
    obj.dapple.solved_from = replace(sources, capacity=solved.capacity).text()
    obj.dapple.locked_count = int(solved.columns["dapple_locked"].sum())
    write_figures(obj, solved)
    write_binding(obj, arrays, solved.binding, rest)
    write_warning(obj)


def _write_mirror(mesh: bpy.types.Mesh, columns: Columns) -> None:
    """Store which points are mirror images; nothing where they are not in pairs."""
    if MIRROR_ATTRIBUTES.keys() <= columns.keys():
        write_columns(mesh, columns, MIRROR_ATTRIBUTES)
        return
    for attribute in filter(None, map(mesh.attributes.get, MIRROR_ATTRIBUTES)):
        mesh.attributes.remove(attribute)


def write_figures(obj: bpy.types.Object, solved: Scattered) -> None:
    """Store the figures of a result."""
    write_report(obj, solved.report)
    obj.dapple.report.details = solved.details.text()


def write_binding(
    obj: bpy.types.Object, arrays: SurfaceArrays, binding: Binding, rest: AtRest | None = None
) -> None:
    """Store the binding of the points to a surface or its rest shape. Keyframes are deleted."""
    clear_keys(obj)
    write_columns(own_mesh(obj), binding.rows(), ROW_ATTRIBUTES)
    if rest is not None:
        write_columns(obj.data, rest.columns, REST_ATTRIBUTES)
        obj.dapple.attached_parts = rest.parts
    obj.dapple.attached_to = "FACES" if rest is None else "REST"
    obj.dapple.surface_vertices = len(arrays.vertices)
    obj.dapple.surface_topology = arrays.topology
    obj.dapple.solved_from = on_faces(obj.dapple.solved_from, arrays)
    write_digest(obj)
    write_inputs(obj)


def write_own_ids(obj: bpy.types.Object, columns: Columns) -> None:
    """Store the result of columns_with_own_ids; keyframes were deleted before."""
    types = {**POINT_ATTRIBUTES, **ADDED_ATTRIBUTES}
    write_columns(own_mesh(obj), columns, {name: types[name] for name in columns})
    obj.dapple.report.count = len(columns["id"])
    write_digest(obj)
