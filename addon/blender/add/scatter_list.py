# SPDX-License-Identifier: GPL-3.0-or-later
"""The scatters of a surface: listing, showing one alone, copying, removing."""

from collections.abc import Iterable

import bpy
from bpy.props import StringProperty

from ...core.base.errors import ScatterError
from ...nodes import get_input, has_input, set_input
from ..base.all_or_nothing import once_done
from ..base.recent_objects import activate
from ..base.step_operators import OPTIONS, AllOrNothing
from ..base.translation import translated
from ..freshness.unfinished_bakes import new_key
from ..scatter.key_stores import STORES
from ..scatter.key_writing import clear_keys
from ..scatter.linked_data import open_collections, read_only
from ..scatter.modifier import scatter_modifier
from ..scatter.object import is_scatter, surface_of
from ..surface.joined_parts import parts_of
from ..surface.scatters import scatters_of


def is_solo(obj: bpy.types.Object, scatters: Iterable[bpy.types.Object]) -> bool:
    """Whether an object is the only one of several scatters that is shown in the viewport."""
    others = [one for one in scatters if one != obj]
    return bool(others) and not obj.hide_viewport and all(one.hide_viewport for one in others)


def show_solo(obj: bpy.types.Object) -> None:
    """Hide the other scatters of the same surface in the viewport; if they are hidden,
    show them.
    """
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
    """Copy the keyframes, so that the copy can lose them alone."""
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


class _NamedOperator(AllOrNothing):
    """An operator on the scatter with a given name, by default on the active one."""

    name: StringProperty(name="Name", description="Name of the scatter; if empty, the active one")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(translated("Needs Object Mode"))  # type: ignore[attr-defined]
        return context.mode == "OBJECT"

    def work(self, context: bpy.types.Context) -> None:
        self.work_on(context, self._scatter(context))

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        return [self._scatter(context)]

    def work_on(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        """Do the work on a scatter."""
        raise NotImplementedError

    def _scatter(self, context: bpy.types.Context) -> bpy.types.Object:
        obj = context.view_layer.objects.get(self.name) if self.name else context.object
        if not is_scatter(obj):
            named = f"'{self.name}'" if self.name else "The active object"
            raise ScatterError(f"{named} is not a Dapple scatter of the view layer")
        return obj


class DAPPLE_OT_select_scatter(_NamedOperator, bpy.types.Operator):
    """Select this scatter and show its settings"""

    bl_idname = "dapple.select_scatter"
    bl_label = "Select Scatter"
    bl_options = OPTIONS

    def work_on(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        obj.hide_set(False)
        activate(context, obj)


class DAPPLE_OT_select_surface(_NamedOperator, bpy.types.Operator):
    """Select the surface, and show the list of its scatters"""

    bl_idname = "dapple.select_surface"
    bl_label = "Select Surface"
    bl_options = OPTIONS

    def work_on(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        surface = parts_of(surface_of(obj))[0]
        if context.view_layer.objects.get(surface.name) != surface:
            raise ScatterError(f"Surface '{surface.name}' is not in the view layer")
        activate(context, surface)


class DAPPLE_OT_solo_scatter(_NamedOperator, bpy.types.Operator):
    """Hide all other scatters of the same surface in the viewport. Run again to show all of them"""

    bl_idname = "dapple.solo_scatter"
    bl_label = "Solo Scatter"
    bl_options = OPTIONS

    def work_on(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        show_solo(obj)

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        return scatters_of(self._scatter(context).dapple.surface)


class DAPPLE_OT_copy_scatter(_NamedOperator, bpy.types.Operator):
    """Add a copy of this scatter to the surface, with its points, settings and bake"""

    bl_idname = "dapple.copy_scatter"
    bl_label = "Copy Scatter"
    bl_options = OPTIONS

    def work_on(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        copied(obj)


class DAPPLE_OT_remove_scatter(_NamedOperator, bpy.types.Operator):
    """Remove this scatter and its bake from the file; tiles made of it stay"""

    bl_idname = "dapple.remove_scatter"
    bl_label = "Remove Scatter"
    bl_options = OPTIONS

    def work_on(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        if read_only(obj):
            raise ScatterError(read_only(obj))
        remove(obj)


CLASSES = (
    DAPPLE_OT_select_scatter,
    DAPPLE_OT_select_surface,
    DAPPLE_OT_solo_scatter,
    DAPPLE_OT_copy_scatter,
    DAPPLE_OT_remove_scatter,
)
