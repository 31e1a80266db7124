# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects a joined surface is to consist of: those chosen for it, or those of a collection.

Objects that scatters have made are none of them. Of a collection, those that are disabled in the
viewport or in renders do not come in by themselves.
"""

from collections.abc import Iterable, Iterator

import bpy

from ..scatter.object import is_scatter
from .joined import Piece, can_be_joined, pieces_of


def instanced(obj: bpy.types.Object) -> bpy.types.Collection | None:
    """The collection that an empty instances, if it is one that does."""
    return obj.instance_collection if obj.instance_type == "COLLECTION" else None


def is_member(obj: bpy.types.Object) -> bool:
    """Whether an object can be a part, or stands for some."""
    return (can_be_joined(obj) and not is_scatter(obj)) or instanced(obj) is not None


def pieces_in(objects: Iterable[bpy.types.Object]) -> list[Piece]:
    """The parts that objects are, or stand for."""
    made = _made()
    found = dict(_pieces(objects, made, ()))
    return [piece for piece, shown in found.items() if shown]


def pieces_of_collection(collection: bpy.types.Collection) -> list[Piece]:
    """The parts that a collection has."""
    found = dict(_collected(collection, _made(), (), True))
    return [piece for piece, shown in found.items() if shown]


def wanted(surface: bpy.types.Object) -> list[Piece]:
    """What a joined surface is to consist of now: parts stay in their order, new ones follow."""
    before, collection = pieces_of(surface), surface.dapple.joined.collection
    if collection is not None:
        found = dict(_collected(collection, _made(), (), True))
    else:
        roots = dict.fromkeys((*piece.path, piece.object)[0] for piece in before)
        found = dict(_pieces(filter(_is_there, roots), _made(), ()))
    new = [piece for piece, shown in found.items() if shown and piece not in before]
    return [piece for piece in before if piece in found] + new


def members_of(surface: bpy.types.Object | None) -> list[bpy.types.Object]:
    """A surface; a joined one with what it is to consist of now."""
    if surface is None:
        return []
    found = [one for piece in wanted(surface) for one in (*piece.path, piece.object)]
    return list(dict.fromkeys([surface, *found]))


def collections_of(surface: bpy.types.Object | None) -> list[bpy.types.Collection]:
    """Those whose objects are parts of a joined surface, with those inside them."""
    found = [instanced(obj) for obj in members_of(surface)]
    if surface is not None:
        found.append(surface.dapple.joined.collection)
    return [one for root in filter(None, found) for one in (root, *root.children_recursive)]


def _is_there(obj: bpy.types.Object) -> bool:
    """Whether it was not deleted; Blender keeps what something still points to."""
    return obj.library is not None or bool(obj.users_collection)


def _made() -> set[bpy.types.Object]:
    """What scatters have made beside themselves."""
    found = {obj.dapple.tiles.object for obj in bpy.data.objects if is_scatter(obj)}
    return {obj for obj in found if obj is not None}


def _pieces(
    objects: Iterable[bpy.types.Object],
    made: set[bpy.types.Object],
    path: tuple[bpy.types.Object, ...],
    shown: bool = True,
) -> Iterator[tuple[Piece, bool]]:
    """Parts, and whether they are seen."""
    for obj in objects:
        collection = instanced(obj)
        if collection is not None:
            yield from _collected(collection, made, (*path, obj), shown)
        elif can_be_joined(obj) and not is_scatter(obj) and obj not in made:
            yield Piece(obj, path), shown


def _collected(
    collection: bpy.types.Collection,
    made: set[bpy.types.Object],
    path: tuple[bpy.types.Object, ...],
    shown: bool,
) -> Iterator[tuple[Piece, bool]]:
    shown = shown and _is_shown(collection)
    for obj in collection.objects:
        yield from _pieces([obj], made, path, shown and _is_shown(obj))
    for child in collection.children:
        yield from _collected(child, made, path, shown)


def _is_shown(one: bpy.types.Object | bpy.types.Collection) -> bool:
    return not (one.hide_viewport or one.hide_render)
