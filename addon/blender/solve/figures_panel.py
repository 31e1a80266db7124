# SPDX-License-Identifier: GPL-3.0-or-later
"""Popover with the figures of the last result, and pictures of them."""

import bpy

from ...core.solve.figures import FARTHEST
from ..base.labels import at_right
from ..base.translation import counted, told
from ..scatter.object import is_scatter
from . import figure_images


class DAPPLE_PT_details(bpy.types.Panel):
    """How the last optimization went, in pictures"""

    bl_label = "Details"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_ui_units_x = 18

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        layout, report = self.layout, context.object.dapple.report
        pictured = figure_images.DETAILS.of(context.object)
        sides = layout.row()
        column = sides.column(align=True)
        column.label(text="Distance to the nearest point")
        column.template_icon(icon_value=pictured.gaps, scale=7.0)
        row = column.row()
        row.label(text="0")
        at_right(row, told("{share:.0%} of ideal", share=FARTHEST))
        if len(pictured.energies) > 1:
            _draw_energies(sides.column(align=True), pictured)
        column = layout.column(align=True)
        for name in (
            "spacing",
            "alpha_min",
            "alpha_mean",
            "capacity_variation",
            "whole_count_variation",
            "thin_share",
        ):
            column.prop(report, name)
        column.prop(report, "evaluations")
        column.enabled = False


def _draw_energies(column: bpy.types.UILayout, pictured: figure_images.Pictured) -> None:
    steps = len(pictured.energies) - 1
    column.label(
        text=counted(steps, "Energy over {count} iteration", "Energy over {count} iterations")
    )
    column.template_icon(icon_value=pictured.energy, scale=7.0)
    row = column.row()
    row.label(text=f"{pictured.energies[0]:.4g}")
    at_right(row, f"{pictured.energies[-1]:.4g}")
