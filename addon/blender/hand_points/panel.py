# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Placement, and the main panel while points are being edited."""

from typing import ClassVar

import bpy

from ...core.settings.edge_table import ON_EDGES
from ..base.sidebars import lines_of
from ..base.translation import OWN, translated, translated_count
from ..object_types.panel import active_type
from ..scatter.panel import ScatterPanel
from .editing import edited_scatter
from .operators import DAPPLE_OT_edit_points, DAPPLE_OT_finish_editing_points, DAPPLE_OT_lock_points
from .spray_tool import DAPPLE_TOOL_spray
from .tool import DAPPLE_TOOL_points

_DIRECTION = ("align_to_normal", "random_turn", "random_tilt", "lean_apart", "offset")


def draw_editing(layout: bpy.types.UILayout, context: bpy.types.Context) -> bool:
    """Draw the help of Edit Mode and a button to leave it; False if no points are being edited."""
    obj = edited_scatter(context)
    if obj is None:
        return False
    lines_of(layout, translated("Editing the points of '{name}'", name=obj.name), "EDITMODE_HLT")
    lines_of(layout, translated("Ctrl and right click adds a point, G moves, X removes"))
    lines_of(layout, translated("Added and moved points are projected onto the surface and locked"))
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_finish_editing_points.bl_idname, text="Done", icon="CHECKMARK")
    return True


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
        along = settings.scatter_on == ON_EDGES
        if along:
            column.prop(settings, "align_to_edges")
        for name in _DIRECTION:
            row = column.row(align=True)
            row.active = not (along and settings.align_to_edges and name == "random_turn")
            row.prop(owner, name)
        column = layout.column(align=True)
        column.prop(settings, "lean_object")
        row = column.row(align=True)
        row.active = settings.lean_object is not None
        row.prop(owner, "lean_along")
        layout.prop(settings, "forward")
        _draw_locked(layout, context.object)


def _draw_locked(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    column = layout.column(align=True)
    column.operator(DAPPLE_OT_edit_points.bl_idname, icon="EDITMODE_HLT")
    row = column.row(align=True)
    tool = row.operator("wm.tool_set_by_id", text="Point Tool", icon="RESTRICT_SELECT_OFF")
    tool.name = DAPPLE_TOOL_points.bl_idname
    tool = row.operator("wm.tool_set_by_id", text="Spray Tool", icon="BRUSH_DATA")
    tool.name = DAPPLE_TOOL_spray.bl_idname
    row = layout.row(align=True)
    lock = row.operator(
        DAPPLE_OT_lock_points.bl_idname, text="Lock Selected", text_ctxt=OWN, icon="LOCKED"
    )
    lock.lock = True
    row.operator(DAPPLE_OT_lock_points.bl_idname, text="", icon="UNLOCKED").lock = False
    if obj.dapple.locked_count:
        text = translated_count(
            obj.dapple.locked_count, "{count} point is locked", "{count:,} points are locked"
        )
        layout.label(text=text, icon="LOCKED")
