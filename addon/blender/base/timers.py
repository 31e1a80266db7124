# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that are called after a time, also if another file is open by then. All of them share
one of Blender's timers.
"""

import math
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field

import bpy

Tick = Callable[[], float | None]  # returns seconds until its next call, None to end


@dataclass
class _State:
    due: dict[Tick, float] = field(default_factory=dict)  # times of the next calls, monotonic
    running: bool = False  # the timer must not be unregistered while Blender calls it


_state = _State()


def call_in(seconds: float, tick: Tick) -> None:
    """Call a function after this time, even if it was to be called at another time."""
    _state.due[tick] = time.monotonic() + seconds
    _arm()


def call_within(seconds: float, tick: Tick) -> None:
    """Call a function after this time, unless it is to be called anyway."""
    if tick not in _state.due:
        call_in(seconds, tick)


def call_off(tick: Tick) -> None:
    """Do not call a function."""
    _state.due.pop(tick, None)
    if not _state.due:
        _disarm()


def is_due(tick: Tick) -> bool:
    """Whether a function is to be called."""
    return tick in _state.due


def run_due() -> float | None:
    """Call all functions that are due, once each; returns seconds until the next, or None."""
    now, _state.running = time.monotonic(), True
    try:
        for tick in [one for one, when in _state.due.items() if when <= now]:
            if _state.due.get(tick, math.inf) <= now:  # another function may have called it off
                _run(tick)
    finally:
        _state.running = False
    return _wait()


def _run(tick: Tick) -> None:
    del _state.due[tick]
    try:
        seconds = tick()
    except Exception as error:
        traceback.print_exception(error)
        return
    if seconds is not None:
        when = time.monotonic() + seconds
        _state.due[tick] = min(when, _state.due.get(tick, when))  # perhaps requested meanwhile


def _wait() -> float | None:
    return max(min(_state.due.values()) - time.monotonic(), 0.0) if _state.due else None


def _arm() -> None:
    """Register the timer. Blender in background mode runs no timers and never frees one."""
    if not bpy.app.background and not _state.running:
        _disarm()
        bpy.app.timers.register(run_due, first_interval=_wait() or 0.0, persistent=True)


def _disarm() -> None:
    if not _state.running and bpy.app.timers.is_registered(run_due):
        bpy.app.timers.unregister(run_due)
