# SPDX-License-Identifier: GPL-3.0-or-later
"""Giving up what goes on in the background: a cross in the panel, and Esc in the 3D View; what
is said of how it has ended.
"""

from typing import ClassVar

import bpy

from ..base import jobs
from ..base.step_operators import AllOrNothing
from ..base.translation import told
from . import auto_update


class DAPPLE_OT_cancel_update(AllOrNothing, bpy.types.Operator):
    """Stop what is going on; the points stay as they are"""

    bl_idname = "dapple.cancel_update"
    bl_label = "Cancel Update"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        goes_on = auto_update.is_active() or jobs.current() is not None
        if not goes_on:  # then Esc means what it means without the add-on
            cls.poll_message_set(told("No points are being updated"))
        return goes_on

    def work(self, context: bpy.types.Context) -> None:
        if jobs.current() is not None:
            jobs.cancel()
        else:
            auto_update.cancel()


class DAPPLE_OT_dismiss(AllOrNothing, bpy.types.Operator):
    """Hide this message"""

    bl_idname = "dapple.dismiss"
    bl_label = "Hide Message"
    bl_options: ClassVar = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and bool(jobs.notes(context.object))

    def work(self, context: bpy.types.Context) -> None:
        jobs.dismiss(context.object)


CLASSES = (DAPPLE_OT_cancel_update, DAPPLE_OT_dismiss)
