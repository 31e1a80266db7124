# SPDX-License-Identifier: GPL-3.0-or-later
"""Panel in the 3D View's sidebar and entry in the Add menu."""

import textwrap
from typing import ClassVar

import bpy

from ..core.details import FARTHEST, Details, details_from
from ..core.errors import ScatterError
from ..core.native import missing
from . import overlay, pictures, preview
from .classes import count_labels
from .operators import (
    DAPPLE_OT_add,
    DAPPLE_OT_bake,
    DAPPLE_OT_clear_bake,
    DAPPLE_OT_discard_bake,
    DAPPLE_OT_edit_classes,
    DAPPLE_OT_lock,
    DAPPLE_OT_match_subdivision,
    DAPPLE_OT_optimise,
    DAPPLE_OT_preview,
    DAPPLE_OT_rebind,
    DAPPLE_OT_select_overlap,
    DAPPLE_OT_set_quality,
    DAPPLE_OT_show_density,
    DAPPLE_OT_tile,
    active_surface,
)
from .presets import DAPPLE_MT_presets
from .scatter import is_scatter, settings_of, settings_reason
from .staleness import stale_reason
from .topology import differences
from .translation import counted, told
from .workfiles import unfinished, unsaved_note

_LETTER = 5.7  # pixels of a letter of a label, about
_MARGIN, _ICON = 50.0, 25.0  # pixels of the sidebar beside a label, and of its icon


def _lines(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    """A text as labels, as wide as the sidebar is."""
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, _letters(icon))):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


def _letters(icon: str) -> int:
    """That fit into a line; a background Blender has no region."""
    region, scale = bpy.context.region, bpy.context.preferences.system.ui_scale
    width = region.width / scale if region is not None and region.type == "UI" else 0.0
    taken = _MARGIN if icon == "NONE" else _MARGIN + _ICON
    return max(int((width - taken) / _LETTER), 24) if width else 44


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
            _lines(layout, missing(), "ERROR")
        elif is_scatter(context.object):
            _draw_scatter(layout, context)
        else:
            layout.operator(DAPPLE_OT_add.bl_idname, icon="OUTLINER_DATA_POINTCLOUD")
            _draw_mismatch(layout, context)


def _draw_scatter(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    settings = context.object.dapple
    row = layout.row()
    row.prop(settings, "surface")
    row.menu(DAPPLE_MT_presets.__name__, text="", icon="PRESET")
    layout.prop(settings, "amount")
    layout.prop(settings, "count" if settings.amount == "COUNT" else "points_per_area")
    layout.prop(settings, "seed")
    layout.prop(settings, "bind_to")
    if settings.bind_to == "FACES":
        _draw_mismatch(layout, context)
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_optimise.bl_idname, icon="PLAY")
    for text, icon in result_lines(context.object, context):
        _lines(layout, text, icon)
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


def _draw_mismatch(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    surface = active_surface(context)
    causes = differences(surface, context.scene, told) if surface else []
    if causes:
        text = told("Viewport and render differ: {causes}", causes="; ".join(causes))
        _lines(layout, text, "ERROR")
        layout.operator(DAPPLE_OT_match_subdivision.bl_idname)


def result_lines(obj: bpy.types.Object, context: bpy.types.Context) -> list[tuple[str, str]]:
    """What is to be said about the last result: (text, icon)."""
    report = obj.dapple.report
    points = counted(report.count, "{count} point", "{count:,} points")
    spread, mean, least = 100 * report.capacity_spread, report.alpha_mean, report.alpha_min
    lines = [
        (told("{points}, capacity spread {spread:.2g} %", points=points, spread=spread), "NONE"),
        (told("Spacing {mean:.2f} of the best (min {least:.2f})", mean=mean, least=least), "NONE"),
        (_effort(obj), "NONE"),
    ]
    if not report.converged and not obj.dapple.baked_keys:
        lines.append((told("Tolerance not reached: raise Max Evaluations"), "INFO"))
    stale = _stale_reason(obj, context)
    if stale:
        lines.append((told("Stale: {reason}", reason=stale), "ERROR"))
    else:
        lines.append((told("Fresh: fits the surface"), "CHECKMARK"))
    return lines


def _effort(obj: bpy.types.Object) -> str:
    report = obj.dapple.report
    done = counted(report.evaluations, "{count} evaluation", "{count:,} evaluations")
    line = f"{done}, {_time(report.milliseconds)}"
    return told("{effort} a frame", effort=line) if obj.dapple.baked_keys else line


def _time(milliseconds: float) -> str:
    return f"{milliseconds:.0f} ms" if milliseconds < 1000.0 else f"{milliseconds / 1000.0:.1f} s"


def _stale_reason(obj: bpy.types.Object, context: bpy.types.Context) -> str:
    """stale_reason, but while the animation plays: then nobody waits for the panel."""
    if context.screen is not None and context.screen.is_animation_playing:
        return settings_reason(obj)
    try:
        return stale_reason(obj, context)
    except ScatterError as error:
        return str(error)


class DAPPLE_PT_details(bpy.types.Panel):
    """How the last optimisation went, in pictures"""

    bl_label = "Details"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_ui_units_x = 18

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        layout, report = self.layout, context.object.dapple.report
        details = details_from(report.details)
        sides = layout.row()
        column = sides.column(align=True)
        column.label(text="Distance to the nearest point")
        column.template_icon(icon_value=pictures.gaps_icon(details), scale=7.0)
        row = column.row()
        row.label(text="0")
        _right(row, told("{share:g} of the best possible", share=FARTHEST))
        if len(details.energies) > 1:
            _draw_energies(sides.column(align=True), details)
        column = layout.column(align=True)
        for name in ("spacing", "alpha_min", "alpha_mean", "capacity_spread", "evaluations"):
            column.prop(report, name)
        column.enabled = False


def _draw_energies(column: bpy.types.UILayout, details: Details) -> None:
    steps = len(details.energies) - 1
    column.label(
        text=counted(steps, "Energy over {count} iteration", "Energy over {count} iterations")
    )
    column.template_icon(icon_value=pictures.energy_icon(details), scale=7.0)
    row = column.row()
    row.label(text=f"{details.energies[0]:.4g}")
    _right(row, f"{details.energies[-1]:.4g}")


def _right(row: bpy.types.UILayout, text: str) -> None:
    part = row.row()
    part.alignment = "RIGHT"
    part.label(text=text)


class DAPPLE_PT_evenness(_ScatterPanel, bpy.types.Panel):
    bl_label = "Evenness"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split, self.layout.use_property_decorate = True, False
        icon = pictures.pattern_icon(settings_of(context.object))
        self.layout.template_icon(icon_value=icon, scale=6.0)
        self.layout.operator_menu_enum(DAPPLE_OT_set_quality.bl_idname, "quality")
        for name in ("capacity_weight", "gap_weight", "tolerance", "max_evaluations"):
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
            _lines(layout, overlay.note(), "INFO")


class DAPPLE_PT_instances(_ScatterPanel, bpy.types.Panel):
    bl_label = "Instances"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        _draw_class_list(layout, settings)
        kinds, at = settings.classes, settings.class_index
        shown = kinds[at] if at < len(kinds) else settings
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
            share = 100 * settings.report.worst_overlap
            row.label(text=told("Worst overlap {share:.0f} %", share=share))
            row.operator(DAPPLE_OT_select_overlap.bl_idname, text="Select")


def _draw_class_list(layout: bpy.types.UILayout, settings: bpy.types.AnyType) -> None:
    edit = DAPPLE_OT_edit_classes.bl_idname
    if not settings.classes:
        layout.operator(edit, text="Several Classes", icon="ADD").action = "ADD"
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
        for name in ("grout", "inset_randomness", "thickness", "colour_by"):
            layout.prop(tiles, name)
        layout.operator(
            DAPPLE_OT_tile.bl_idname,
            text="Replace Tiles" if tiles.object else "Make Tiles",
            icon="MESH_GRID",
        )
        layout.prop(tiles, "object", text="Object")


def baked_line(obj: bpy.types.Object) -> str:
    """Which frames are baked, and what the frames without a key lose."""
    settings, report = obj.dapple, obj.dapple.report
    last = settings.baked_start + settings.baked_frames - 1
    line = told("Baked: frames {first} to {last}", first=settings.baked_start, last=last)
    if settings.baked_keys == settings.baked_frames:
        return line
    return told(
        "{baked}, {keys} keys; between them points are {mean:.2g} spacings off "
        "(at most {most:.2g})",
        baked=line,
        keys=settings.baked_keys,
        mean=report.key_error_mean,
        most=report.key_error_max,
    )


class DAPPLE_PT_animation(_ScatterPanel, bpy.types.Panel):
    bl_label = "Animation"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(context.scene, "frame_start", text="Frame Start")
        layout.prop(context.scene, "frame_end", text="End")
        layout.prop(settings, "count_over_time", text="Over Time")
        if settings.count_over_time == "KEEP_DENSITY":
            layout.prop(settings, "fade_frames")
        else:
            layout.prop(settings, "bake_smoothing")
        layout.prop(settings, "stickiness")
        layout.prop(settings, "key_every")
        layout.prop(settings, "on_topology_change", text="If Faces Change")
        row = layout.row(align=True)
        row.operator(DAPPLE_OT_bake.bl_idname, icon="REC")
        row.operator(DAPPLE_OT_clear_bake.bl_idname, icon="X", text="")
        if settings.baked_keys:
            _lines(layout, baked_line(context.object), "CHECKMARK")
        else:
            _lines(layout, told("Not baked: points ride on the surface"), "INFO")
        row = layout.row(align=True)
        row.operator(DAPPLE_OT_preview.bl_idname, depress=preview.is_on(context.object))
        row.prop(settings, "preview_budget", text="ms", translate=False)
        if preview.note(context.object):
            _lines(layout, preview.note(context.object), "INFO")
        if unfinished(context.object):
            text = counted(
                unfinished(context.object),
                "Unfinished bake: {count} frame is solved, Bake goes on",
                "Unfinished bake: {count} frames are solved, Bake goes on",
            )
            _lines(layout, text, "INFO")
            layout.operator(DAPPLE_OT_discard_bake.bl_idname, icon="TRASH")
        if unsaved_note():
            _lines(layout, unsaved_note(), "INFO")


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
