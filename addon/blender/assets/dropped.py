# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters that come from assets: they are put on the surface that they were dropped on, or on the
one that the artist chooses, and solved as Optimize does.

Handlers only note that something came; a timer looks at it once Blender has made its undo step.
"""

from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ..base.artist import is_operated
from ..base.handlers import Handlers
from ..base.quiet import is_quiet
from ..base.timers import call_off, call_within
from ..scatter.library import read_only
from ..scatter.object import is_scatter, is_unsolved
from ..solve import auto_update
from ..solve.holds import is_held
from .drop_target import presumed_surface
from .marking import instanced
from .placing import place

_HELD = 0.1  # seconds between two looks whether what holds it up is over


@dataclass
class _State:
    """What the timer and the handlers share, by session_uid."""

    known: set[int] = field(default_factory=set)  # scatters without points that were there before
    chosen: set[int] = field(default_factory=set)  # scatters that were given a surface
    notes: dict[int, str] = field(default_factory=dict)  # what did not fit their surface
    active: int = 0  # the last active object that is no scatter


_state = _State()


def note(obj: bpy.types.Object) -> str:
    """Which settings of a scatter did not fit the surface that it was placed on."""
    return _state.notes.get(obj.session_uid, "")


def presumed(obj: bpy.types.Object) -> bpy.types.Object:
    """The surface that a scatter is meant for; ScatterError where nobody knows."""
    active = next((one for one in bpy.data.objects if one.session_uid == _state.active), None)
    found = presumed_surface(obj.matrix_world.translation, instanced(obj), active)
    if found is None:
        raise ScatterError(f"There is no surface at '{obj.name}' and none below: choose one")
    return found


def touch(obj: bpy.types.Object) -> None:
    """A setting of a scatter was changed: if it has a surface and no points yet, it gets some."""
    if auto_update.enabled and is_unsolved(obj) and obj.dapple.surface is not None:
        _state.chosen.add(obj.session_uid)
        call_within(0.0, look)


def look() -> float | None:
    """Place what has come and what was given a surface; seconds until the next time."""
    if is_held() or is_operated():
        return _HELD
    for obj in _waiting():
        new = obj.session_uid not in _state.known
        _state.known.add(obj.session_uid)
        if obj.session_uid in _state.chosen:
            _place(obj, obj.dapple.surface)
        elif new and obj.dapple.surface is None:
            _presume(obj)
    _state.chosen.clear()
    return None


def _waiting() -> list[bpy.types.Object]:
    """Scatters without points that are in the view layer and can be written."""
    there = bpy.context.view_layer.objects
    return [obj for obj in there if is_unsolved(obj) and not read_only(obj)]


def _presume(obj: bpy.types.Object) -> None:
    try:
        surface = presumed(obj)
    except ScatterError:  # the artist is asked for it
        return
    _place(obj, surface)


def _place(obj: bpy.types.Object, surface: bpy.types.Object | None) -> None:
    if surface is None:  # it was taken back
        return
    _state.notes.pop(obj.session_uid, None)
    try:
        left_out = place(obj, surface)
    except ScatterError as error:
        left_out = str(error)
    else:
        auto_update.ask(obj, "Place Scatter")
    if left_out:
        _state.notes[obj.session_uid] = left_out


def _updated(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Note what has come, and what is active."""
    if not auto_update.enabled or is_quiet():
        return
    active = bpy.context.view_layer.objects.active
    if active is not None and not is_scatter(active):
        _state.active = active.session_uid
    for one in depsgraph.updates:
        obj = one.id.original
        new = isinstance(obj, bpy.types.Object) and obj.session_uid not in _state.known
        if new and is_unsolved(obj):
            call_within(0.0, look)


def _loaded(*_arguments: Any) -> None:
    """A file that is opened stays as it is."""
    vars(_state).update(vars(_State()))
    _state.known = {obj.session_uid for obj in bpy.data.objects if is_unsolved(obj)}


def _undone(*_arguments: Any) -> None:
    """An undo may have taken back a surface that is being solved."""
    for obj in bpy.data.objects:
        if is_unsolved(obj) and obj.dapple.surface is None:
            auto_update.forget(obj)


_HANDLERS = Handlers(
    depsgraph_update_post=_updated,
    load_post=_loaded,
    undo_post=_undone,
    redo_post=_undone,
)


def _begin() -> None:
    _loaded()


def register() -> None:
    """Watch what comes."""
    _HANDLERS.watch()
    call_within(0.0, _begin)  # no file is there yet


def unregister() -> None:
    """Place nothing."""
    _HANDLERS.unwatch()
    for timer in (_begin, look):
        call_off(timer)
