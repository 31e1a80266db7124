# SPDX-License-Identifier: GPL-3.0-or-later
"""The new mesh as one of Blender's meshes, with all data of the old one."""

from typing import Any

import bmesh
import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.remesh import NewMesh
from ...core.surface.arrays import Floats, Ints
from ..base.all_or_nothing import once_done
from ..base.mesh_arrays import corner_vertices, read_points, triangle_corners
from .reading import edge_vertices, hard_edges, triangle_polygons

# Field, number type and width of the values of an attribute.
_KINDS: dict[str, tuple[str, type, int]] = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "INT8": ("value", np.int8, 1),
    "BOOLEAN": ("value", np.bool_, 1),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT2": ("vector", np.float32, 2),
    "INT32_2D": ("value", np.int32, 2),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "QUATERNION": ("value", np.float32, 4),
    "FLOAT4X4": ("value", np.float32, 16),
}
_MIXED = {"FLOAT", "FLOAT_VECTOR", "FLOAT2", "FLOAT_COLOR", "BYTE_COLOR", "FLOAT4X4"}
_SCULPT = {".sculpt_mask", ".sculpt_face_set"}  # Blender does not list them among attributes
_OWN = {"position", "material_index", "custom_normal"}  # written otherwise, or no longer right


def replace_mesh(obj: bpy.types.Object, made: bpy.types.Mesh) -> None:
    """Give an object a new mesh, with the name of the old one if nothing else uses that."""
    before = obj.data
    obj.data = made
    once_done(lambda: _leave(before, made))  # what is removed cannot be restored


def _leave(before: bpy.types.Mesh, made: bpy.types.Mesh) -> None:
    name = before.name
    if before.users == 0:
        bpy.data.meshes.remove(before)
        made.name = name


def write_new(old: bpy.types.Mesh, new: NewMesh) -> bpy.types.Mesh:
    """A new mesh with the new triangles and the data of the old mesh."""
    made = old.copy()
    try:
        _build(old, made, new)
        _carry_over(old, made, new)
    except BaseException:
        bpy.data.meshes.remove(made)
        raise
    return made


def _build(old: bpy.types.Mesh, made: bpy.types.Mesh, new: NewMesh) -> None:
    """Vertices, triangles, vertex groups and shape keys."""
    faces = corner_vertices(old)[triangle_corners(old)]
    places = new.at_vertices(read_points(old), faces)
    shapes = _shapes(old, new, faces)
    groups = _groups(old, new, faces)
    mesh = bmesh.new()
    try:
        mesh.from_mesh(old)
        bmesh.ops.delete(mesh, geom=mesh.verts[:], context="VERTS")  # layers stay
        weights = mesh.verts.layers.deform.verify()  # before there are vertices
        vertices = [mesh.verts.new(place) for place in places.tolist()]
        triangles = [mesh.faces.new([vertices[k] for k in row]) for row in new.faces.tolist()]
        for name, values in shapes.items():
            layer = mesh.verts.layers.shape[name]
            for vertex, place in zip(vertices, values.tolist(), strict=True):
                vertex[layer] = place
        for k, row in groups.items():
            held = vertices[k][weights]
            for group, weight in row:
                held[group] = weight
        _sort(mesh, vertices, triangles)
        mesh.to_mesh(made)
    finally:
        mesh.free()


def _sort(mesh: bmesh.types.BMesh, vertices: list[Any], triangles: list[Any]) -> None:
    """Sort elements in the order of their creation, as some have replaced deleted ones."""
    for made, sequence in ((vertices, mesh.verts), (triangles, mesh.faces)):
        for k, one in enumerate(made):
            one.index = k
        sequence.sort()


def _shapes(old: bpy.types.Mesh, new: NewMesh, faces: Ints) -> dict[str, Floats]:
    found = {}
    for key in old.shape_keys.key_blocks if old.shape_keys else ():
        places = np.empty(3 * len(old.vertices), np.float32)
        key.data.foreach_get("co", places)
        found[key.name] = new.at_vertices(places.reshape(-1, 3), faces)
    return found


def _groups(old: bpy.types.Mesh, new: NewMesh, faces: Ints) -> dict[int, list[tuple[int, float]]]:
    """Per vertex the weights of its groups, mixed from those of the old vertices around."""
    rows = [[(one.group, one.weight) for one in vertex.groups] for vertex in old.vertices]
    if not any(rows):
        return {}
    found = {}
    corners, weights = faces[new.source].tolist(), new.weights.tolist()
    for k, (around, shares) in enumerate(zip(corners, weights, strict=True)):
        mixed: dict[int, float] = {}
        for vertex, share in zip(around, shares, strict=True):
            for group, weight in rows[vertex]:
                mixed[group] = mixed.get(group, 0.0) + share * weight
        found[k] = [(group, weight) for group, weight in sorted(mixed.items()) if weight > 0]
    return found


def _carry_over(old: bpy.types.Mesh, made: bpy.types.Mesh, new: NewMesh) -> None:
    """Materials, and the values of all attributes."""
    polygons = triangle_polygons(old)
    corners = triangle_corners(old)
    faces = corner_vertices(old)[corners]
    materials = np.empty(len(old.polygons), np.int32)
    old.polygons.foreach_get("material_index", materials)
    made.polygons.foreach_set("material_index", materials[polygons[new.face_source]])
    smooth = np.empty(len(old.polygons), bool)  # no attribute has it where all are smooth
    old.polygons.foreach_get("use_smooth", smooth)
    made.polygons.foreach_set("use_smooth", smooth[polygons[new.face_source]])
    edges = _old_edge_of_each(old, made, new)
    seams = np.empty(len(old.edges), bool)
    old.edges.foreach_get("use_seam", seams)
    made.edges.foreach_set("use_seam", (edges >= 0) & seams[np.maximum(edges, 0)])
    for attribute in [one for one in old.attributes if not one.is_internal or one.name in _SCULPT]:
        target = made.attributes.get(attribute.name)
        if attribute.name in _OWN or attribute.data_type not in _KINDS:
            continue
        if target is None or target.domain != attribute.domain:
            continue
        values = _read(attribute)
        mixed = attribute.data_type in _MIXED
        if attribute.domain == "POINT":
            result = (
                new.at_vertices(values, faces) if mixed else values[new.nearest_vertices(faces)]
            )
        elif attribute.domain == "CORNER":
            result = _at_corners(values, corners, new, mixed)
        elif attribute.domain == "FACE":
            result = values[polygons[new.face_source]]
        else:
            result = np.where((edges >= 0)[:, None], values[np.maximum(edges, 0)], 0)
        _write(target, result)
    _keep_hard(old, made, edges)
    made.update()


def _keep_hard(old: bpy.types.Mesh, made: bpy.types.Mesh, edges: Ints) -> None:
    """Mark as sharp what was shaded so without a mark: vertices are no longer repeated there, and
    custom normals are lost.
    """
    marked = np.empty(len(made.edges), bool)
    made.edges.foreach_get("use_edge_sharp", marked)
    marked |= (edges >= 0) & hard_edges(old)[np.maximum(edges, 0)]
    if marked.any():
        made.edges.foreach_set("use_edge_sharp", marked)


def _at_corners(values: NDArray[Any], corners: Ints, new: NewMesh, mixed: bool) -> NDArray[Any]:
    if mixed:
        return new.at_corners(values[corners]).reshape(-1, values.shape[1])
    nearest = np.take_along_axis(
        corners[new.corner_source], new.corner_weights.argmax(axis=2)[..., None], axis=2
    )
    return values[nearest.ravel()]


def _old_edge_of_each(old: bpy.types.Mesh, made: bpy.types.Mesh, new: NewMesh) -> Ints:
    """The old edge on which each new edge lies; -1 if there is none."""
    size = max(len(old.vertices), len(made.vertices)) + 1
    old_ends, ends = np.sort(edge_vertices(old), axis=1), np.sort(edge_vertices(made), axis=1)
    by_old = {int(a) * size + int(b): k for k, (a, b) in enumerate(old_ends)}
    there = [by_old.get(int(c) * size + int(d), -1) for c, d in new.line_source]
    there = _from_neighbors(np.array(there, np.int32), new.lines, read_points(made)).tolist()
    on_line = {int(a) * size + int(b): k for (a, b), k in zip(new.lines, there, strict=True)}
    return np.array([on_line.get(int(a) * size + int(b), -1) for a, b in ends], np.int32)


def _from_neighbors(found: Ints, lines: Ints, places: Floats) -> Ints:
    """Old edges (k,) of new lines, where none was found those of the neighbor that goes on most
    straight: a line that cuts a corner of the old mesh lies within a face.
    """
    ways = places[lines[:, 1]] - places[lines[:, 0]]
    ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-30)
    at: dict[int, list[int]] = {}
    for k, (a, b) in enumerate(lines.tolist()):
        at.setdefault(a, []).append(k)
        at.setdefault(b, []).append(k)
    filled = found.copy()
    for k in np.nonzero(found < 0)[0].tolist():
        near = [one for end in lines[k].tolist() for one in at[end] if found[one] >= 0]
        if near:
            filled[k] = found[near[np.abs(ways[near] @ ways[k]).argmax()]]
    return filled


def _read(attribute: bpy.types.Attribute) -> NDArray[Any]:
    field, kind, width = _KINDS[attribute.data_type]
    values: NDArray[Any] = np.empty(len(attribute.data) * width, kind)
    attribute.data.foreach_get(field, values)
    return values.reshape(-1, width)


def _write(attribute: bpy.types.Attribute, values: NDArray[Any]) -> None:
    field, kind, _ = _KINDS[attribute.data_type]
    attribute.data.foreach_set(field, np.ascontiguousarray(values, kind).ravel())
