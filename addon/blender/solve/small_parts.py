# SPDX-License-Identifier: GPL-3.0-or-later
"""Which parts of a surface are too small for a whole point, as objects and faces of the artist."""

from collections import Counter
from typing import NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.base.native import named
from ...core.density.masked_surface import masked_surface_of
from ...core.solve.class_counts import wanted_counts
from ...core.solve.small_parts import small_parts
from ..base.mesh_arrays import polygon_starts
from ..scatter.object import settings_of, surface_of
from ..surface.joined_parts import Piece, is_joined, pieces_of
from ..surface.mesh import evaluated, evaluated_mesh
from ..surface.reading import read

_NAMED = 3  # most names in a message
_VERTICES, _EDGES, _POLYGONS = "vertices", "edges", "polygons"
Polygons = NDArray[np.int64]


class SmallPart(NamedTuple):
    """A part of an object's mesh after its modifiers."""

    object: bpy.types.Object
    polygons: Polygons  # (k,)
    name: str  # of its material, or of its object where that is one of several


def small_parts_of(scatter: bpy.types.Object) -> list[SmallPart]:
    """The parts of a scatter's surface that are too small for a whole point, as it is now."""
    settings, surface = settings_of(scatter), surface_of(scatter)
    arrays = read(surface, settings, scatter)
    with named(surface.name):
        masked = masked_surface_of(arrays, settings)
        parts = small_parts(masked, sum(wanted_counts(masked, settings)))
    with evaluated_mesh(surface, evaluated()) as mesh:
        starts = polygon_starts(mesh)
        materials = np.zeros(len(starts), dtype=np.int32)
        mesh.polygons.foreach_get("material_index", materials)
    corners = arrays.face_corners[:, 0]
    polygons = [
        np.unique(np.searchsorted(starts, corners[part], side="right") - 1) for part in parts
    ]
    if is_joined(surface):
        return _of_pieces(pieces_of(surface), polygons)
    slots = surface.material_slots
    return [SmallPart(surface, own, _name(surface, slots, materials[own[0]])) for own in polygons]


def _name(obj: bpy.types.Object, slots: bpy.types.bpy_prop_collection, index: int) -> str:
    material = slots[index].material if index < len(slots) else None
    return str(material.name if material is not None else obj.name)


def _of_pieces(pieces: list[Piece], polygons: list[Polygons]) -> list[SmallPart]:
    """Parts of a joined surface, whose polygons are those of its pieces one after the other."""
    counts = []
    for piece in pieces:
        with evaluated_mesh(piece.object, evaluated()) as mesh:
            counts.append(len(mesh.polygons))
    ends = np.cumsum(counts)
    found = []
    for own in polygons:
        k = int(np.searchsorted(ends, own[0], side="right"))
        obj = pieces[k].object
        found.append(SmallPart(obj, own - (ends[k] - counts[k]), obj.name))
    return found


def names_of(parts: list[SmallPart]) -> str:
    """The names that occur most often, with the number of parts of each."""
    counts = Counter(part.name for part in parts).most_common()
    shown = [f"{name} ({count:,})" for name, count in counts[:_NAMED]]
    return ", ".join([*shown, *(("...",) if len(counts) > _NAMED else ())])


def select(context: bpy.types.Context, parts: list[SmallPart]) -> None:
    """Select the objects of these parts and no others, and the faces of the parts in them. Where
    modifiers change the faces, none are selected.
    """
    objects = list(dict.fromkeys(part.object for part in parts))
    for obj in context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        if obj.name in context.view_layer.objects:
            obj.select_set(True)
            context.view_layer.objects.active = obj
        if obj.type == "MESH":
            chosen = [part.polygons for part in parts if part.object == obj]
            _select_faces(obj, np.unique(np.concatenate(chosen)))


def _select_faces(obj: bpy.types.Object, polygons: Polygons) -> None:
    mesh = obj.data
    with evaluated_mesh(obj, evaluated()) as shown:
        alike = len(shown.polygons) == len(mesh.polygons)
    chosen = {
        name: np.zeros(len(getattr(mesh, name)), bool) for name in (_VERTICES, _EDGES, _POLYGONS)
    }
    if alike:
        chosen[_POLYGONS][polygons] = True
        corners = np.repeat(
            chosen[_POLYGONS], np.diff(np.append(polygon_starts(mesh), len(mesh.loops)))
        )
        for name, per_corner in ((_VERTICES, "vertex_index"), (_EDGES, "edge_index")):
            index = np.empty(len(mesh.loops), dtype=np.int32)
            mesh.loops.foreach_get(per_corner, index)
            chosen[name][index[corners]] = True
    for name, flags in chosen.items():
        getattr(mesh, name).foreach_set("select", flags)
    mesh.update()
