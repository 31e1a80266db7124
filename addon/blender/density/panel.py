# SPDX-License-Identifier: GPL-3.0-or-later
"""The sub-panel Density, and the main panel while the surface is painted."""

from itertools import groupby
from typing import ClassVar

import bpy

from ...core.base.errors import ScatterError
from ...core.base.native import package
from ...core.settings.density_table import DENSITY, EACH_FRAME
from ...core.settings.descriptors import Kind, Setting
from ...core.settings.mask_table import MASKS
from ..base.panel_values import CachedValue
from ..base.sidebars import lines_of
from ..base.translation import translated
from ..scatter.object import follows_masks, material_name
from ..scatter.panel import ScatterPanel, draw_in_header
from ..solve.panel import draw_amount
from ..solve.results_panel import draw_result
from ..surface.joined_parts import mesh_with_uv_maps
from ..surface.mesh import read_mesh
from ..surface.scene_objects import by_full_name
from ..surface.values import surface_materials
from . import overlay
from .operators import (
    DAPPLE_OT_add_material,
    DAPPLE_OT_finish_painting,
    DAPPLE_OT_paint_blocked_areas,
    DAPPLE_OT_paint_density,
    DAPPLE_OT_remove_material,
    DAPPLE_OT_show_density,
)
from .painting import lacks_brush, painted_group, painted_scatter, tool_name

SWITCHES = (*(f"use_{mask}" for mask in MASKS), "use_outside", "use_camera_view")
_ENDS = ("_invert", "_strength")  # which are in a row of their own
_AVOIDED = [one for one in DENSITY if "avoid_collection" in (one.name, one.under)]
_PLAIN = [
    one for one in DENSITY if not {one.name, one.under} & set(SWITCHES) and one not in _AVOIDED
]
_MOST_KNOWN = 64
_FEW_VERTICES = 100  # a brush of the usual size over a surface may pass between fewer
_closed: dict[tuple[int, str], bool] = {}  # by the surface's session_uid and its faces


class DAPPLE_PT_density(ScatterPanel, bpy.types.Panel):
    bl_label = "Density"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        draw_in_header(self.layout, DAPPLE_OT_paint_density.bl_idname, "WPAINT_HLT")

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        column = layout.column(align=True)
        column.operator(DAPPLE_OT_paint_density.bl_idname, icon="WPAINT_HLT")
        column.operator(DAPPLE_OT_paint_blocked_areas.bl_idname, icon="WPAINT_HLT")
        for switch, rows in groupby(_PLAIN, key=lambda setting: setting.under):
            if not switch or getattr(settings.density, switch):
                for setting in rows:
                    _draw(layout, settings, setting)
        _draw_masks(layout, context.object)
        for setting in _AVOIDED:
            if not setting.under or settings.density.avoid_collection:
                _draw(layout, settings, setting)
        _draw_shown(layout, context.object)


def _draw(layout: bpy.types.UILayout, scatter: bpy.types.AnyType, setting: Setting) -> None:
    if setting.kind is not Kind.UV_MAP:
        layout.prop(scatter.density, setting.name)
    elif scatter.surface:
        mesh = mesh_with_uv_maps(scatter.surface)
        layout.prop_search(scatter.density, setting.name, mesh, "uv_layers")


def _draw_masks(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """A line for each mask, and below it the settings of those that are on."""
    density, column = obj.dapple.density, layout.column(align=True)
    column.label(text="Masks")
    for switch in SWITCHES:
        row = column.row()
        row.use_property_split = False
        row.prop(density, switch)
        if getattr(density, switch):
            box = column.box().column(align=True)
            for setting in DENSITY:
                if setting.kind is Kind.MATERIALS and setting.under == switch:
                    _draw_materials(box, obj)
                elif setting.under == switch and not setting.name.endswith(_ENDS):
                    box.prop(density, setting.name)
            _draw_ends(box, density, switch.removeprefix("use_"))
            _draw_note(box, obj, switch)


def _draw_materials(box: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """A line for each chosen material, and the menu that adds one."""
    for index, one in enumerate(obj.dapple.density.materials):
        row = box.row(align=True)
        icon = {"icon": "ERROR"} if one.material is None else {"icon_value": row.icon(one.material)}
        row.label(text=material_name(one), translate=False, **icon)
        remove = DAPPLE_OT_remove_material.bl_idname
        row.operator(remove, text="", icon="X", emboss=False).index = index
    MATERIALS.of(obj)  # requested early, since an opened menu is drawn only once
    box.menu(DAPPLE_MT_materials.__name__, icon="ADD")


class DAPPLE_MT_materials(bpy.types.Menu):
    """Materials of the surface that are not chosen yet"""

    bl_label = "Add Material"

    def draw(self, context: bpy.types.Context) -> None:
        layout, obj = self.layout, context.object
        chosen = {material_name(one) for one in obj.dapple.density.materials}
        names = [name for name in MATERIALS.of(obj) or () if name not in chosen]
        for name in names:
            found = by_full_name(bpy.data.materials, name)
            icon = layout.icon(found) if found is not None else 0
            add = DAPPLE_OT_add_material.bl_idname
            layout.operator(add, text=name, translate=False, icon_value=icon).material = name
        if not names:
            layout.label(
                text="The surface has no other materials"
                if chosen
                else "The surface has no materials"
            )


def _draw_ends(box: bpy.types.UILayout, density: bpy.types.AnyType, mask: str) -> None:
    if mask in MASKS:
        row = box.row(align=True)
        row.prop(density, f"{mask}_strength")
        row.prop(density, f"{mask}_invert", text="", icon="ARROW_LEFTRIGHT")


def _draw_note(box: bpy.types.UILayout, obj: bpy.types.Object, switch: str) -> None:
    """Draw why an enabled mask has no effect."""
    density = obj.dapple.density
    if switch == "use_distance" and not (density.distance_object or density.distance_collection):
        lines_of(box, translated("No effect yet: choose an object or a collection"), "INFO")
    if switch == "use_material":
        _draw_material_note(box, obj)
    if switch == "use_outside" and not follows_outside(obj):
        lines_of(box, translated("As Animation is set, a bake decides on its first frame"), "INFO")
    if switch == "use_border" and IS_CLOSED.of(obj):
        lines_of(box, translated("No effect: the surface is closed and has no border"), "INFO")


def follows_outside(obj: bpy.types.Object) -> bool:
    """Whether bakes decide on each frame what is outside, if they are asked to."""
    return obj.dapple.density.outside_over_time != EACH_FRAME or follows_masks(obj)


def _draw_material_note(box: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """Draw which of the chosen materials the surface does not have."""
    chosen = [material_name(one) for one in obj.dapple.density.materials]
    there = MATERIALS.of(obj)
    if not chosen:
        lines_of(box, translated("No effect yet: choose a material"), "INFO")
    for name in chosen if there is not None else ():
        if name not in there:
            lines_of(box, translated("The surface has no material '{name}'", name=name), "ERROR")


def _draw_shown(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """Draw the button Show Density, and the shown term."""
    is_on = overlay.is_on(obj)
    layout.operator(DAPPLE_OT_show_density.bl_idname, icon="OVERLAY", depress=is_on)
    if is_on:
        layout.prop(obj.dapple.density, "shown_term")
    if overlay.note():
        lines_of(layout, overlay.note(), "INFO")


def _materials(obj: bpy.types.Object) -> tuple[str, ...]:
    surface = obj.dapple.surface
    if surface is None:
        return ()
    found = surface_materials(surface, bpy.context.evaluated_depsgraph_get())
    return tuple(one.name_full for one in found)


MATERIALS = CachedValue(_materials, None)  # of the surface of a scatter, by their full names


def is_closed(obj: bpy.types.Object) -> bool:
    """Whether the surface of a scatter had no border when it was solved."""
    surface = obj.dapple.surface
    if surface is None:
        return False
    key = surface.session_uid, obj.dapple.surface_topology
    if key not in _closed:
        while len(_closed) >= _MOST_KNOWN:
            del _closed[next(iter(_closed))]
        _closed[key] = _has_no_border(surface)
    return _closed[key]


def _has_no_border(surface: bpy.types.Object) -> bool:
    try:
        arrays = read_mesh(surface)
    except ScatterError:  # it says so elsewhere
        return False
    if not len(arrays.faces):
        return False
    return not len(package().density.border_edges(arrays.vertices, arrays.faces))


IS_CLOSED = CachedValue(is_closed, False)  # whether the surface of a scatter is


def draw_painting(layout: bpy.types.UILayout, context: bpy.types.Context) -> bool:
    """Draw the painted scatter, what strokes change, the result and a button to finish; False if no
    scatter is painted.
    """
    obj = painted_scatter(context)
    if obj is None:
        return False
    lines_of(layout, *_stroke_note(context, obj))
    if lacks_brush(tool_name(context), context.tool_settings.weight_paint.brush):
        lines_of(layout, translated("No brush is selected: strokes have no effect"), "ERROR")
    _draw_few_vertices(layout, context.object)
    _draw_weight(layout, context.tool_settings)
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_finish_painting.bl_idname, text="Done", icon="CHECKMARK")
    draw_amount(layout, obj.dapple)
    layout.prop(obj.dapple, "auto_update")
    draw_result(layout, context, obj)
    return True


def _stroke_note(context: bpy.types.Context, obj: bpy.types.Object) -> tuple[str, str]:
    """What strokes change with the active vertex group: (text, icon)."""
    group, painted = painted_group(context)
    if painted is None:
        return translated("'{name}' does not use the active vertex group", name=obj.name), "ERROR"
    if painted.setting == "blocked_areas":
        text = translated(
            "Painting where '{name}' has no points: '{group}'", name=obj.name, group=group
        )
        return text, "WPAINT_HLT"
    text = translated("Painting the density of '{name}': '{group}'", name=obj.name, group=group)
    return text, "WPAINT_HLT"


def _draw_few_vertices(layout: bpy.types.UILayout, painted: bpy.types.Object) -> None:
    """Say that most strokes on a mesh such as the default cube's change nothing."""
    count = len(painted.data.vertices)
    if count < _FEW_VERTICES:
        text = translated(
            "'{name}' has only {count:,} vertices, and strokes change vertices only: subdivide it "
            "to paint finer",
            name=painted.name,
            count=count,
        )
        lines_of(layout, text, "INFO")


def _draw_weight(layout: bpy.types.UILayout, tools: bpy.types.ToolSettings) -> None:
    """Draw weight and strength of strokes, from the brush or shared by all brushes; Blender 5 moved
    the latter.
    """
    brush, kept = tools.weight_paint.brush, tools.weight_paint
    if not hasattr(kept, "unified_paint_settings"):
        kept = tools
    shared = kept.unified_paint_settings
    owner = shared if shared.use_unified_weight else brush
    if owner is not None:  # another kind of tool has no brush
        layout.prop(owner, "weight", slider=True)
    if brush is not None:
        row = layout.row(align=True)
        owner = shared if shared.use_unified_strength else brush
        row.prop(owner, "strength", slider=True)
        row.prop(brush, "use_pressure_strength", text="", icon="STYLUS_PRESSURE")
