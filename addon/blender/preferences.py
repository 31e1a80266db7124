# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences of the extension: presets that can be removed, and the asset library."""

import bpy
from bpy.props import BoolProperty

from .assets import library as assets_library
from .assets.library import DAPPLE_OT_add_asset_library, DAPPLE_OT_remove_asset_library
from .base import PACKAGE
from .presets.operators import draw_removal


class DAPPLE_AP_preferences(bpy.types.AddonPreferences):
    """Preferences of the extension."""

    bl_idname = PACKAGE

    remove_library: BoolProperty(
        name="Remove with the Add-on",
        description="Remove the asset library from the preferences when the add-on is disabled",
        default=False,
    )

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        draw_removal(layout.column())
        layout.label(text="Ready-made scatters and single node groups for the asset browser:")
        assets = assets_library.ASSETS.of()
        if not assets.there:
            layout.operator(DAPPLE_OT_add_asset_library.bl_idname, icon="ASSET_MANAGER")
            if assets.trouble:
                layout.label(text=assets.trouble, icon="INFO")
            return
        layout.operator(DAPPLE_OT_remove_asset_library.bl_idname, icon="X")
        layout.prop(self, "remove_library")


CLASSES = (DAPPLE_AP_preferences,)
