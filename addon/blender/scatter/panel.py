# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels of a scatter have in common."""

import bpy

from ...core.base.native import missing
from .object import is_scatter


class Panel:
    """A panel in the tab of the add-on."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Dapple"


class ScatterPanel(Panel):
    """A part of the main panel that there is for scatters only."""

    bl_parent_id = "DAPPLE_PT_main"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and not missing()


def draw_in_header(layout: bpy.types.UILayout, operator: str, icon: str) -> None:
    """What is done most often in a panel, at hand while that is closed."""
    layout.operator(operator, text="", icon=icon, emboss=False)
    layout.separator()
