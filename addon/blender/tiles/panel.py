# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Tiles."""

from typing import ClassVar

import bpy

from ...core.settings.instance_table import TILES
from ..scatter.panel import ScatterPanel
from .operators import DAPPLE_OT_make_tiles


class DAPPLE_PT_tiles(ScatterPanel, bpy.types.Panel):
    bl_label = "Tiles"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, tiles = self.layout, context.object.dapple.tiles
        layout.use_property_split, layout.use_property_decorate = True, False
        for setting in TILES:
            layout.prop(tiles, setting.name)
        layout.operator(
            DAPPLE_OT_make_tiles.bl_idname,
            text="Replace Tiles" if tiles.object else "Make Tiles",
            icon="MESH_GRID",
        )
        layout.prop(tiles, "object", text="Object")
