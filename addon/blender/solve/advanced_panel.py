# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panel for the solver's numbers, for what points are attached to, and for figures."""

from typing import ClassVar

import bpy

from ...core.settings.solver_options import EVENNESS
from ..base.labels import lines_of
from ..scatter.object import rest_note
from ..scatter.panel import ScatterPanel
from ..surface import subdivision_operators
from ..surface.subdivision_operators import DAPPLE_OT_match_subdivision
from . import figure_images
from .figures_panel import DAPPLE_PT_details
from .operators import DAPPLE_OT_rebind
from .results_panel import figure_lines


class DAPPLE_PT_advanced(ScatterPanel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, obj = self.layout, context.object
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.template_icon(icon_value=figure_images.PATTERN.of(obj), scale=6.0)
        column = layout.column(align=True)
        for setting in EVENNESS:
            column.prop(obj.dapple, setting.name)
        layout.prop(obj.dapple, "keep_points")
        layout.prop(obj.dapple, "merge_doubled")
        _draw_attached(layout, obj)
        _draw_figures(layout, obj)


def _draw_attached(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    layout.prop(obj.dapple, "bind_to")
    if rest_note(obj):
        lines_of(layout, rest_note(obj), "INFO")
        if subdivision_operators.DIFFERENCES.of(obj.dapple.surface):
            layout.operator(DAPPLE_OT_match_subdivision.bl_idname)
    layout.operator(DAPPLE_OT_rebind.bl_idname)


def _draw_figures(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    for text, icon in figure_lines(obj):
        lines_of(layout, text, icon)
    column = layout.column()
    column.prop(obj.dapple.report, "spacing")
    column.enabled = False
    if obj.dapple.report.details:
        figure_images.DETAILS.of(obj)  # by the time the popover opens it is known
        layout.popover(DAPPLE_PT_details.__name__, text="Details", icon="GRAPH")
