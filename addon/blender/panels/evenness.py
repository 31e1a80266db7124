# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panel for how even the points become."""

from typing import ClassVar

import bpy

from ...core.solver_options import EVENNESS
from ..ops.tools import DAPPLE_OT_set_quality
from . import shown
from .base import ScatterPanel


class DAPPLE_PT_evenness(ScatterPanel, bpy.types.Panel):
    bl_label = "Evenness"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split, self.layout.use_property_decorate = True, False
        icon = shown.PATTERN.of(context.object)
        self.layout.template_icon(icon_value=icon, scale=6.0)
        self.layout.operator_menu_enum(DAPPLE_OT_set_quality.bl_idname, "quality")
        for setting in EVENNESS:
            self.layout.prop(context.object.dapple, setting.name)
        column = self.layout.column()
        column.prop(context.object.dapple.report, "spacing")
        column.enabled = False
