# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface that Add uses: one object or several joined ones, and updates of its parts.

A joined surface is not in any collection, since its parts are visible. It is removed with its last
scatter. Blender evaluates it for the visible scatters.
"""

from collections.abc import Iterator
from contextlib import contextmanager, suppress

import bpy

from ...core.base.errors import ScatterError
from ...nodes import get_input, has_input
from ..base.object_handles import ObjectHandle
from ..base.quiet import quiet
from ..scatter.linked_data import open_collections, read_only
from ..scatter.modifier import scatter_modifier
from ..scatter.object import is_scatter, is_surface, kind_of, surface_of
from .joined_parts import (
    SUFFIX,
    Piece,
    is_joined,
    is_member,
    pieces_in,
    pieces_kept,
    pieces_of,
    pieces_of_collection,
    wanted,
    write_pieces,
)


def chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The objects that Add uses: the selected ones if the active one is among them, else the active
    one.
    """
    active = context.object
    if active is None or is_scatter(active):
        return []
    if not active.select_get():
        selected = [active]
    else:
        selected = [active, *(obj for obj in context.selected_objects if obj != active)]
    return [obj for obj in selected if is_surface(obj) or is_member(obj)]


@contextmanager
def surface_over(
    context: bpy.types.Context, collection: bpy.types.Collection | None = None
) -> Iterator[ObjectHandle]:
    """The surface made of the chosen objects or a collection; a new one is removed if Add fails."""
    objects = [] if collection else chosen(context)
    if len(objects) == 1 and is_surface(objects[0]):
        yield ObjectHandle(objects[0])
        return
    pieces = _pieces(objects, collection)
    known = _known(pieces, collection)
    if known is not None:
        with renewed(known):
            yield known
        return
    with _new(pieces, collection) as new, evaluated(new):
        yield new


def other_selected(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Selected objects besides the active scatter that can be its surface or a part of it."""
    return [
        obj
        for obj in context.selected_objects
        if obj != context.object and not is_scatter(obj) and (is_surface(obj) or is_member(obj))
    ]


def put_on_selected(context: bpy.types.Context) -> None:
    """Use the other selected objects as the active scatter's surface; its points become outdated.

    Existing parts keep their order.
    """
    scatter, objects = context.object, other_selected(context)
    if len(objects) == 1 and is_surface(objects[0]):
        scatter.dapple.surface = objects[0]
        return
    pieces = _pieces(objects, None)
    before = scatter.dapple.surface
    known = pieces_of(before) if before is not None else []
    ordered = [piece for piece in known if piece in pieces]
    ordered += [piece for piece in pieces if piece not in known]
    found = _known(pieces, None)
    if found is None:
        with _new(ordered, None) as found:
            scatter.dapple.surface = found.get()
    else:
        scatter.dapple.surface = found.get()


@contextmanager
def surface_for(scatter: bpy.types.Object) -> Iterator[ObjectHandle]:
    """The surface for solving or attaching a scatter; a joined one is updated first."""
    surface = ObjectHandle(surface_of(scatter))
    with renewed(surface):
        yield surface


@contextmanager
def renewed(surface: ObjectHandle) -> Iterator[None]:
    """Update the parts of a joined surface; the update stays unless the code inside fails."""
    obj = surface.get()
    if not is_joined(obj) or read_only(obj):
        yield
        return
    with pieces_kept(surface), evaluated(surface):
        pieces = wanted(obj)
        if not pieces:
            raise ScatterError(f"No part of surface '{obj.name}' is left: choose another surface")
        if pieces != pieces_of(obj):
            write_pieces(obj, pieces)
        yield


def _pieces(
    objects: list[bpy.types.Object], collection: bpy.types.Collection | None
) -> list[Piece]:
    other = next((obj for obj in objects if not is_member(obj)), None)
    if other is not None:
        raise ScatterError(
            f"'{other.name}' is a {kind_of(other)}, which cannot be one surface with other "
            "objects: scatter over it alone"
        )
    pieces = pieces_of_collection(collection) if collection else pieces_in(objects)
    if not pieces:
        name = collection.name if collection else objects[0].name
        raise ScatterError(f"'{name}' has no mesh objects that are shown and rendered")
    return pieces


def _known(pieces: list[Piece], collection: bpy.types.Collection | None) -> ObjectHandle | None:
    """The existing joined surface of these parts; None if there is none."""
    for obj in bpy.data.objects:
        ours = is_joined(obj) and not read_only(obj) and obj.dapple.joined.collection == collection
        if ours and (collection is not None or set(pieces_of(obj)) == set(pieces)):
            return ObjectHandle(obj)
    return None


@contextmanager
def _new(pieces: list[Piece], collection: bpy.types.Collection | None) -> Iterator[ObjectHandle]:
    groups = set(bpy.data.node_groups)
    named = collection or (*pieces[0].path, pieces[0].object)[0]
    name = f"{named.name}{SUFFIX}"
    obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    try:
        obj.dapple.joined.collection = collection
        obj.hide_viewport = obj.hide_render = True
        obj.display_type = "BOUNDS"
        write_pieces(obj, pieces)
        yield ObjectHandle(obj)
    except BaseException:
        bpy.data.meshes.remove(obj.data)  # and the object with it
        bpy.data.batch_remove(set(bpy.data.node_groups) - groups)
        raise


def _is_played(surface: bpy.types.Object) -> bool:
    """Whether a visible scatter makes Blender evaluate a joined surface."""
    shown = (obj for obj in bpy.context.view_layer.objects if is_scatter(obj) and obj.visible_get())
    return any(_plays(obj, surface) for obj in shown)


def _plays(scatter: bpy.types.Object, surface: bpy.types.Object) -> bool:
    modifier = scatter_modifier(scatter)
    if modifier is None or not modifier.show_viewport or not has_input(modifier, "Surface"):
        return False
    return bool(get_input(modifier, "Surface") == surface)


@contextmanager
def evaluated(surface: ObjectHandle) -> Iterator[None]:
    """Make Blender evaluate a joined surface inside, even if no scatter on it is visible."""
    obj, scene = surface.get(), bpy.context.scene
    if _is_played(obj):
        yield
        return
    with quiet():
        scene.collection.objects.link(obj)
        obj.hide_viewport = False
    try:
        yield
    finally:
        with suppress(ScatterError, ReferenceError, RuntimeError):  # it was removed
            surface.get().hide_viewport = True
            scene.collection.objects.unlink(surface.get())


def home_of(
    surface: bpy.types.Object, context: bpy.types.Context
) -> tuple[bpy.types.Collection, str]:
    """The collection for objects that belong to a surface, and the object that names them.

    The objects are then shown and hidden together with the surface.
    """
    if not is_joined(surface):
        return _open_collection(surface, context), surface.name
    return _open_collection(_first(surface), context, surface.dapple.joined.collection), (
        surface.name.removesuffix(SUFFIX)
    )


def _open_collection(
    obj: bpy.types.Object,
    context: bpy.types.Context,
    wished: bpy.types.Collection | None = None,
) -> bpy.types.Collection:
    """A collection of the scene that accepts objects: the preferred one or one of the object's."""
    found = open_collections(obj)
    if wished is not None and not (wished.library or wished.override_library):
        found.insert(0, wished)
    inside = set(context.scene.collection.children_recursive) | {context.scene.collection}
    return next((one for one in found if one in inside), context.scene.collection)


def _first(surface: bpy.types.Object) -> bpy.types.Object:
    pieces = pieces_of(surface)
    return (*pieces[0].path, pieces[0].object)[0] if pieces else surface
