# SPDX-License-Identifier: GPL-3.0-or-later
"""Undo steps of what a timer has written."""

import bpy

_OWN_STEPS = ("EDIT", "SCULPT", "PAINT_TEXTURE")  # modes whose steps hold one object or image alone


def push_undo(name: str) -> None:
    """Make what was written a step of its own.

    In modes whose steps would not hold it there is none: an undo there leaves it as it is, and one
    beyond takes it back.
    """
    windows = bpy.context.window_manager.windows
    with bpy.context.temp_override(window=windows[0] if windows else None):
        if not bpy.context.mode.startswith(_OWN_STEPS):
            bpy.ops.ed.undo_push(message=name)
