# SPDX-License-Identifier: GPL-3.0-or-later
"""The main panel of a surface: list of its scatters, button to add one, the Add menu."""

from dataclasses import dataclass

import bpy

from ..base.panel_values import CachedValue
from ..base.sidebars import at_right
from ..base.translation import translated
from ..presets.operators import draw_presets
from ..scatter.object import is_surface
from ..surface.scatters import scatters_of
from .operators import DAPPLE_OT_add_over_collection, DAPPLE_OT_add_scatter
from .scatter_list import (
    DAPPLE_OT_copy_scatter,
    DAPPLE_OT_remove_scatter,
    DAPPLE_OT_select_scatter,
    DAPPLE_OT_solo_scatter,
    is_solo,
)


@dataclass(frozen=True)
class Listed:
    """A scatter in the list of its surface."""

    name: str
    count: int
    solo: bool  # whether the viewport shows no other one of the surface


def _scatters(surface: bpy.types.Object) -> tuple[Listed, ...]:
    found = scatters_of(surface)
    return tuple(Listed(one.name, one.dapple.report.count, is_solo(one, found)) for one in found)


SCATTERS = CachedValue(_scatters, ())  # of a surface


def draw_surface(layout: bpy.types.UILayout, obj: bpy.types.Object | None) -> None:
    """Draw the scatters of the active object, and the button to add one."""
    listed = SCATTERS.of(obj) if is_surface(obj) else ()
    name = obj.name if obj is not None else ""
    column = layout.column(align=True)
    for one in listed:
        _draw_listed(column.row(align=True), one, _short(one.name, name), len(listed) > 1)
    row = layout.row()
    row.scale_y = 1.0 if listed else 1.5
    row.operator(DAPPLE_OT_add_scatter.bl_idname, icon="ADD")
    if bpy.context.scene.collection.children:
        row.menu(DAPPLE_MT_over_collection.__name__, text="", icon="OUTLINER_COLLECTION")
    draw_presets(row)


def _short(name: str, surface: str) -> str:
    """A scatter's name without that of its surface, with which most begin; the rest would be cut
    off.
    """
    return name.removeprefix(f"{surface} ") or name


def _draw_listed(row: bpy.types.UILayout, one: Listed, text: str, several: bool) -> None:
    obj = bpy.context.view_layer.objects.get(one.name)
    if obj is None:  # it was renamed or removed since it was listed
        return
    select = row.operator(
        DAPPLE_OT_select_scatter.bl_idname,
        text=text,
        translate=False,
        icon="OUTLINER_OB_POINTCLOUD",
    )
    select.name = one.name
    at_right(row, f"{one.count:,}")
    row.prop(obj, "hide_viewport", text="")
    row.prop(obj, "hide_render", text="")
    if several:
        solo = DAPPLE_OT_solo_scatter.bl_idname
        row.operator(solo, text="", icon="SOLO_ON", depress=one.solo).name = one.name
    row.operator(DAPPLE_OT_copy_scatter.bl_idname, text="", icon="DUPLICATE").name = one.name
    row.operator(DAPPLE_OT_remove_scatter.bl_idname, text="", icon="X").name = one.name


class DAPPLE_MT_over_collection(bpy.types.Menu):
    """Scatter over all objects of a collection, as one surface"""

    bl_label = "Over Collection"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        for collection in context.scene.collection.children_recursive:
            row = layout.operator(
                DAPPLE_OT_add_over_collection.bl_idname,
                text=collection.name,
                translate=False,
                icon="OUTLINER_COLLECTION",
            )
            row.collection = collection.name_full


def draw_add_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Draw the entry of Add > Mesh."""
    add = DAPPLE_OT_add_scatter.bl_idname
    menu.layout.operator(add, text="Dapple Scatter", icon="OUTLINER_DATA_POINTCLOUD")
    if context.scene.collection.children:
        text = translated("Dapple Scatter over Collection")
        menu.layout.menu(DAPPLE_MT_over_collection.__name__, text=text)
