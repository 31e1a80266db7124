# SPDX-License-Identifier: GPL-3.0-or-later
"""The scatters of a surface: found, shown alone, copied, removed."""

from collections.abc import Iterable

import bpy

from ...nodes import get_input, has_input, set_input
from ..base.all_or_nothing import once_done
from ..freshness.unfinished_bakes import new_key
from ..scatter.key_stores import STORES
from ..scatter.key_writing import clear_keys
from ..scatter.library import open_collections
from ..scatter.modifier import scatter_modifier
from ..scatter.object import is_scatter
from ..surface.joined import is_joined, objects_of


def scatters_of(surface: bpy.types.Object) -> list[bpy.types.Object]:
    """Those on a surface, or a part of one, that the view layer has, by their names."""
    there = bpy.context.view_layer.objects
    return [obj for obj in there if is_scatter(obj) and _is_on(obj.dapple.surface, surface)]


def _is_on(surface: bpy.types.Object | None, obj: bpy.types.Object) -> bool:
    return surface == obj or (is_joined(surface) and obj in objects_of(surface))


def is_solo(obj: bpy.types.Object, scatters: Iterable[bpy.types.Object]) -> bool:
    """Whether it is the only one of several scatters that the viewport shows."""
    others = [one for one in scatters if one != obj]
    return bool(others) and not obj.hide_viewport and all(one.hide_viewport for one in others)


def show_solo(obj: bpy.types.Object) -> None:
    """Show no other scatter of the same surface in the viewport; once more, show all of them."""
    scatters = scatters_of(obj.dapple.surface)
    solo = is_solo(obj, scatters)
    for one in scatters:
        one.hide_viewport = not solo and one != obj


def copied(obj: bpy.types.Object) -> bpy.types.Object:
    """A copy of a scatter, with its points and its bake, in the same collections."""
    copy = obj.copy()
    copy.data = obj.data.copy()
    copy.animation_data_clear()
    copy.dapple.bake_key = new_key()
    copy.dapple.tiles.object = None
    _copy_keys(copy)
    for collection in open_collections(obj) or [bpy.context.scene.collection]:
        collection.objects.link(copy)
    return copy


def _copy_keys(copy: bpy.types.Object) -> None:
    """Have keys of its own, which it may lose alone."""
    modifier = scatter_modifier(copy)
    for name in STORES:
        there = modifier is not None and has_input(modifier, name)
        store = get_input(modifier, name) if there else None
        if isinstance(store, bpy.types.Object):
            own = store.copy()
            own.data = store.data.copy()
            set_input(modifier, name, own)


def remove(obj: bpy.types.Object) -> None:
    """Remove a scatter with its bake; its tiles stay."""
    clear_keys(obj)
    once_done(lambda: _remove(obj))


def _remove(obj: bpy.types.Object) -> None:
    mesh = obj.data
    bpy.data.objects.remove(obj)
    if mesh.users == 0:
        bpy.data.batch_remove([mesh])
