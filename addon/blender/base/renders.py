# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether Blender renders: then nothing is computed for the viewport."""

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


def _begins() -> None:
    _state.rendering = True


def _ends() -> None:
    _state.rendering = False


SUBSCRIBER = Subscriber(render_began=_begins, render_ended=_ends, before_load=_ends, disabled=_ends)
