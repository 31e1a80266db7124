# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panel for where there are to be more points, and for what they avoid."""

from itertools import groupby
from typing import ClassVar

import bpy

from ...core.density_table import DENSITY
from ...core.descriptors import Kind, Setting
from ..base.labels import lines_of
from ..ops.paint_operators import DAPPLE_OT_paint_blocked, DAPPLE_OT_paint_density
from ..ops.viewport_operators import DAPPLE_OT_show_density
from ..viewport import overlay
from .base import ScatterPanel, draw_in_header


class DAPPLE_PT_density(ScatterPanel, bpy.types.Panel):
    bl_label = "Density"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        draw_in_header(self.layout, DAPPLE_OT_paint_density.bl_idname, "WPAINT_HLT")

    def draw(self, context: bpy.types.Context) -> None:
        layout, density = self.layout, context.object.dapple.density
        layout.use_property_split, layout.use_property_decorate = True, False
        column = layout.column(align=True)
        column.operator(DAPPLE_OT_paint_density.bl_idname, icon="WPAINT_HLT")
        column.operator(DAPPLE_OT_paint_blocked.bl_idname, icon="WPAINT_HLT")
        for switch, settings in groupby(DENSITY, key=lambda setting: setting.under):
            if switch and not getattr(density, switch):
                continue
            rows = layout.column(align=True) if switch else layout
            for setting in settings:
                _draw(rows, context.object.dapple, setting)
        shown = overlay.is_on(context.object)
        layout.operator(DAPPLE_OT_show_density.bl_idname, icon="OVERLAY", depress=shown)
        if overlay.note():
            lines_of(layout, overlay.note(), "INFO")


def _draw(layout: bpy.types.UILayout, scatter: bpy.types.AnyType, setting: Setting) -> None:
    if setting.kind is not Kind.UV_MAP:
        layout.prop(scatter.density, setting.name)
    elif scatter.surface:
        layout.prop_search(scatter.density, setting.name, scatter.surface.data, "uv_layers")
