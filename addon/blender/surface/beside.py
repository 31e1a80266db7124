# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects beside a surface a density depends on."""

from collections.abc import Iterator
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.settings.values import DensitySettings
from .joined import parts_of

_MESHES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


def own_objects(scatter: bpy.types.Object | None) -> Iterator[bpy.types.Object]:
    """A scatter, its tiles and what it places: it would flee from its last result."""
    if scatter is None:
        return
    settings = scatter.dapple
    yield scatter
    yield from _with_its_mesh(settings.tiles.object)
    for placed in (settings, *settings.classes):
        if placed.instance:
            yield placed.instance
        if placed.collection:
            yield from placed.collection.all_objects


def _with_its_mesh(made: bpy.types.Object | None) -> Iterator[bpy.types.Object]:
    """An object, and linked duplicates of it."""
    if made is not None:
        yield from (one for one in bpy.data.objects if one.data == made.data)


def obstacles_of(
    name: str, surface: bpy.types.Object, scatter: bpy.types.Object | None
) -> list[bpy.types.Object]:
    """Objects of a collection that a scatter on a surface keeps off."""
    return list(_obstacles(name, {*parts_of(surface), *own_objects(scatter)}))


def _obstacles(name: str, own: set[bpy.types.Object]) -> Iterator[bpy.types.Object]:
    """Objects of a collection and those inside it that points have to avoid."""
    for obj in _seen(name):
        if obj.type in _MESHES and obj not in own:
            yield obj


def _seen(name: str) -> list[bpy.types.Object]:
    """Objects of a collection and those inside it that are in the view layer."""
    collection = by_full_name(bpy.data.collections, name)
    if collection is None:
        raise ScatterError(f"There is no collection '{name}'")
    there = set(bpy.context.view_layer.objects)
    return [obj for obj in collection.all_objects if obj in there]


def targets_of(
    density: DensitySettings, surface: bpy.types.Object, scatter: bpy.types.Object | None
) -> list[bpy.types.Object]:
    """Objects that the distance of a density is measured to; none where none was chosen."""
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
    """ScatterError if a distance is to be measured and there is nothing that it can be to."""
    chosen = [one for one in (density.distance_object, density.distance_collection) if one]
    if density.use_distance and chosen and not count:
        named = " and ".join(f"'{one}'" for one in chosen)
        raise ScatterError(
            f"Distance: there is nothing in {named} to measure to, other than the surface and what "
            "the scatter makes itself"
        )


def by_full_name(blocks: Any, name: str) -> Any:
    """The data-block of that full name, which names its file too; None if there is none."""
    return next((one for one in blocks if one.name_full == name), None)
