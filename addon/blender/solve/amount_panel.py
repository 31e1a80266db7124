# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-panel for how many points there are."""

import bpy

from ..scatter.panel import ScatterPanel


class DAPPLE_PT_amount(ScatterPanel, bpy.types.Panel):
    bl_label = "Amount"

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split, self.layout.use_property_decorate = True, False
        draw_amount(self.layout, context.object.dapple)
        self.layout.prop(context.object.dapple, "seed")


def draw_amount(layout: bpy.types.UILayout, settings: bpy.types.AnyType) -> None:
    """How the number of points is defined, and the number."""
    column = layout.column()
    column.prop(settings, "amount", text="Points")
    column.prop(settings, "count" if settings.amount == "COUNT" else "points_per_area")
