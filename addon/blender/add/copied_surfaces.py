# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters that come with copies of what they are on: they follow the copies."""

from dataclasses import dataclass, field
from typing import Any

import bpy

from ..base import jobs, renders
from ..base.handlers import Handlers
from ..base.quiet import is_quiet
from ..base.timers import call_off, call_within
from ..scatter.library import read_only
from ..scatter.object import is_scatter
from ..surface.joined_copies import follow_parts, note_parts, was_copied_with_parts


@dataclass
class _State:
    known: set[int] = field(default_factory=set)  # session_uids of scatters that were looked at


_state = _State()


def _updated(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Look at scatters that are new, and have the others know what they are on."""
    if is_quiet() or jobs.current() is not None or renders.busy():
        return
    for one in depsgraph.updates:
        obj = one.id.original
        if isinstance(obj, bpy.types.Object) and is_scatter(obj) and not read_only(obj):
            _look(obj)


def _look(obj: bpy.types.Object) -> None:
    if obj.session_uid not in _state.known and was_copied_with_parts(obj):
        follow_parts(obj)
    else:
        note_parts(obj)
    _state.known.add(obj.session_uid)


def _loaded(*_arguments: Any) -> None:
    _state.known.clear()
    for obj in bpy.data.objects:
        if is_scatter(obj) and not read_only(obj):
            _look(obj)


_HANDLERS = Handlers(
    depsgraph_update_post=_updated,
    load_post=_loaded,
    blend_import_post=_loaded,
    undo_post=_loaded,
    redo_post=_loaded,
)


def _begin() -> None:
    _loaded()


def register() -> None:
    """Watch what is copied."""
    _HANDLERS.watch()
    call_within(0.0, _begin)  # no file is there yet


def unregister() -> None:
    """Watch nothing."""
    _HANDLERS.unwatch()
    call_off(_begin)
