# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels Amount and Advanced, and the popover Details."""

from typing import ClassVar

import bpy

from ...core.settings.edge_table import KINDS, ON_EDGES
from ...core.settings.solver_options import EVENNESS
from ...core.solve.figures import FARTHEST
from ..base.sidebars import at_right, lines_of
from ..base.translation import OWN, translated, translated_count
from ..scatter.object import is_scatter, rest_note
from ..scatter.panel import ScatterPanel
from ..surface import subdivision
from ..surface.subdivision import DAPPLE_OT_match_subdivision
from . import figure_images
from .operators import DAPPLE_OT_reattach, DAPPLE_OT_select_small_parts
from .results_panel import figure_lines


class DAPPLE_PT_amount(ScatterPanel, bpy.types.Panel):
    bl_label = "Amount"

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split, self.layout.use_property_decorate = True, False
        draw_amount(self.layout, context.object.dapple)
        self.layout.prop(context.object.dapple, "seed")


def draw_amount(layout: bpy.types.UILayout, settings: bpy.types.AnyType) -> None:
    """Draw how the number of points is defined, and the number."""
    column = layout.column()
    column.prop(settings, "scatter_on", text_ctxt=OWN)
    if settings.scatter_on == ON_EDGES:
        _draw_edges(layout, settings)
    else:
        column.prop(settings, "symmetry")
    column = layout.column()
    column.prop(settings, "amount", text="Points")
    column.prop(settings, "count" if settings.amount == "COUNT" else "points_per_area")


def _draw_edges(layout: bpy.types.UILayout, settings: bpy.types.AnyType) -> None:
    """Draw which edges have points, and how these follow each other."""
    column = layout.column(align=True, heading="Edges")
    column.prop(settings, "edge_creases")
    if settings.edge_creases:
        column.prop(settings, "edge_angle")
    for name in KINDS[1:]:
        column.prop(settings, name)
    column = layout.column()
    column.prop(settings, "edge_spacing")
    column.prop(settings, "edge_corners")


class DAPPLE_PT_advanced(ScatterPanel, bpy.types.Panel):
    bl_label = "Advanced"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, obj = self.layout, context.object
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.template_icon(icon_value=figure_images.PATTERN.of(obj), scale=6.0)
        column = layout.column(align=True)
        column.active = obj.dapple.scatter_on != ON_EDGES
        for setting in EVENNESS:
            column.prop(obj.dapple, setting.name)
        column.separator()
        column.prop(obj.dapple, "keep_points")
        layout.prop(obj.dapple, "merge_doubled")
        _draw_attached(layout, obj)
        _draw_figures(layout, obj)


def _draw_attached(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    layout.prop(obj.dapple, "attach_to")
    if rest_note(obj):
        lines_of(layout, rest_note(obj), "INFO")
        if subdivision.DIFFERENCES.of(obj.dapple.surface):
            layout.operator(DAPPLE_OT_match_subdivision.bl_idname)
    layout.operator(DAPPLE_OT_reattach.bl_idname)


def _draw_figures(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    for text, icon in figure_lines(obj):
        lines_of(layout, text, icon)
    if obj.dapple.report.small_parts:
        layout.operator(DAPPLE_OT_select_small_parts.bl_idname, icon="RESTRICT_SELECT_OFF")
    column = layout.column()
    column.prop(obj.dapple.report, "spacing")
    column.enabled = False
    if obj.dapple.report.details:
        figure_images.DETAILS.of(obj)  # requested early, so that it is known when the popover opens
        layout.popover(DAPPLE_PT_details.__name__, text="Details", icon="GRAPH")


class DAPPLE_PT_details(bpy.types.Panel):
    """Charts of the last optimization"""

    bl_label = "Details"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_ui_units_x = 18

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        layout, report = self.layout, context.object.dapple.report
        icons = figure_images.DETAILS.of(context.object)
        sides = layout.row()
        column = sides.column(align=True)
        column.label(text="Distance to the nearest point")
        column.template_icon(icon_value=icons.gaps, scale=7.0)
        row = column.row()
        row.label(text="0")
        at_right(row, translated("{share:.0%} of ideal", share=FARTHEST))
        if len(icons.energies) > 1:
            _draw_energies(sides.column(align=True), icons)
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


def _draw_energies(column: bpy.types.UILayout, icons: figure_images.DetailIcons) -> None:
    steps = len(icons.energies) - 1
    column.label(
        text=translated_count(
            steps, "Energy over {count} iteration", "Energy over {count} iterations"
        )
    )
    column.template_icon(icon_value=icons.energy, scale=7.0)
    row = column.row()
    row.label(text=f"{icons.energies[0]:.4g}")
    at_right(row, f"{icons.energies[-1]:.4g}")
