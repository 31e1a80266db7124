# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of the scene that a density depends on, and their lines if they have no faces."""

from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np

from ...core.bake.keys import Baked
from ...core.base.errors import ScatterError
from ...core.settings.values import DensitySettings
from ...core.surface.arrays import Floats
from ...core.surface.records import check_columns
from ..base.mesh_arrays import matrix_of, read_points, to_world
from ..scatter.object import is_scatter
from .joined_parts import parts_of
from .playback import points_now

_MESHES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


def own_objects(scatter: bpy.types.Object | None) -> Iterator[bpy.types.Object]:
    """A scatter, its tiles and its instanced objects: it must not avoid its own result."""
    if scatter is None:
        return
    settings = scatter.dapple
    yield scatter
    yield from _with_its_mesh(settings.tiles.object)
    for placed in (settings, *settings.object_types):
        if placed.instance:
            yield placed.instance
        if placed.collection:
            yield from placed.collection.all_objects


def _with_its_mesh(made: bpy.types.Object | None) -> Iterator[bpy.types.Object]:
    """An object and its linked duplicates."""
    if made is not None:
        yield from (one for one in bpy.data.objects if one.data == made.data)


def obstacles_of(
    name: str, surface: bpy.types.Object, scatter: bpy.types.Object | None
) -> list[bpy.types.Object]:
    """Objects of a collection that a scatter on a surface has to avoid."""
    return list(_obstacles(name, {*parts_of(surface), *own_objects(scatter)}))


def _obstacles(name: str, own: set[bpy.types.Object]) -> Iterator[bpy.types.Object]:
    """Objects of a collection, including nested ones, that points have to avoid."""
    for obj in _seen(name):
        if obj.type in _MESHES and obj not in own:
            yield obj


def _seen(name: str) -> list[bpy.types.Object]:
    """Objects of a collection, including nested ones, in the view layer."""
    collection = by_full_name(bpy.data.collections, name)
    if collection is None:
        raise ScatterError(f"There is no collection '{name}'")
    there = set(bpy.context.view_layer.objects)
    return [obj for obj in collection.all_objects if obj in there]


def targets_of(
    density: DensitySettings, surface: bpy.types.Object, scatter: bpy.types.Object | None
) -> list[bpy.types.Object]:
    """Objects to which the density's distance is measured; empty if none was chosen."""
    found: dict[bpy.types.Object, None] = {}
    if density.use_distance and density.distance_object:
        chosen = by_full_name(bpy.data.objects, density.distance_object)
        if chosen is None:
            raise ScatterError(f"There is no object '{density.distance_object}'")
        found |= {chosen: None} if chosen not in (surface, scatter) else {}
    if density.use_distance and density.distance_collection:
        own = {*parts_of(surface), *own_objects(scatter)}
        there = [obj for obj in _seen(density.distance_collection) if obj not in own]
        found |= dict.fromkeys(there)
    return list(found)


def check_targets(density: DensitySettings, count: int) -> None:
    """ScatterError if a distance is measured, but there is no object to measure it to."""
    chosen = [one for one in (density.distance_object, density.distance_collection) if one]
    if density.use_distance and chosen and not count:
        named = " and ".join(f"'{one}'" for one in chosen)
        raise ScatterError(
            f"Distance: there is nothing in {named} to measure to, other than the surface and what "
            "the scatter makes itself"
        )


def by_full_name(blocks: Any, name: str) -> Any:
    """The data-block with this full name, which includes its file; None if there is none."""
    return next((one for one in blocks if one.name_full == name), None)


def read_lines(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, known: dict[int, Baked] | None = None
) -> Floats | None:
    """Line segments (k, 2, 3) in world space, or points as segments; None if it has faces.

    A curve without bevel is read as its line, a scatter as its points, a mesh without faces as its
    edges or vertices. An object without a shape is a point at its origin.
    """
    evaluated = obj.evaluated_get(depsgraph)
    found: Floats | None
    if is_scatter(obj):
        places, there = points_now(obj, {} if known is None else known)
        found = _points(places[there])
    elif obj.type in _MESHES:
        found = _of_mesh(evaluated)
    elif obj.type == "CURVES":
        found = _of_strands(evaluated)
    else:
        found = _points(matrix_of(evaluated)[None, :3, 3])
    if found is not None:
        check_columns({"position": found.reshape(-1, 3)}, obj.name)
    return found


def _of_mesh(evaluated: bpy.types.Object) -> Floats | None:
    mesh = evaluated.to_mesh() if evaluated.is_evaluated else None
    if mesh is None:
        raise ScatterError(
            f"Object '{evaluated.name}', to which a distance is measured, is not evaluated: it "
            "must be in the view layer and not disabled"
        )
    try:
        if len(mesh.polygons):
            return None
        places = to_world(evaluated, read_points(mesh))
        edges = np.empty(2 * len(mesh.edges), dtype=np.int32)
        mesh.edges.foreach_get("vertices", edges)
    finally:
        evaluated.to_mesh_clear()
    loose = np.ones(len(places), dtype=bool)
    loose[edges] = False
    return np.concatenate([places[edges.reshape(-1, 2)], _points(places[loose])])


def _of_strands(evaluated: bpy.types.Object) -> Floats:
    """Lines through the control points of strands, such as hair."""
    curves = evaluated.data.curves
    if not len(curves):
        return np.empty((0, 2, 3))
    lengths = np.empty(len(curves), dtype=np.int32)
    curves.foreach_get("points_length", lengths)
    stored = np.empty(3 * int(lengths.sum()), dtype=np.float32)
    evaluated.data.attributes["position"].data.foreach_get("vector", stored)
    places = to_world(evaluated, stored.reshape(-1, 3).astype(np.float64))
    inner = np.ones(len(places), dtype=bool)
    inner[np.cumsum(lengths) - 1] = False  # the last point of each strand
    first = np.flatnonzero(inner)
    return np.stack([places[first], places[first + 1]], axis=1)


def _points(places: Floats) -> Floats:
    """Points (k, 3) as segments."""
    return np.repeat(places[:, None], 2, axis=1)
