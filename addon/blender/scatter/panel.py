# SPDX-License-Identifier: GPL-3.0-or-later
"""Base classes of panels, and icons in their headers."""

import bpy

from ...core.base.native import missing
from .object import is_scatter


class Panel:
    """A panel in the add-on's tab."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Dapple"


class ScatterPanel(Panel):
    """A panel inside the main panel, for scatters only."""

    bl_parent_id = "DAPPLE_PT_main"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and not missing()


def draw_in_header(layout: bpy.types.UILayout, operator: str, icon: str) -> None:
    """Draw the most frequent operator of a panel in its header, for use while it is closed."""
    layout.operator(operator, text="", icon=icon, emboss=False)
    layout.separator()
