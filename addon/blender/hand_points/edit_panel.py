# SPDX-License-Identifier: GPL-3.0-or-later
"""What the main panel shows of a scatter while its points are edited."""

import bpy

from ..base.labels import lines_of
from ..base.translation import told
from .editing import edited_scatter
from .operators import DAPPLE_OT_edit_points_done


def draw_editing(layout: bpy.types.UILayout, context: bpy.types.Context) -> bool:
    """What can be done, and the way back; False: no points are edited."""
    obj = edited_scatter(context)
    if obj is None:
        return False
    lines_of(layout, told("Editing the points of '{name}'", name=obj.name), "EDITMODE_HLT")
    lines_of(layout, told("Ctrl and right click adds a point, G moves, X removes"))
    lines_of(layout, told("Added and moved points come down on the surface and are locked"))
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_edit_points_done.bl_idname, text="Done", icon="CHECKMARK")
    return True
