# SPDX-License-Identifier: GPL-3.0-or-later
"""Instanced objects: weights of the members of a collection, radii of instances."""

import math
from collections.abc import Iterator
from typing import Any

import bpy
import numpy as np

from ...core.settings.weights import packed, sort_key
from ...core.surface.arrays import Floats
from ..base.mesh_arrays import read_points
from .object import scale_of

_SAME = 1e-5  # relative change of a radius that is ignored


def weights_text(kind: bpy.types.PropertyGroup) -> str:
    """The weights of an object type as text for the node group; empty if all are equal."""
    if not kind.use_weights or kind.collection is None:
        return ""
    return packed([one.weight for one in kind.weights])


def follow_members(kind: bpy.types.PropertyGroup) -> bool:
    """Update the list of weights to the members of the collection, which keep their weights;
    returns whether the list has changed.

    A library override keeps the list of its library.
    """
    if not kind.use_weights or kind.id_data.override_library is not None:
        return False
    if is_listed(kind):
        return False
    before = {_member(one): one.weight for one in kind.weights}
    kind.weights.clear()
    for member in members(kind.collection):
        one = kind.weights.add()
        name = "object" if isinstance(member, bpy.types.Object) else "collection"
        setattr(one, name, member)
        one.weight = before.get(member, 1.0)
    return True


def is_listed(kind: bpy.types.PropertyGroup) -> bool:
    """Whether the list of weights matches the members of the collection."""
    return [_member(one) for one in kind.weights] == members(kind.collection)


def members(collection: bpy.types.Collection | None) -> list[Any]:
    """Objects and collections in a collection, in the order that nodes use."""
    if collection is None:
        return []
    return sorted([*collection.children, *collection.objects], key=lambda one: sort_key(one.name))


def is_picked(kind: bpy.types.PropertyGroup, member: bpy.types.ID) -> bool:
    """Whether a member of the collection has a positive weight."""
    weights = {_member(one): one.weight for one in kind.weights} if kind.use_weights else {}
    return weights.get(member, 1.0) > 0.0


def _member(entry: bpy.types.PropertyGroup) -> bpy.types.ID | None:
    return entry.object or entry.collection


def follow_bounds(kind: bpy.types.PropertyGroup, depsgraph: bpy.types.Depsgraph) -> None:
    """Set the radius of an object type to that of its instances, if it follows their bounds."""
    if not kind.radius_from_bounds:
        return
    radius = _footprint(kind, depsgraph) * scale_of(kind)
    if not math.isclose(radius, kind.radius, rel_tol=_SAME):
        kind.radius = radius


def _footprint(kind: bpy.types.PropertyGroup, depsgraph: bpy.types.Depsgraph) -> float:
    """Radius of the circle around the Z axis that contains all instances."""
    reaches = [
        float(np.hypot(places[:, 0], places[:, 1]).max(initial=0.0))
        for places in instanced_vertices(kind, depsgraph)
    ]
    return max(reaches, default=0.0)


def instanced_objects(kind: bpy.types.PropertyGroup) -> list[bpy.types.Object]:
    """The objects that an object type instances, also those with a weight of 0."""
    chosen = kind.collection
    if chosen is None or not (chosen.objects or chosen.children):
        return [] if kind.instance is None else [kind.instance]
    return list(chosen.all_objects)


def instanced_vertices(
    kind: bpy.types.PropertyGroup, depsgraph: bpy.types.Depsgraph
) -> Iterator[Floats]:
    """Vertices (n, 3) of each instanced object as nodes place it: objects without their own
    transform, a collection inside another one as a whole.
    """
    chosen = kind.collection
    if chosen is None or not (chosen.objects or chosen.children):
        yield from (_vertices(one, depsgraph) for one in (kind.instance,) if one is not None)
        return
    picked = [one for one in members(chosen) if is_picked(kind, one)]
    yield from (_vertices(one, depsgraph) for one in picked if isinstance(one, bpy.types.Object))
    for inner in (one for one in picked if isinstance(one, bpy.types.Collection)):
        for one in inner.all_objects:
            matrix = np.array(one.evaluated_get(depsgraph).matrix_world)
            places = _vertices(one, depsgraph) @ matrix[:3, :3].T + matrix[:3, 3]
            yield places - np.array(inner.instance_offset)


def _vertices(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Floats:
    """Vertices of an object after its modifiers; without a mesh the corners of its bounds."""
    evaluated = obj.evaluated_get(depsgraph)
    if evaluated.type == "MESH":
        return read_points(evaluated.data)
    if evaluated.type in {"EMPTY", "LIGHT", "CAMERA", "LIGHT_PROBE", "SPEAKER"}:
        return np.zeros((0, 3))
    return np.array(evaluated.bound_box, dtype=np.float64)
