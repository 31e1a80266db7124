# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Instances with the list of object types."""

import bpy

from ...core.bake.overlaps import Overlap, overlaps_from
from ...core.settings.edge_table import ON_EDGES
from ..base.panel_values import CachedValue
from ..base.sidebars import lines_of
from ..base.translation import translated
from ..scatter.panel import ScatterPanel
from ..surface.joined_parts import mesh_with_uv_maps
from ..surface.values import shows_values
from .operators import (
    DAPPLE_OT_edit_object_types,
    DAPPLE_OT_select_overlap,
    DAPPLE_OT_select_overlapping,
    count_labels,
)

_AXES = ("scale_x", "scale_y", "scale_z")
_SHOWN_SHARE = 0.005  # what becomes 1 % at least


class DAPPLE_UL_object_types(bpy.types.UIList):
    """Names of the object types with their numbers of points."""

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
        counts = CLASS_COUNTS.of(data.id_data)
        part = row.row()
        part.alignment = "RIGHT"
        part.label(text=counts[index] if index < len(counts) else "")


class DAPPLE_PT_instances(ScatterPanel, bpy.types.Panel):
    bl_label = "Instances"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        _draw_class_list(layout, settings)
        owner = active_type(settings)
        if owner != settings:
            _draw_class(layout, owner)
        column = layout.column(align=True)
        column.prop(owner, "instance")
        column.prop(owner, "collection")
        if owner.collection:
            _draw_weights(column, owner)
        _draw_size(layout, owner)
        _draw_color(layout, context.object)
        if settings.report.worst_overlap >= _SHOWN_SHARE:
            _draw_overlap(layout, settings)
        layout.operator(DAPPLE_OT_select_overlapping.bl_idname)


def _draw_weights(column: bpy.types.UILayout, owner: bpy.types.AnyType) -> None:
    column.prop(owner, "use_weights")
    for one in owner.weights if owner.use_weights else ():
        member = one.object or one.collection
        if member:
            column.prop(one, "weight", text=member.name, translate=False)


def _draw_size(layout: bpy.types.UILayout, owner: bpy.types.AnyType) -> None:
    column = layout.column(align=True)
    column.prop(owner, "scale")
    _draw_axes(column.split(factor=0.4), owner)
    column.prop(owner, "random_scale_down", text="Random Down")
    column.prop(owner, "random_scale_up", text="Random Up")
    column = layout.column(align=True)
    column.prop(owner, "fit_to_spacing")
    column.prop(owner, "density_scale")


def _draw_color(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    settings = obj.dapple
    column = layout.column(align=True)
    column.prop(settings, "color_attribute")
    if missing := MISSING_COLOR.of(obj):
        text = translated("The surface has no attribute or vertex group '{name}'", name=missing)
        lines_of(column, text, "ERROR")
    column.prop(settings, "color_image")
    image = settings.color_image
    if image is not None and image.source == "TILED" and len(image.tiles) > 1:
        text = translated(
            "Of the UDIM tiles of '{name}' only the first one counts", name=image.name
        )
        lines_of(column, text, "ERROR")
    if image is not None and settings.surface is not None:
        mesh = mesh_with_uv_maps(settings.surface)
        column.prop_search(settings, "color_uv_map", mesh, "uv_layers")


def _missing_color(obj: bpy.types.Object) -> str:
    """The color attribute of a scatter if its surface does not have it."""
    surface, name = obj.dapple.surface, obj.dapple.color_attribute
    is_missing = surface is not None and name and not shows_values(surface, name)
    return name if is_missing else ""


MISSING_COLOR = CachedValue(_missing_color, "")


def _draw_axes(split: bpy.types.UILayout, owner: bpy.types.AnyType) -> None:
    """Draw three numbers side by side, for which the layout of properties has no room."""
    split.use_property_split = False
    label = split.row()
    label.alignment = "RIGHT"
    label.label(text="Scale XYZ")
    row = split.row(align=True)
    for name in _AXES:
        row.prop(owner, name, text="")


def active_type(settings: bpy.types.AnyType) -> bpy.types.AnyType:
    """The object type that the panels show; the scatter's own settings if it has none."""
    kinds, at = settings.object_types, settings.object_type_index
    return kinds[min(max(at, 0), len(kinds) - 1)] if kinds else settings


def _draw_overlap(layout: bpy.types.UILayout, settings: bpy.types.AnyType) -> None:
    report, baked = settings.report, settings.baked_keys > 0
    row = layout.row()
    row.label(text=_overlap(report.worst_overlap, report.overlap_frame, baked))
    row.operator(DAPPLE_OT_select_overlap.bl_idname, text="Select")
    if not baked:
        return
    found, at = overlaps_from(report.type_overlaps), settings.object_type_index
    if 1 < len(found) == len(settings.object_types):
        layout.label(text=_of_type(found[min(max(at, 0), len(found) - 1)]))
    if report.overlap_between:
        text = translated("That is between keyframes: reduce Keyframe Step")
        lines_of(layout, text, "INFO")


def _overlap(share: float, frame: int, baked: bool) -> str:
    if not baked:
        return translated("Max overlap {share:.0f} %", share=100 * share)
    return translated("Max overlap {share:.0f} % in frame {frame}", share=100 * share, frame=frame)


def _of_type(own: Overlap) -> str:
    if own.share < _SHOWN_SHARE:
        return translated("Of this type no overlap")
    return translated(
        "Of this type {share:.0f} % in frame {frame}", share=100 * own.share, frame=own.frame
    )


def _draw_class_list(layout: bpy.types.UILayout, settings: bpy.types.AnyType) -> None:
    edit = DAPPLE_OT_edit_object_types.bl_idname
    if not settings.object_types:
        layout.operator(edit, text="Add Object Type", icon="ADD").action = "ADD"
        return
    row = layout.row()
    row.template_list(
        DAPPLE_UL_object_types.__name__, "", settings, "object_types", settings, "object_type_index"
    )
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
    part.prop(kind, "weight")
    row = layout.row(align=True)
    part = row.row(align=True)
    part.active = not kind.radius_from_bounds
    part.prop(kind, "radius")
    row.prop(kind, "radius_from_bounds", text="", icon="PIVOT_BOUNDBOX")
    part = layout.row()
    part.active = kind.radius > 0.0 and kind.id_data.dapple.scatter_on != ON_EDGES
    part.prop(kind, "borders")
    layout.prop(kind, "density")


def _class_counts(obj: bpy.types.Object) -> tuple[str, ...]:
    return tuple(count_labels(obj))


CLASS_COUNTS = CachedValue(_class_counts, ())
