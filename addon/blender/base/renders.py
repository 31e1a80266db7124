# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether Blender renders. Nothing is computed for the viewport during a render."""

from dataclasses import dataclass

import bpy

from .handlers import Subscriber


@dataclass
class _State:
    rendering: bool = False


_state = _State()


def busy() -> bool:
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
