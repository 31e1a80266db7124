# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders, playback and running tools, with which timers must not interfere."""

from collections.abc import Iterator
from dataclasses import dataclass

import bpy

from .handlers import Subscriber

_STROKES = ("PAINT_OT_", "SCULPT_OT_", "GPENCIL_OT_")
_SCRUBBING = "ANIM_OT_change_frame"


@dataclass
class _State:
    rendering: bool = False


_state = _State()


def is_rendering() -> bool:
    """Whether Blender renders, or has locked its interface to do so."""
    locked = any(manager.is_interface_locked for manager in bpy.data.window_managers)
    return _state.rendering or locked or bpy.app.is_job_running("RENDER")


def _began() -> None:
    _state.rendering = True


def _ended() -> None:
    _state.rendering = False


SUBSCRIBER = Subscriber(
    render_began=_began, render_ended=_ended, before_load=_ended, disabled=_ended
)


def is_playing() -> bool:
    """Whether a window plays the animation."""
    return any(window.screen.is_animation_playing for window in _windows())


def is_painting() -> bool:
    """Whether a brush stroke is running."""
    return any(name.startswith(_STROKES) for name in _running())


def is_scrubbing() -> bool:
    """Whether the frame is dragged."""
    return _SCRUBBING in _running()


def is_operated() -> bool:
    """Whether an operator is running that ends in an undo step, such as a move of an object: an
    undo step made now would contain a part of its changes.
    """
    return any("UNDO" in one.bl_options for window in _windows() for one in window.modal_operators)


def is_using_tool() -> bool:
    """Whether a tool is running, so that more changes will follow."""
    return is_painting() or is_operated()


def last_operator() -> int:
    """An identifier of the last finished operator: a button or tool, not a dragged value."""
    return max((one.as_pointer() for one in _finished()), default=0)


def _finished() -> list[bpy.types.Operator]:
    return [one for manager in bpy.data.window_managers for one in manager.operators[-1:]]


def _running() -> list[str]:
    return [one.bl_idname for window in _windows() for one in window.modal_operators]


def _windows() -> Iterator[bpy.types.Window]:
    for manager in bpy.data.window_managers:
        yield from manager.windows
