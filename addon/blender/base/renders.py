# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether Blender renders: then nothing is computed for the viewport."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy

from .handlers import Handlers


@dataclass
class _State:
    rendering: bool = False
    leave: list[Callable[[], None]] = field(default_factory=list)  # called when a render begins


_state = _State()


def busy() -> bool:
    """Whether Blender renders, or has locked its interface to do so."""
    locked = any(manager.is_interface_locked for manager in bpy.data.window_managers)
    return _state.rendering or locked or bpy.app.is_job_running("RENDER")


def when_one_begins(leave: Callable[[], None]) -> None:
    """Have work that goes on be given up when a render begins."""
    if leave not in _state.leave:
        _state.leave.append(leave)


def _begins(*_arguments: Any) -> None:
    _state.rendering = True
    for leave in _state.leave:
        leave()


def _ends(*_arguments: Any) -> None:
    _state.rendering = False


_HANDLERS = Handlers(
    render_init=_begins,
    render_complete=_ends,
    render_cancel=_ends,
    load_pre=_ends,
)


def register() -> None:
    """Watch renders."""
    _HANDLERS.watch()


def unregister() -> None:
    """Stop watching."""
    _state.rendering = False
    _HANDLERS.unwatch()
