# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that Blender calls after a time, whichever file is open then."""

from collections.abc import Callable

import bpy


def call_in(seconds: float, tick: Callable[[], float | None]) -> None:
    """Have Blender call it in so many seconds, whenever else it would have.

    A background Blender runs no timers, and never frees one that is taken back: it is given none.
    """
    if bpy.app.background:
        return
    call_off(tick)
    bpy.app.timers.register(tick, first_interval=seconds, persistent=True)


def call_within(seconds: float, tick: Callable[[], float | None]) -> None:
    """Have Blender call it in so many seconds, unless it waits for a call already."""
    if not bpy.app.timers.is_registered(tick):
        bpy.app.timers.register(tick, first_interval=seconds, persistent=True)


def call_off(tick: Callable[[], float | None]) -> None:
    """Have Blender not call it, if it waits for a call."""
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
