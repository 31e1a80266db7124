# SPDX-License-Identifier: GPL-3.0-or-later
"""Panel in the 3D View's sidebar and entry in the Add menu."""

import textwrap
from typing import ClassVar

import bpy

from ..core.native import missing
from .operators import (
    DAPPLE_OT_add,
    DAPPLE_OT_bake,
    DAPPLE_OT_clear_bake,
    DAPPLE_OT_match_subdivision,
    DAPPLE_OT_optimise,
    active_surface,
)
from .properties import is_scatter
from .topology import differences


def _lines(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, 44)):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


class _Panel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Dapple"


class _ScatterPanel(_Panel):
    bl_parent_id = "DAPPLE_PT_main"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and not missing()


class DAPPLE_PT_main(_Panel, bpy.types.Panel):
    bl_label = "Dapple"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        if missing():
            _lines(layout, missing(), "ERROR")
        elif is_scatter(context.object):
            _draw_scatter(layout, context)
        else:
            layout.operator(DAPPLE_OT_add.bl_idname, icon="OUTLINER_DATA_POINTCLOUD")
            _draw_mismatch(layout, context)


def _draw_scatter(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    settings = context.object.dapple
    layout.prop(settings, "surface")
    layout.prop(settings, "count")
    layout.prop(settings, "seed")
    _draw_mismatch(layout, context)
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_optimise.bl_idname, icon="PLAY")
    for text, icon in result_lines(context.object, context):
        _lines(layout, text, icon)


def _draw_mismatch(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    surface = active_surface(context)
    causes = differences(surface, context.scene) if surface else []
    if causes:
        _lines(layout, f"Viewport and render differ: {'; '.join(causes)}", "ERROR")
        layout.operator(DAPPLE_OT_match_subdivision.bl_idname)


def result_lines(obj: bpy.types.Object, context: bpy.types.Context) -> list[tuple[str, str]]:
    """What is to be said about the last result: (text, icon)."""
    report = obj.dapple.report
    baked = " a frame" if obj.dapple.baked_keys else ""
    lines = [
        (f"{report.count:,} points, capacity spread {100 * report.capacity_spread:.2g} %", "NONE"),
        (f"Spacing {report.alpha_mean:.2f} of the best (min {report.alpha_min:.2f})", "NONE"),
        (f"{report.evaluations} evaluations, {report.milliseconds:.0f} ms{baked}", "NONE"),
    ]
    if not report.converged:
        lines.append(("Tolerance not reached: raise Max Evaluations", "INFO"))
    stale = stale_reason(obj, context)
    lines.append((stale or "Fresh: fits the surface", "ERROR" if stale else "CHECKMARK"))
    return lines


def stale_reason(obj: bpy.types.Object, context: bpy.types.Context) -> str:
    """Why the points do not fit the surface any more; empty when they do."""
    surface, bound = obj.dapple.surface, obj.dapple.surface_vertices
    if surface is None:
        return "Stale: the surface is gone"
    evaluated = surface.evaluated_get(context.evaluated_depsgraph_get())
    now = len(evaluated.data.vertices)
    if now != bound:
        return f"Stale: bound to {bound:,} vertices, the surface has {now:,}"
    if obj.dapple.report.count != obj.dapple.count:
        return f"Stale: {obj.dapple.count:,} points are asked for"
    return ""


class DAPPLE_PT_evenness(_ScatterPanel, bpy.types.Panel):
    bl_label = "Evenness"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        for name in ("capacity_weight", "gap_weight", "tolerance", "max_evaluations"):
            self.layout.prop(context.object.dapple, name)
        self.layout.prop(context.object.dapple.report, "spacing")


class DAPPLE_PT_instances(_ScatterPanel, bpy.types.Panel):
    bl_label = "Instances"

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        for name in ("instance", "scale", "scale_randomness", "turn_randomness"):
            self.layout.prop(context.object.dapple, name)


class DAPPLE_PT_animation(_ScatterPanel, bpy.types.Panel):
    bl_label = "Animation"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(context.scene, "frame_start", text="Frame Start")
        layout.prop(context.scene, "frame_end", text="End")
        row = layout.row(align=True)
        row.operator(DAPPLE_OT_bake.bl_idname, icon="REC")
        row.operator(DAPPLE_OT_clear_bake.bl_idname, icon="X", text="")
        if settings.baked_keys:
            last = settings.baked_start + settings.baked_keys - 1
            _lines(layout, f"Baked: frames {settings.baked_start} to {last}", "CHECKMARK")
        else:
            _lines(layout, "Not baked: points ride on the surface", "INFO")


def draw_add_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Entry of Add > Mesh."""
    menu.layout.operator(DAPPLE_OT_add.bl_idname, icon="OUTLINER_DATA_POINTCLOUD")


CLASSES = (DAPPLE_PT_main, DAPPLE_PT_evenness, DAPPLE_PT_instances, DAPPLE_PT_animation)
