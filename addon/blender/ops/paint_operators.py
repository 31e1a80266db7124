# SPDX-License-Identifier: GPL-3.0-or-later
"""To Weight Paint on the surface of a scatter, and back."""

import bpy

from ...core.density_table import PAINTED
from ..base.job import OPTIONS, AllOrNothing
from ..base.translation import told
from ..steps.painting import begin_painting, end_painting, painted_scatter
from .polls import ready


class DAPPLE_OT_paint_density(AllOrNothing, bpy.types.Operator):
    """Paint on the surface how dense the points are. Takes the vertex group that the density uses,
    or adds one with the same weight everywhere: no points where the weight is 0"""

    bl_idname = "dapple.paint_density"
    bl_label = "Paint Density"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        begin_painting(context, PAINTED["DENSITY"])


class DAPPLE_OT_paint_blocked(AllOrNothing, bpy.types.Operator):
    """Paint on the surface where there are to be no points. Takes the vertex group of Blocked
    Areas, or adds an empty one: no points where the weight is 1, whatever the density is"""

    bl_idname = "dapple.paint_blocked"
    bl_label = "Paint Blocked Areas"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        begin_painting(context, PAINTED["BLOCKED"])


class DAPPLE_OT_paint_done(AllOrNothing, bpy.types.Operator):
    """Leave Weight Paint mode and go back to the scatter"""

    bl_idname = "dapple.paint_done"
    bl_label = "Finish Painting"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if painted_scatter(context) is None:
            cls.poll_message_set(told("No surface of a scatter is being painted"))
            return False
        return True

    def work(self, context: bpy.types.Context) -> None:
        end_painting(context)


CLASSES = (DAPPLE_OT_paint_density, DAPPLE_OT_paint_blocked, DAPPLE_OT_paint_done)
