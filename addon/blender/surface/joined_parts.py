# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a joined surface: an object whose node group joins the meshes of other objects.

A scatter on several objects has such a surface, so all other code handles a single object. It is
not in any collection, since its parts are visible. The node group is built from its list of parts.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import NamedTuple, TypeGuard

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...nodes.joined_surface import KEY, Joined, Offset, build
from ..base.all_or_nothing import once_done
from ..base.object_handles import ObjectHandle
from ..base.quiet import quiet
from ..scatter.object import is_scatter

_CELLS = 8  # cells of rest positions in a row
SUFFIX = " Surface"  # suffix of the names of joined surfaces
_GAP = 2.0  # gap between two parts, relative to their size
_TYPES = {"MESH", "CURVE", "SURFACE", "FONT"}
Rest = tuple[float, Offset]  # scale and shift of rest positions


class Piece(NamedTuple):
    """A part, and the chain of objects that instance its collection, outermost first."""

    object: bpy.types.Object
    path: tuple[bpy.types.Object, ...] = ()


def is_joined(obj: bpy.types.Object | None) -> TypeGuard[bpy.types.Object]:
    """Whether an object joins the meshes of others."""
    return obj is not None and len(obj.dapple.joined.entries) > 0


def can_be_joined(obj: bpy.types.Object) -> bool:
    """Whether nodes can read the mesh of an object of this type; not possible for metaballs."""
    return obj.type in _TYPES and not is_joined(obj)


def pieces_of(surface: bpy.types.Object) -> list[Piece]:
    """The existing parts of a joined surface in their order."""
    return [piece for piece in _listed(surface.dapple.joined) if piece is not None]


def has_lost_some(surface: bpy.types.Object) -> bool:
    """Whether parts of a joined surface were deleted from the file."""
    return None in _listed(surface.dapple.joined)


def _listed(joined: bpy.types.PropertyGroup) -> list[Piece | None]:
    """The parts in their order; None for a part that was deleted or whose instance was."""
    paths: list[tuple[bpy.types.Object | None, ...]] = []
    found: list[Piece | None] = []
    for entry in joined.entries:
        around = paths[entry.inside] if entry.inside >= 0 else ()
        paths.append((*around, entry.object))
        if not entry.instances:
            found.append(None if None in paths[-1] else Piece(entry.object, around))
    return found


def parts_of(surface: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects whose meshes form a surface: the parts of a joined one, or the object itself."""
    if not is_joined(surface):
        return [surface]
    return list(dict.fromkeys(piece.object for piece in pieces_of(surface)))


def mesh_with_uv_maps(surface: bpy.types.Object) -> bpy.types.ID:
    """The first mesh of a surface that has UV maps, else the surface's own data."""
    meshes = (part.data for part in parts_of(surface) if part.type == "MESH")
    return next((one for one in meshes if one.uv_layers), surface.data)


def objects_of(surface: bpy.types.Object) -> list[bpy.types.Object]:
    """The parts of a joined surface and the objects that instance them."""
    found = (obj for piece in pieces_of(surface) for obj in (*piece.path, piece.object))
    return list(dict.fromkeys(found))


def write_pieces(surface: bpy.types.Object, pieces: list[Piece]) -> None:
    """Replace the parts of a joined surface; parts that stay keep their rest positions."""
    with quiet():
        joined = surface.dapple.joined
        known = _rests(joined)
        for piece in pieces:
            if piece not in known:
                known[piece] = _rest(piece.object, joined.cells)
                joined.cells += 1
        _write_entries(joined, pieces, known)
        _write_group(surface)


def copied_with(
    surface: bpy.types.Object, copies: dict[bpy.types.Object, bpy.types.Object]
) -> bpy.types.Object:
    """A joined surface of copied parts, each with the rest positions of its original.

    It no longer follows a collection.
    """
    copy = surface.copy()
    copy.data = surface.data.copy()
    joined = copy.dapple.joined
    joined.collection = None
    for entry in joined.entries:
        entry.object = copies.get(entry.object, entry.object)
    _modifier(copy).node_group = None
    first = joined.entries[0].object
    copy.name = copy.data.name = f"{first.name if first else surface.name}{SUFFIX}"
    _write_group(copy)
    return copy


@contextmanager
def pieces_kept(surface: ObjectHandle) -> Iterator[None]:
    """Restore the parts of a joined surface if the code inside fails or is canceled."""
    joined = surface.get().dapple.joined
    before, rests = pieces_of(surface.get()), _rests(joined)
    try:
        yield
    except BaseException:
        with suppress(ScatterError, ReferenceError):  # the artist may have deleted any of them
            _restore(surface.get(), before, rests)
        raise


def _restore(surface: bpy.types.Object, before: list[Piece], rests: dict[Piece, Rest]) -> None:
    if pieces_of(surface) != before:
        with quiet():
            _write_entries(surface.dapple.joined, before, rests)
            _write_group(surface)


def _rests(joined: bpy.types.PropertyGroup) -> dict[Piece, Rest]:
    own = [one for one in joined.entries if not one.instances]
    return {
        piece: (one.rest_scale, tuple(one.rest_shift))
        for piece, one in zip(_listed(joined), own, strict=True)
        if piece is not None
    }


def _rest(obj: bpy.types.Object, cell: int) -> Rest:
    """Scale and shift that move the rest positions of a part into a cell of its own."""
    low, high = _extent(obj)
    scale = 1.0 / max(float(np.max(high - low)), 1e-6)
    place = np.array([cell % _CELLS, cell // _CELLS % _CELLS, cell // _CELLS**2], dtype=np.float64)
    shift = _GAP * place - 0.5 * scale * (low + high)
    return scale, tuple(shift.tolist())


def _extent(obj: bpy.types.Object) -> tuple[np.ndarray, np.ndarray]:
    if obj.type != "MESH" or not len(obj.data.vertices):
        corners = np.array(obj.bound_box)
        return corners.min(axis=0), corners.max(axis=0)
    places = np.empty((len(obj.data.vertices), 3), dtype=np.float32)
    obj.data.vertices.foreach_get("co", places.ravel())
    return places.min(axis=0).astype(np.float64), places.max(axis=0).astype(np.float64)


def _write_entries(
    joined: bpy.types.PropertyGroup,
    pieces: list[Piece],
    rests: dict[Piece, Rest],
) -> None:
    joined.entries.clear()
    known: dict[tuple[bpy.types.Object, ...], int] = {(): -1}  # instancing entries
    for piece in pieces:
        for depth in range(1, len(piece.path) + 1):
            path = piece.path[:depth]
            if path not in known:
                _add(joined, path[-1], known[path[:-1]]).instances = True
                known[path] = len(joined.entries) - 1
        entry = _add(joined, piece.object, known[piece.path])
        entry.rest_scale, entry.rest_shift = rests[piece]


def _add(
    joined: bpy.types.PropertyGroup, obj: bpy.types.Object, inside: int
) -> bpy.types.PropertyGroup:
    entry = joined.entries.add()
    entry.object, entry.inside = obj, inside
    return entry


def _write_group(surface: bpy.types.Object) -> None:
    """Rebuild the node group, for this surface alone."""
    entries = surface.dapple.joined.entries
    parts = [
        Joined(one.object, one.inside, one.instances, one.rest_scale, tuple(one.rest_shift))
        for one in entries
    ]
    modifier = _modifier(surface)
    before = modifier.node_group
    modifier.node_group = build(surface.name, parts)
    if before is not None:
        once_done(lambda: _remove(before))


def _remove(group: bpy.types.NodeTree) -> None:
    with suppress(ReferenceError):  # it was removed
        if not group.users:
            bpy.data.node_groups.remove(group)


def _modifier(surface: bpy.types.Object) -> bpy.types.NodesModifier:
    for modifier in surface.modifiers:
        if modifier.type == "NODES" and (not modifier.node_group or KEY in modifier.node_group):
            return modifier
    return surface.modifiers.new("Join", "NODES")


def instanced(obj: bpy.types.Object) -> bpy.types.Collection | None:
    """The collection that an empty instances; None if it does not."""
    return obj.instance_collection if obj.instance_type == "COLLECTION" else None


def is_member(obj: bpy.types.Object) -> bool:
    """Whether an object can be a part or instances objects that can."""
    return (can_be_joined(obj) and not is_scatter(obj)) or instanced(obj) is not None


def pieces_in(objects: Iterable[bpy.types.Object]) -> list[Piece]:
    """The parts that these objects are or instance."""
    made = _made()
    found = dict(_pieces(objects, made, ()))
    return [piece for piece, shown in found.items() if shown]


def pieces_of_collection(collection: bpy.types.Collection) -> list[Piece]:
    """The parts in a collection."""
    found = dict(_collected(collection, _made(), (), True))
    return [piece for piece, shown in found.items() if shown]


def wanted(surface: bpy.types.Object) -> list[Piece]:
    """The parts that a joined surface should have now: known parts keep their order, new ones
    follow.
    """
    before, collection = pieces_of(surface), surface.dapple.joined.collection
    if collection is not None:
        found = dict(_collected(collection, _made(), (), True))
    else:
        roots = dict.fromkeys((*piece.path, piece.object)[0] for piece in before)
        found = dict(_pieces(filter(_is_there, roots), _made(), ()))
    new = [piece for piece, shown in found.items() if shown and piece not in before]
    return [piece for piece in before if piece in found] + new


def members_of(surface: bpy.types.Object | None) -> list[bpy.types.Object]:
    """A surface; for a joined one, also the parts that it should have now."""
    if surface is None:
        return []
    found = [one for piece in wanted(surface) for one in (*piece.path, piece.object)]
    return list(dict.fromkeys([surface, *found]))


def collections_of(surface: bpy.types.Object | None) -> list[bpy.types.Collection]:
    """Collections, including nested ones, whose objects are parts of a joined surface."""
    found = [instanced(obj) for obj in members_of(surface)]
    if surface is not None:
        found.append(surface.dapple.joined.collection)
    return [one for root in filter(None, found) for one in (root, *root.children_recursive)]


def _is_there(obj: bpy.types.Object) -> bool:
    """Whether it still exists; Blender keeps deleted objects that are referenced."""
    return obj.library is not None or bool(obj.users_collection)


def _made() -> set[bpy.types.Object]:
    """Objects that scatters have created."""
    found = {obj.dapple.tiles.object for obj in bpy.data.objects if is_scatter(obj)}
    return {obj for obj in found if obj is not None}


def _pieces(
    objects: Iterable[bpy.types.Object],
    made: set[bpy.types.Object],
    path: tuple[bpy.types.Object, ...],
    shown: bool = True,
) -> Iterator[tuple[Piece, bool]]:
    """Parts, and whether they are visible."""
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
