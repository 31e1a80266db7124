# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Hair."""

from typing import ClassVar

import bpy

from ..scatter.panel import ScatterPanel
from .operators import DAPPLE_OT_add_hair_guides


class DAPPLE_PT_hair(ScatterPanel, bpy.types.Panel):
    bl_label = "Hair"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.operator(DAPPLE_OT_add_hair_guides.bl_idname, icon="CURVES")
