# SPDX-License-Identifier: GPL-3.0-or-later
"""To Weight Paint on the surface of a scatter, and back."""

import bpy

from ...core.density_table import PAINTED
from ...core.errors import ScatterError
from ..base.job import OPTIONS, Status
from ..base.translation import told
from ..steps.painting import begin_painting, end_painting, painted_scatter
from .polls import ready


def _begin(operator: bpy.types.Operator, context: bpy.types.Context, what: str) -> Status:
    try:
        begin_painting(context, PAINTED[what])
    except ScatterError as error:
        operator.report({"ERROR"}, str(error))
        return {"CANCELLED"}
    return {"FINISHED"}


class DAPPLE_OT_paint_density(bpy.types.Operator):
    """Paint on the surface how dense the points are. Takes the vertex group that the density uses,
    or adds one with the same weight everywhere: no points where the weight is 0"""

    bl_idname = "dapple.paint_density"
    bl_label = "Paint Density"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def execute(self, context: bpy.types.Context) -> Status:
        return _begin(self, context, "DENSITY")


class DAPPLE_OT_paint_blocked(bpy.types.Operator):
    """Paint on the surface where there are to be no points. Takes the vertex group of Blocked
    Areas, or adds an empty one: no points where the weight is 1, whatever the density is"""

    bl_idname = "dapple.paint_blocked"
    bl_label = "Paint Blocked Areas"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def execute(self, context: bpy.types.Context) -> Status:
        return _begin(self, context, "BLOCKED")


class DAPPLE_OT_paint_done(bpy.types.Operator):
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

    def execute(self, context: bpy.types.Context) -> Status:
        end_painting(context)
        return {"FINISHED"}


CLASSES = (DAPPLE_OT_paint_density, DAPPLE_OT_paint_blocked, DAPPLE_OT_paint_done)
