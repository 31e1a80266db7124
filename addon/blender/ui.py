# SPDX-License-Identifier: GPL-3.0-or-later
"""Panel in the 3D View's sidebar and entry in the Add menu."""

from typing import ClassVar

import bpy

from ..core.native import missing
from . import freshness, overlay, pictures, preview
from .classes import count_labels
from .labels import lines_of
from .operators import (
    DAPPLE_OT_add,
    DAPPLE_OT_bake,
    DAPPLE_OT_clear_bake,
    DAPPLE_OT_discard_bake,
    DAPPLE_OT_optimize,
    DAPPLE_OT_rebind,
    DAPPLE_OT_tile,
)
from .presets import DAPPLE_MT_presets
from .results import DAPPLE_PT_details, baked_line, result_lines
from .scatter import active_surface, is_scatter, rest_note, settings_of
from .tools import (
    DAPPLE_OT_edit_classes,
    DAPPLE_OT_lock,
    DAPPLE_OT_match_subdivision,
    DAPPLE_OT_preview,
    DAPPLE_OT_select_overlap,
    DAPPLE_OT_set_quality,
    DAPPLE_OT_show_density,
)
from .topology import differences
from .translation import counted, told
from .workfiles import unsaved_note

_SIZE = ("scale", "scale_randomness", "density_scale")
_DIRECTION = ("align", "turn_randomness", "tilt")
_RANGES = {
    "slope": ("from", "to", "fade"),
    "height": ("from", "to", "fade"),
    "camera": ("margin",),
}


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
            lines_of(layout, missing(), "ERROR")
        elif is_scatter(context.object):
            _draw_scatter(layout, context)
        else:
            row = layout.row()
            row.operator(DAPPLE_OT_add.bl_idname, icon="OUTLINER_DATA_POINTCLOUD")
            row.menu(DAPPLE_MT_presets.__name__, text="", icon="PRESET")
            _draw_mismatch(layout, context, "INFO")


def _draw_scatter(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    settings = context.object.dapple
    row = layout.row()
    row.prop(settings, "surface")
    row.menu(DAPPLE_MT_presets.__name__, text="", icon="PRESET")
    layout.prop(settings, "amount")
    layout.prop(settings, "count" if settings.amount == "COUNT" else "points_per_area")
    layout.prop(settings, "seed")
    layout.prop(settings, "bind_to")
    if rest_note(context.object):
        lines_of(layout, rest_note(context.object), "INFO")
        if differences(settings.surface, context.scene):
            layout.operator(DAPPLE_OT_match_subdivision.bl_idname)
    elif settings.bound_to == "FACES":
        _draw_mismatch(layout, context, "ERROR")
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_optimize.bl_idname, icon="PLAY")
    for text, icon in result_lines(context.object, context):
        lines_of(layout, text, icon)
    if settings.report.details:
        layout.popover(DAPPLE_PT_details.__name__, text="Details", icon="GRAPH")
    _draw_locked(layout, context.object)
    layout.operator(DAPPLE_OT_rebind.bl_idname)


def _draw_locked(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    row = layout.row(align=True)
    row.operator(DAPPLE_OT_lock.bl_idname, text="Lock Selected", icon="LOCKED").lock = True
    row.operator(DAPPLE_OT_lock.bl_idname, text="", icon="UNLOCKED").lock = False
    if obj.dapple.locked_count:
        text = counted(
            obj.dapple.locked_count, "{count} point is locked", "{count:,} points are locked"
        )
        layout.label(text=text, icon="LOCKED")


def _draw_mismatch(layout: bpy.types.UILayout, context: bpy.types.Context, icon: str) -> None:
    surface = active_surface(context)
    causes = differences(surface, context.scene, told) if surface else []
    if causes:
        text = told("Viewport and renders differ: {causes}", causes="; ".join(causes))
        lines_of(layout, text, icon)
        layout.operator(DAPPLE_OT_match_subdivision.bl_idname)


class DAPPLE_PT_evenness(_ScatterPanel, bpy.types.Panel):
    bl_label = "Evenness"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split, self.layout.use_property_decorate = True, False
        icon = pictures.pattern_icon(settings_of(context.object))
        self.layout.template_icon(icon_value=icon, scale=6.0)
        self.layout.operator_menu_enum(DAPPLE_OT_set_quality.bl_idname, "quality")
        for name in ("capacity_weight", "repulsion_weight", "tolerance", "max_evaluations"):
            self.layout.prop(context.object.dapple, name)
        column = self.layout.column()
        column.prop(context.object.dapple.report, "spacing")
        column.enabled = False


class DAPPLE_UL_classes(bpy.types.UIList):
    """Name of each class, and how many points it gets."""

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        data: bpy.types.AnyType,
        item: bpy.types.AnyType,
        icon: int,
        active_data: bpy.types.AnyType,
        active_property: str,
        index: int = 0,
        flt_flag: int = 0,
    ) -> None:
        row = layout.row()
        icon_name = "OUTLINER_COLLECTION" if item.collection else "OBJECT_DATA"
        row.prop(item, "name", text="", emboss=False, icon=icon_name)
        counts = count_labels(data.id_data)
        part = row.row()
        part.alignment = "RIGHT"
        part.label(text=counts[index])


class DAPPLE_PT_density(_ScatterPanel, bpy.types.Panel):
    bl_label = "Density"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, density = self.layout, context.object.dapple.density
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(density, "attribute")
        layout.prop(density, "image")
        surface = context.object.dapple.surface
        if density.image and surface:
            layout.prop_search(density, "uv_map", surface.data, "uv_layers")
        layout.prop(density, "curvature")
        for term, parts in _RANGES.items():
            layout.prop(density, f"use_{term}")
            if getattr(density, f"use_{term}"):
                column = layout.column(align=True)
                for part in parts:
                    column.prop(density, f"{term}_{part}")
        layout.prop(density, "obstacles")
        if density.obstacles:
            layout.prop(density, "obstacle_margin")
        shown = overlay.is_on(context.object)
        layout.operator(DAPPLE_OT_show_density.bl_idname, icon="OVERLAY", depress=shown)
        if overlay.note():
            lines_of(layout, overlay.note(), "INFO")


class DAPPLE_PT_instances(_ScatterPanel, bpy.types.Panel):
    bl_label = "Instances"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        _draw_class_list(layout, settings)
        kinds, at = settings.classes, settings.class_index
        shown = kinds[min(max(at, 0), len(kinds) - 1)] if kinds else settings
        if kinds:
            _draw_class(layout, shown)
        for names in (("instance", "collection"), _SIZE, _DIRECTION):
            column = layout.column(align=True)
            for name in names:
                column.prop(shown, name)
        layout.prop(settings, "forward")
        layout.prop(settings, "viewport_share")
        if settings.report.worst_overlap > 0:
            row = layout.row()
            row.label(text=_overlap(settings))
            row.operator(DAPPLE_OT_select_overlap.bl_idname, text="Select")


def _overlap(settings: bpy.types.AnyType) -> str:
    report = settings.report
    share = 100 * report.worst_overlap
    if not settings.baked_keys:
        return told("Max overlap {share:.0f} %", share=share)
    frame = report.overlap_frame
    return told("Max overlap {share:.0f} % in frame {frame}", share=share, frame=frame)


def _draw_class_list(layout: bpy.types.UILayout, settings: bpy.types.AnyType) -> None:
    edit = DAPPLE_OT_edit_classes.bl_idname
    if not settings.classes:
        layout.operator(edit, text="Add Object Type", icon="ADD").action = "ADD"
        return
    row = layout.row()
    row.template_list(DAPPLE_UL_classes.__name__, "", settings, "classes", settings, "class_index")
    column = row.column(align=True)
    icons = {"ADD": "ADD", "REMOVE": "REMOVE", "UP": "TRIA_UP", "DOWN": "TRIA_DOWN"}
    for action, icon in icons.items():
        column.operator(edit, text="", icon=icon).action = action


def _draw_class(layout: bpy.types.UILayout, kind: bpy.types.AnyType) -> None:
    row = layout.row(heading="Exact Count")
    row.prop(kind, "use_count", text="")
    part = row.row()
    part.active = kind.use_count
    part.prop(kind, "count", text="")
    part = layout.row()
    part.active = not kind.use_count
    part.prop(kind, "share")
    layout.prop(kind, "radius")
    layout.prop(kind, "density")


class DAPPLE_PT_tiles(_ScatterPanel, bpy.types.Panel):
    bl_label = "Tiles"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, tiles = self.layout, context.object.dapple.tiles
        layout.use_property_split, layout.use_property_decorate = True, False
        for name in ("grout", "inset_randomness", "thickness", "color_by"):
            layout.prop(tiles, name)
        layout.operator(
            DAPPLE_OT_tile.bl_idname,
            text="Replace Tiles" if tiles.object else "Make Tiles",
            icon="MESH_GRID",
        )
        layout.prop(tiles, "object", text="Object")


class DAPPLE_PT_animation(_ScatterPanel, bpy.types.Panel):
    bl_label = "Animation"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(context.scene, "frame_start", text="Frame Start")
        layout.prop(context.scene, "frame_end", text="End")
        layout.prop(settings, "count_over_time")
        if settings.count_over_time == "KEEP_DENSITY":
            layout.prop(settings, "fade_frames")
        else:
            layout.prop(settings, "bake_smoothing")
        layout.prop(settings, "stickiness")
        layout.prop(settings, "key_every")
        layout.prop(settings, "on_topology_change")
        row = layout.row(align=True)
        row.operator(DAPPLE_OT_bake.bl_idname, icon="REC")
        row.operator(DAPPLE_OT_clear_bake.bl_idname, icon="X", text="")
        if settings.baked_keys:
            lines_of(layout, baked_line(context.object), "CHECKMARK")
        else:
            lines_of(layout, told("Not baked: points stick to the surface"), "INFO")
        row = layout.row(align=True)
        row.operator(DAPPLE_OT_preview.bl_idname, depress=preview.is_on(context.object))
        row.prop(settings, "preview_budget", text="ms", translate=False)
        if preview.note(context.object):
            lines_of(layout, preview.note(context.object), "INFO")
        _draw_work_files(layout, freshness.answer(context.object, context))
        if unsaved_note():
            lines_of(layout, unsaved_note(), "INFO")


def _draw_work_files(layout: bpy.types.UILayout, known: freshness.Answer | None) -> None:
    if known is None:
        return
    if known.unfinished:
        text = counted(
            known.unfinished,
            "Unfinished bake: {count} frame is solved, Bake continues",
            "Unfinished bake: {count} frames are solved, Bake continues",
        )
        lines_of(layout, text, "INFO")
    if known.left_over:
        text = counted(
            known.left_over,
            "{count} frame solved from other settings or points is kept",
            "{count} frames solved from other settings or points are kept",
        )
        lines_of(layout, text, "INFO")
    if known.unfinished or known.left_over:
        layout.operator(DAPPLE_OT_discard_bake.bl_idname, icon="TRASH")


def draw_add_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Entry of Add > Mesh."""
    menu.layout.operator(DAPPLE_OT_add.bl_idname, icon="OUTLINER_DATA_POINTCLOUD")


CLASSES = (
    DAPPLE_UL_classes,
    DAPPLE_PT_main,
    DAPPLE_PT_details,
    DAPPLE_PT_density,
    DAPPLE_PT_evenness,
    DAPPLE_PT_instances,
    DAPPLE_PT_tiles,
    DAPPLE_PT_animation,
)
