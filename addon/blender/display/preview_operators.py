# SPDX-License-Identifier: GPL-3.0-or-later
"""Live Preview: the operator."""

import bpy

from ..base.step_operators import AllOrNothing
from ..surface.polls import ready
from . import preview


class DAPPLE_OT_preview(AllOrNothing, bpy.types.Operator):
    """Keep the points even in the viewport while scrubbing or posing, but not in renders. Run
    again to stop"""

    bl_idname = "dapple.preview"
    bl_label = "Live Preview"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        obj = context.object
        (preview.stop if preview.is_on(obj) else preview.start)(obj)


CLASSES = (DAPPLE_OT_preview,)
