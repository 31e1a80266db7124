# SPDX-License-Identifier: GPL-3.0-or-later
"""A sequence of steps in a real window: a generator continues after Blender has handled
its events.
"""

import os
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path

import addon_host
import bpy

Story = Iterator[None]


def begin(told: Callable[[], Story], tick: float) -> None:
    """Tell a story in an empty file with the add-on enabled, a step every tick (seconds); then
    leave Blender, with the status 0 if nothing failed."""
    addon_host.add_repository(Path(tempfile.mkdtemp()))
    addon_host.enable()
    bpy.context.preferences.view.show_splash = False
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    steps = told()
    bpy.app.timers.register(lambda: _tell(steps, tick), first_interval=1.0, persistent=True)


def press_escape() -> None:
    window = bpy.context.window_manager.windows[0]
    for value in ("PRESS", "RELEASE"):
        window.event_simulate("ESC", value, x=100, y=100)


def _tell(steps: Story, tick: float) -> float:
    try:
        next(steps)
    except StopIteration:
        addon_host.disable()
        _leave(0)
    except BaseException:
        traceback.print_exc()
        _leave(1)
    return tick


def _leave(status: int) -> None:
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)
