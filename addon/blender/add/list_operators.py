# SPDX-License-Identifier: GPL-3.0-or-later
"""What the list of a surface's scatters does with one of them, which is called by its name."""

import bpy
from bpy.props import StringProperty

from ...core.base.errors import ScatterError
from ..base.recent_objects import activate
from ..base.step_operators import OPTIONS, AllOrNothing
from ..base.translation import told
from ..scatter.library import read_only
from ..scatter.object import is_scatter, surface_of
from ..surface.joined import parts_of
from .scatters import copied, remove, scatters_of, show_solo


class _NamedOperator(AllOrNothing):
    """Of the scatter with this name, otherwise of the active one."""

    name: StringProperty(name="Name", description="Name of the scatter; if empty, the active one")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(told("Needs Object Mode"))  # type: ignore[attr-defined]
        return context.mode == "OBJECT"

    def work(self, context: bpy.types.Context) -> None:
        self.work_on(context, self._scatter(context))

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        return [self._scatter(context)]

    def work_on(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        """What is done with it."""
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
    """Hide all other scatters of the same surface in the viewport; once more, show all of them"""

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
