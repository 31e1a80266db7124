# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a surface's vertices: attributes of any domain, colours, vertex groups."""

import bmesh
import bpy
import numpy as np

from ..core.errors import ScatterError
from ..core.surface import Floats
from .corners import corner_vertices

_FIELDS = {"FLOAT": "value", "INT": "value", "INT8": "value", "BOOLEAN": "value"}
_COLOURS = {"FLOAT_COLOR": "color", "BYTE_COLOR": "color"}
_DOMAINS = {"POINT", "FACE", "CORNER"}


def weight_names(obj: bpy.types.Object) -> list[str]:
    """What can be read from an object's mesh as it is before its modifiers."""
    kinds = _FIELDS.keys() | _COLOURS.keys()
    attributes = [
        one.name
        for one in getattr(obj.data, "attributes", ())  # curves and the like have none
        if one.data_type in kinds and one.domain in _DOMAINS and not one.is_internal
    ]
    return [*(group.name for group in obj.vertex_groups), *attributes]


def read_weights(obj: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> Floats:
    """Values (v,) of the evaluated mesh of an object; faces and corners are averaged.

    Raises:
        ScatterError: there is no such attribute or vertex group, or a value is below 0.
    """
    group = obj.vertex_groups.get(name)
    attribute = mesh.attributes.get(name)
    if attribute is not None and attribute.domain in _DOMAINS:
        values = _at_vertices(mesh, attribute.domain, _values(obj, attribute))
    elif group is not None:
        values = _group_weights(mesh, group.index)
    else:
        raise ScatterError(f"Surface '{obj.name}' has no attribute or vertex group '{name}'")
    wrong = ~(np.isfinite(values) & (values >= 0.0))
    if wrong.any():
        vertex = int(np.argmax(wrong))
        raise ScatterError(
            f"Surface '{obj.name}': '{name}' is {values[vertex]:.6g} at vertex {vertex}; a density "
            "must be finite and not negative"
        )
    return values


def _values(obj: bpy.types.Object, attribute: bpy.types.Attribute) -> Floats:
    kind, count = attribute.data_type, len(attribute.data)
    if kind in _FIELDS:
        values = np.empty(count, dtype=np.float32)
        attribute.data.foreach_get(_FIELDS[kind], values)
        return values.astype(np.float64)
    if kind not in _COLOURS:
        raise ScatterError(
            f"Surface '{obj.name}': attribute '{attribute.name}' is of the type {kind}: numbers or "
            "colours are needed"
        )
    colours = np.empty(4 * count, dtype=np.float32)
    attribute.data.foreach_get(_COLOURS[kind], colours)
    mean: Floats = colours.reshape(-1, 4)[:, :3].mean(axis=1, dtype=np.float64)
    return mean


def _at_vertices(mesh: bpy.types.Mesh, domain: str, values: Floats) -> Floats:
    if domain == "POINT":
        return values
    corners = corner_vertices(mesh)
    if domain == "FACE":
        totals = np.empty(len(mesh.polygons), dtype=np.int32)
        mesh.polygons.foreach_get("loop_total", totals)
        values = np.repeat(values, totals)
    count = len(mesh.vertices)
    sums = np.bincount(corners, values, minlength=count)
    return sums / np.maximum(np.bincount(corners, minlength=count), 1)


def _group_weights(mesh: bpy.types.Mesh, index: int) -> Floats:
    """Blender gives weights vertex by vertex only; bmesh does so in half the time of the mesh."""
    edited = bmesh.new()
    edited.from_mesh(mesh, face_normals=False, vertex_normals=False)
    layer, count = edited.verts.layers.deform.active, len(edited.verts)
    values = np.zeros(count)
    if layer is not None:
        values = np.fromiter(
            (vertex[layer].get(index, 0.0) for vertex in edited.verts), float, count
        )
    edited.free()
    return values
