# SPDX-License-Identifier: GPL-3.0-or-later
"""When nothing may be updated, as something else has the file."""

from collections.abc import Iterator

import bpy

from ..base import job, renders

_STROKES = ("PAINT_OT_", "SCULPT_OT_", "GPENCIL_OT_")


def is_held() -> bool:
    """Whether Blender renders, plays, paints a stroke, or an operator of the add-on runs."""
    return renders.busy() or job.is_under_way() or any(_windows())


def is_operated() -> bool:
    """Whether an operator that will be an undo step has begun, as one that moves an object: a step
    that is made meanwhile would hold half of it.
    """
    return any(
        "UNDO" in one.bl_options
        for manager in bpy.data.window_managers
        for window in manager.windows
        for one in window.modal_operators
    )


def _windows() -> Iterator[bool]:
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            yield window.screen.is_animation_playing
            yield any(one.bl_idname.startswith(_STROKES) for one in window.modal_operators)
