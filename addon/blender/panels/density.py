# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panel for where there are to be more points, and for what they avoid."""

from typing import ClassVar

import bpy

from ..base.labels import lines_of
from ..ops.viewport_operators import DAPPLE_OT_show_density
from ..viewport import overlay
from .base import ScatterPanel

_RANGES = {
    "slope": ("from", "to", "fade"),
    "height": ("from", "to", "fade"),
    "camera": ("margin",),
}


class DAPPLE_PT_density(ScatterPanel, bpy.types.Panel):
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
