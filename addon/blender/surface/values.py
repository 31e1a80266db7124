# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of a surface: attributes, colors, vertex groups, faces of materials."""

from collections.abc import Iterable
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ...core.settings.values import MARKED, MATERIAL
from ...core.surface.arrays import Ints
from ...core.surface.mesh_snapshot import RawValues, Singles
from ..base.mesh_arrays import corner_vertices, polygon_starts
from ..base.quiet import quiet
from .joined_parts import is_joined, parts_of

_FIELDS = {"FLOAT": "value", "INT": "value", "INT8": "value", "BOOLEAN": "value"}
# Blender provides numbers of its own type as one block of memory.
_NUMPY = {"INT": np.int32, "INT8": np.int8, "BOOLEAN": np.bool_}
_COLORS = {"FLOAT_COLOR": "color", "BYTE_COLOR": "color"}
_DOMAINS = {"POINT", "FACE", "CORNER"}


def weight_names(obj: bpy.types.Object) -> list[str]:
    """Names that can be read from an object's mesh before its modifiers."""
    parts = parts_of(obj)
    groups = [group.name for part in parts for group in part.vertex_groups]
    return list(dict.fromkeys(groups + [name for part in parts for name in _attributes(part)]))


def matching_names(obj: bpy.types.Object | None, text: str) -> list[str]:
    """Those of weight_names() that match a typed text; none without an object."""
    names = weight_names(obj) if obj is not None else []
    return [name for name in names if text.lower() in name.lower()]


def _attributes(obj: bpy.types.Object) -> list[str]:
    kinds = _FIELDS.keys() | _COLORS.keys()
    return [
        one.name
        for one in getattr(obj.data, "attributes", ())  # curves, for example, have none
        if one.data_type in kinds and one.domain in _DOMAINS and not one.is_internal
        if one.name != MATERIAL
    ]


def shows_values(obj: bpy.types.Object, name: str) -> bool:
    """Whether an object has an attribute or vertex group after its modifiers; also if it is of a
    type that does not tell.
    """
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    attributes = getattr(shown.data, "attributes", None)
    return attributes is None or name in attributes or name in shown.vertex_groups


def read_weights(obj: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> RawValues:
    """Values of an object's evaluated mesh, where they are stored.

    Raises:
        ScatterError: there is no such attribute or vertex group, or it cannot be a density.
    """
    raw = raw_values(obj, mesh, name)
    if raw is None:
        raw = RawValues(name, "POINT", group_weights(obj, name))
    raw.numbers(obj.name)
    return raw


def raw_values(obj: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> RawValues | None:
    """Values of an attribute as they are stored; None if a vertex group has this name.

    Raises:
        ScatterError: there is neither, or it cannot be a density.
    """
    if name == MATERIAL:
        raise ScatterError(
            f"Surface '{obj.name}': '{name}' is the number of a material and no density: turn on "
            "Material under Masks, and choose materials there"
        )
    attribute = mesh.attributes.get(name)
    if attribute is not None and attribute.domain in _DOMAINS:
        return RawValues(name, attribute.domain, _values(obj, attribute))
    if attribute is not None and name not in obj.vertex_groups:
        raise ScatterError(
            f"Surface '{obj.name}': attribute '{name}' is on the domain "
            f"{attribute.domain.title()}: a density is one on Vertex, Face or Face Corner. Convert "
            "Attribute changes that"
        )
    _check_group(obj, name)
    return None


def _check_group(obj: bpy.types.Object, name: str) -> None:
    """A joined surface has the groups of its parts, which only the evaluated object lists."""
    owner = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()) if is_joined(obj) else obj
    if name not in owner.vertex_groups:
        raise ScatterError(f"Surface '{obj.name}' has no attribute or vertex group '{name}'")


def _values(obj: bpy.types.Object, attribute: bpy.types.Attribute) -> NDArray[Any]:
    """Numbers (k,) or colors (k, 4)."""
    kind, count = attribute.data_type, len(attribute.data)
    if kind not in _FIELDS | _COLORS:
        raise ScatterError(
            f"Surface '{obj.name}': attribute '{attribute.name}' is of the type {kind}: numbers or "
            "colors are needed"
        )
    shape = (count, 4) if kind in _COLORS else (count,)
    values: NDArray[Any] = np.empty(shape, dtype=_NUMPY.get(kind, np.float32))
    if count:
        attribute.data.foreach_get((_FIELDS | _COLORS)[kind], values.ravel())
    return values


def group_weights(obj: bpy.types.Object, name: str) -> Singles:
    """Weights (v,) of an object's evaluated vertices in a vertex group; 0 for those outside.

    Raises:
        ScatterError: there is no such group.
    """
    _check_group(obj, name)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return _weights_of(obj.evaluated_get(depsgraph), name, depsgraph)


def own_group_weights(obj: bpy.types.Object, name: str) -> Singles:
    """The same of an object's vertices before its modifiers; the group exists."""
    return _weights_of(obj, name, None)


def _weights_of(obj: bpy.types.Object, name: str, depsgraph: bpy.types.Depsgraph | None) -> Singles:
    """Weights (v,) of the vertices of an object, evaluated or not.

    Python has no array of them, and reading them vertex by vertex takes 0.2 s for 250,000 vertices.
    Blender multiplies what a shape key adds by the weights of its vertex group, so a temporary copy
    of the mesh mixes a key of zeros with one of ones, in 10 ms.
    """
    with quiet():
        mesh = bpy.data.meshes.new_from_object(obj, depsgraph=depsgraph)
        copy = bpy.data.objects.new(mesh.name, mesh)
        try:
            return _mixed(copy, name)
        finally:
            bpy.data.batch_remove([copy, mesh])


def _mixed(obj: bpy.types.Object, group: str) -> Singles:
    """Shape keys of zeros and ones, mixed by the weights of a vertex group."""
    values = np.zeros((len(obj.data.vertices), 3), dtype=np.float32)
    if not len(values) or group not in obj.vertex_groups:
        return values[:, 0]
    obj.vertex_groups[group].add([0], 0.0, "ADD")  # without any weights all count as 1
    obj.shape_key_clear()
    obj.shape_key_add(name="Zeros").points.foreach_set("co", values.ravel())
    ones = obj.shape_key_add(name="Ones")
    ones.points.foreach_set("co", np.ones_like(values).ravel())
    ones.vertex_group, ones.value = group, 1.0
    obj.shape_key_add(name="Mix").points.foreach_get("co", values.ravel())
    return np.ascontiguousarray(values[:, 0])


def surface_materials(
    surface: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> list[bpy.types.Material]:
    """Materials of the objects of a surface, followed by those that modifiers add."""
    slots = [slot.material for part in parts_of(surface) for slot in part.material_slots]
    evaluated = surface.evaluated_get(depsgraph)
    made = getattr(evaluated.data, "materials", ()) if evaluated.is_evaluated else ()
    slots += [one.original for one in made if one is not None]
    return list(dict.fromkeys(one for one in slots if one is not None))


def read_materials(obj: bpy.types.Object, mesh: bpy.types.Mesh, names: Iterable[str]) -> RawValues:
    """For each face of an object's evaluated mesh, whether it has one of these materials.

    Raises:
        ScatterError: the surface has none of them.
    """
    wanted, slots = set(names), _slots(obj, mesh)
    chosen = np.array([one in wanted for one in slots] or [False], dtype=np.float32)
    if not chosen.any():
        listed = ", ".join(f"'{name}'" for name in names)
        raise ScatterError(
            f"Surface '{obj.name}' has none of the materials that the mask Material asks for: "
            f"{listed}"
        )
    rows = np.clip(_material_indices(mesh), 0, len(chosen) - 1)
    return RawValues(MATERIAL, "FACE", chosen[rows])


def read_marked(obj: bpy.types.Object, mesh: bpy.types.Mesh, marks: Iterable[str]) -> RawValues:
    """Edges of an object's evaluated mesh with one of these marks (core/settings/edge_table.py).

    A corner has 1 + the vertex at the other end of the edge that follows it, 0 if that edge is not
    marked: pairs of vertices remain however the faces are triangulated.
    """
    chosen = np.zeros(len(mesh.edges), dtype=bool)
    for mark in marks:
        chosen |= _MARKS[mark](obj, mesh)
    ends = np.empty((len(mesh.edges), 2), dtype=np.int32)
    mesh.edges.foreach_get("vertices", ends.ravel())
    edges = _corner_edges(mesh)
    others = ends[edges].sum(axis=1) - corner_vertices(mesh)
    return RawValues(MARKED, "CORNER", np.where(chosen[edges], 1.0 + others, 0.0))


def _corner_edges(mesh: bpy.types.Mesh) -> Ints:
    """The edge (c,) after each corner."""
    edges = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.loops.foreach_get("edge_index", edges)
    return edges


def _seams(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    return _flags(mesh, "use_seam")


def _sharp(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    return _flags(mesh, "use_edge_sharp")


def _flags(mesh: bpy.types.Mesh, name: str) -> NDArray[np.bool_]:
    found = np.zeros(len(mesh.edges), dtype=bool)
    mesh.edges.foreach_get(name, found)
    return found


def _material_borders(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    """Edges (e,) between faces of different materials; the same one may be in several slots."""
    slots = _slots(obj, mesh) or [""]
    numbers = np.array([slots.index(name) for name in slots], dtype=np.int32)
    kinds = numbers[np.clip(_material_indices(mesh), 0, len(slots) - 1)]
    sizes = np.diff(np.append(polygon_starts(mesh), len(mesh.loops)))
    edges, kinds = _corner_edges(mesh), np.repeat(kinds, sizes)
    least, most = np.full(len(mesh.edges), len(slots)), np.full(len(mesh.edges), -1)
    np.minimum.at(least, edges, kinds)
    np.maximum.at(most, edges, kinds)
    found: NDArray[np.bool_] = least < most
    return found


_MARKS = {"edge_seams": _seams, "edge_sharp": _sharp, "edge_materials": _material_borders}


def _material_indices(mesh: bpy.types.Mesh) -> Ints:
    """Index (p,) of each polygon's material."""
    indices = np.zeros(len(mesh.polygons), dtype=np.int32)
    stored = mesh.attributes.get(MATERIAL)
    if stored is not None and stored.domain == "FACE" and len(indices):
        stored.data.foreach_get("value", indices)
    return indices


def _slots(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> list[str]:
    """Full names of the materials by their index; "" for empty slots.

    A slot of the object overrides the slot of its mesh, as in renders.
    """
    found = [one.original if one is not None else None for one in mesh.materials]
    for k, slot in enumerate(obj.material_slots[: len(found)]):
        if slot.link == "OBJECT":
            found[k] = slot.material
    return [one.name_full if one is not None else "" for one in found]
