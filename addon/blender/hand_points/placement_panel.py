# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panel for how instances stand on the surface, and for points that stay where they are."""

from typing import ClassVar

import bpy

from ..base.translation import OWN, counted
from ..object_types.panel import active_type
from ..scatter.panel import ScatterPanel
from .operators import DAPPLE_OT_edit_points, DAPPLE_OT_lock
from .tool import DAPPLE_TOOL_points

_DIRECTION = ("align", "turn_randomness", "tilt", "offset")


class DAPPLE_PT_placement(ScatterPanel, bpy.types.Panel):
    bl_label = "Placement"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        owner = active_type(settings)
        if owner != settings:
            layout.label(text=owner.name, icon="OBJECT_DATA", translate=False)
        column = layout.column(align=True)
        for name in _DIRECTION:
            column.prop(owner, name)
        layout.prop(settings, "forward")
        _draw_locked(layout, context.object)


def _draw_locked(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    row = layout.row(align=True)
    row.operator(DAPPLE_OT_edit_points.bl_idname, icon="EDITMODE_HLT")
    tool = row.operator("wm.tool_set_by_id", text="Point Tool", icon="RESTRICT_SELECT_OFF")
    tool.name = DAPPLE_TOOL_points.bl_idname
    row = layout.row(align=True)
    lock = row.operator(
        DAPPLE_OT_lock.bl_idname, text="Lock Selected", text_ctxt=OWN, icon="LOCKED"
    )
    lock.lock = True
    row.operator(DAPPLE_OT_lock.bl_idname, text="", icon="UNLOCKED").lock = False
    if obj.dapple.locked_count:
        text = counted(
            obj.dapple.locked_count, "{count} point is locked", "{count:,} points are locked"
        )
        layout.label(text=text, icon="LOCKED")
