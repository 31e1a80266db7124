# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Hair Guides: the operator, and its entry in Add > Curve."""

from typing import Any

import bpy
from bpy.props import FloatProperty, IntProperty

from ..base.step_operators import OPTIONS, AllOrNothing
from ..base.translation import translated_count, translated_report
from ..surface.polls import ready
from .guides import add_guides


class DAPPLE_OT_add_hair_guides(AllOrNothing, bpy.types.Operator):
    """Make hair curves of the points, attached to the surface as Blender's own hair. However many
    of the first ones are taken, they are evenly spread. The points are those that were optimized,
    not those of the bake"""

    bl_idname = "dapple.add_hair_guides"
    bl_label = "Add Hair Guides"
    bl_options = OPTIONS

    count: IntProperty(
        name="Count",
        description="Number of guides, of the points that come first in the order whose every "
        "beginning is evenly spread; 0 makes one of each point",
        default=0,
        min=0,
        soft_max=10_000,
    )
    length: FloatProperty(
        name="Length",
        description="Length of each guide, along the normal of the surface; 0 is a tenth of the "
        "size of the surface",
        default=0.0,
        min=0.0,
        soft_max=10.0,
        subtype="DISTANCE",
    )
    points: IntProperty(
        name="Points per Curve",
        description="Number of points of each guide, from its root to its tip",
        default=8,
        min=2,
        soft_max=50,
        max=1000,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        made = add_guides(context.object, self.count, self.length, self.points)
        text = translated_report("'{name}': {count:,} guides", name=made.obj.name, count=made.count)
        self.report({"INFO"}, text)
        if made.shared:
            shared = translated_count(
                made.shared,
                "{count:,} guide does not follow the surface: its texture coordinates are those of "
                "another place too. Unwrap the surface without overlaps",
                "{count:,} guides do not follow the surface: their texture coordinates are those "
                "of other places too. Unwrap the surface without overlaps",
            )
            self.report({"WARNING"}, shared)


def draw_menu(menu: Any, _context: bpy.types.Context) -> None:
    """Draw the entry of Add > Curve."""
    menu.layout.operator(
        DAPPLE_OT_add_hair_guides.bl_idname, text="Dapple Hair Guides", icon="CURVES"
    )


def register() -> None:
    """Add the entry to the menu."""
    bpy.types.VIEW3D_MT_curve_add.append(draw_menu)


def unregister() -> None:
    """Remove the entry."""
    bpy.types.VIEW3D_MT_curve_add.remove(draw_menu)


CLASSES = (DAPPLE_OT_add_hair_guides,)
