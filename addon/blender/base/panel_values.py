# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that panels show, which are computed outside of drawing.

Drawing uses the last known value and requests a new one. When Blender is idle, a timer computes
requested values and redraws the panels if one has changed. In background mode there is no timer,
and values are computed when they are drawn.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from . import activity, step_operators
from .handlers import Subscriber
from .object_handles import ObjectHandle
from .sidebars import redraw
from .timers import call_within

_PAUSE = 0.2  # seconds until the next check while Blender renders or solves
_MOST = 64  # number of values above which unused ones are forgotten

at_once = bpy.app.background
Find = Callable[[Any], Any]  # takes the object, or None


@dataclass
class _Note:
    """A requested value."""

    find: Find
    handle: ObjectHandle | None
    found: Any
    requested: bool = True


_notes: dict[tuple[int, int], _Note] = {}  # by request and the session_uid of the object


# Not generic over the type of the value: typing keeps such classes, and with them those of bpy,
# until Python ends, and then bpy is never closed.
class CachedValue:
    """A value that panels show, which may belong to an object."""

    def __init__(self, find: Find, before: Any) -> None:
        self._find, self._before = find, before

    def of(self, obj: bpy.types.Object | None = None) -> Any:
        """The last known value, or the default."""
        if at_once:
            return self._find(obj)
        key = id(self), obj.session_uid if obj is not None else 0
        note = _notes.get(key)
        if note is None:
            handle = ObjectHandle(obj) if obj is not None else None
            note = _notes[key] = _Note(self._find, handle, self._before)
        note.requested = True
        call_within(0.0, tick)
        return note.found


def known_objects() -> set[str]:
    """Names of the objects with known values."""
    return {note.handle.name for note in _notes.values() if note.handle is not None}


def tick() -> float | None:
    """Find requested values; returns seconds until the next call, None to end."""
    if activity.is_rendering() or step_operators.is_under_way():
        return _PAUSE
    _tidy()
    any_changed = False
    for key, note in list(_notes.items()):
        if not note.requested:
            continue
        note.requested = False
        try:
            found = note.find(note.handle.get() if note.handle is not None else None)
        except ScatterError:  # the object was removed
            del _notes[key]
            continue
        any_changed = any_changed or found != note.found
        note.found = found
    if any_changed:
        redraw()
    return None


def _tidy() -> None:
    if len(_notes) > _MOST:
        for key in [key for key, note in _notes.items() if not note.requested]:
            del _notes[key]


def _forget() -> None:
    for key in [key for key, note in _notes.items() if note.handle is not None]:
        del _notes[key]


SUBSCRIBER = Subscriber(before_load=_forget, disabled=_notes.clear, ticks=(tick,))
