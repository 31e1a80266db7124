# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Display: what is shown in the viewport and at a distance from the camera."""

from typing import ClassVar

import bpy

from ...core.settings.display_table import DETAIL, SHOWN, WHERE
from ..base.sidebars import lines_of
from ..base.translation import translated
from ..scatter.panel import ScatterPanel


class DAPPLE_PT_display(ScatterPanel, bpy.types.Panel):
    bl_label = "Display"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        for setting in SHOWN:
            layout.prop(settings, setting.name)
        column = layout.column(heading="Level of Detail")
        for setting in WHERE:
            column.prop(settings, setting.name)
        used = any(getattr(settings, setting.name) for setting in WHERE)
        column = layout.column(align=True)
        column.active = used
        for setting in DETAIL:
            column.prop(settings, setting.name)
        if used and context.scene.camera is None:
            lines_of(layout, translated("The scene has no camera: all points are shown"), "INFO")
