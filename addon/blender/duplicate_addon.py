# SPDX-License-Identifier: GPL-3.0-or-later
"""Two enabled copies of the add-on, for example from two repositories, which would have the same
names.

The second copy only adds a message to the preferences, and starts when the first one is disabled.
"""

from collections.abc import Callable
from dataclasses import dataclass

import bpy

from .base import PACKAGE
from .base.sidebars import lines_of
from .base.timers import call_off, call_within
from .base.translation import english, translated

_POLL = 1.0  # seconds between two looks


@dataclass
class _Waiting:
    begin: Callable[[], None] | None = None


_waiting = _Waiting()


def other() -> str:
    """Module of another enabled copy; empty if there is none."""
    shown = getattr(bpy.types, "DAPPLE_PT_main", None)
    package = "" if shown is None else shown.__module__.removesuffix(".blender.main_panel")
    return "" if package == PACKAGE else package


def waits() -> bool:
    """Whether this copy waits for the other one."""
    return _waiting.begin is not None


def wait(begin: Callable[[], None]) -> None:
    """Call `begin` when the other copy is disabled."""
    _waiting.begin = begin
    bpy.utils.register_class(DAPPLE_AP_waiting)
    call_within(_POLL, check)
    print(f"Dapple: {note(english)}")


def stop() -> None:
    """Stop waiting."""
    _waiting.begin = None
    call_off(check)
    bpy.utils.unregister_class(DAPPLE_AP_waiting)


def check() -> float | None:
    """Start if the other copy is gone; returns seconds until the next check."""
    if _waiting.begin is None:
        return None
    if other():
        return _POLL
    begin = _waiting.begin
    stop()
    begin()
    return None


def note(translate: Callable[..., str] = translated) -> str:
    """The message that is shown while this copy waits."""
    return translate(
        "Another copy of Dapple is enabled ('{other}'). This one ('{own}') does nothing "
        "until it is disabled",
        other=other(),
        own=PACKAGE,
    )


class DAPPLE_AP_waiting(bpy.types.AddonPreferences):
    """Preferences of a copy that waits."""

    bl_idname = PACKAGE

    def draw(self, context: bpy.types.Context) -> None:
        lines_of(self.layout, note(), "ERROR")
