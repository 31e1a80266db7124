# SPDX-License-Identifier: GPL-3.0-or-later
"""How often each object of a collection is picked, in the order in which nodes have them."""

from typing import Any

import bpy

from ...core.settings.weights import packed, sort_key


def weights_text(kind: bpy.types.PropertyGroup) -> str:
    """What the node group is told of an object type's weights; empty: all are picked alike."""
    if not kind.use_weights or kind.collection is None:
        return ""
    return packed([one.weight for one in kind.weights])


def follow_members(kind: bpy.types.PropertyGroup) -> bool:
    """Have an entry for each member of the collection, which keeps its weight; whether that was
    another one before.

    A library override has those of its library.
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
    """Whether the entries are those of the collection."""
    return [_member(one) for one in kind.weights] == members(kind.collection)


def members(collection: bpy.types.Collection | None) -> list[Any]:
    """Objects and collections in a collection, in the order in which nodes have them."""
    if collection is None:
        return []
    return sorted([*collection.children, *collection.objects], key=lambda one: sort_key(one.name))


def is_picked(kind: bpy.types.PropertyGroup, member: bpy.types.ID) -> bool:
    """Whether a member of the collection is ever placed."""
    weights = {_member(one): one.weight for one in kind.weights} if kind.use_weights else {}
    return weights.get(member, 1.0) > 0.0


def _member(entry: bpy.types.PropertyGroup) -> bpy.types.ID | None:
    return entry.object or entry.collection
