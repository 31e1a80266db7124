# SPDX-License-Identifier: GPL-3.0-or-later
"""What the main panel shows of a scatter while its surface is painted."""

import bpy

from ..base.labels import lines_of
from ..base.translation import told
from ..solve.amount_panel import draw_amount
from ..solve.results_panel import draw_result
from .paint_operators import DAPPLE_OT_paint_done
from .painting import painted_group, painted_scatter


def draw_painting(layout: bpy.types.UILayout, context: bpy.types.Context) -> bool:
    """The scatter that is painted, what strokes change, the result, the way back; False: none."""
    obj = painted_scatter(context)
    if obj is None:
        return False
    lines_of(layout, *_what(context, obj))
    if lacks_brush(_tool_name(context), context.tool_settings.weight_paint.brush):
        lines_of(layout, told("No brush is chosen: strokes paint nothing"), "ERROR")
    _draw_weight(layout, context.tool_settings)
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_paint_done.bl_idname, text="Done", icon="CHECKMARK")
    draw_amount(layout, obj.dapple)
    layout.prop(obj.dapple, "auto_update")
    draw_result(layout, context, obj)
    return True


def _what(context: bpy.types.Context, obj: bpy.types.Object) -> tuple[str, str]:
    """What strokes change now, which another vertex group makes something else: (text, icon)."""
    group, painted = painted_group(context)
    if painted is None:
        return told("'{name}' does not use the active vertex group", name=obj.name), "ERROR"
    if painted.setting == "blocked":
        text = told("Painting where '{name}' has no points: '{group}'", name=obj.name, group=group)
        return text, "WPAINT_HLT"
    text = told("Painting the density of '{name}': '{group}'", name=obj.name, group=group)
    return text, "WPAINT_HLT"


def _tool_name(context: bpy.types.Context) -> str:
    space = context.workspace  # a background Blender may have none
    tool = space.tools.from_space_view3d_mode("PAINT_WEIGHT") if space else None
    return tool.idname if tool else ""


def lacks_brush(tool: str, brush: bpy.types.Brush | None) -> bool:
    """Whether a tool paints with a brush and has none, as in a Blender that comes without them."""
    return brush is None and tool.startswith("builtin.brush")


def _draw_weight(layout: bpy.types.UILayout, tools: bpy.types.ToolSettings) -> None:
    """The weight that strokes leave, of the brush or of all brushes; Blender 5 moved the latter."""
    brush, kept = tools.weight_paint.brush, tools.weight_paint
    if not hasattr(kept, "unified_paint_settings"):
        kept = tools
    shared = kept.unified_paint_settings
    owner = shared if shared.use_unified_weight else brush
    if owner is not None:  # another kind of tool has no brush
        layout.prop(owner, "weight", slider=True)
