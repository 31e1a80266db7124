# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's events: one function for each calls the features that subscribed to it. It stays when
another file is opened.
"""

import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import bpy

from .timers import Tick, call_off, call_within


@dataclass(frozen=True)
class Update:
    """A data-block that Blender has evaluated."""

    block: bpy.types.ID  # the original
    uid: int  # its session_uid
    geometry: bool
    transform: bool

    @property
    def is_edited(self) -> bool:
        """Whether the block was edited: Blender also lists objects that depend on edited ones."""
        return self.geometry or self.transform or not isinstance(self.block, bpy.types.Object)


class Evaluation:
    """An evaluation by Blender; its updates are read once for all subscribers."""

    def __init__(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        self.scene, self.depsgraph = scene, depsgraph

    @cached_property
    def updates(self) -> list[Update]:
        """The evaluated data-blocks."""
        return list(self._read())

    def objects(self) -> Iterator[tuple[bpy.types.Object, Update]]:
        """The evaluated objects."""
        for one in self.updates:
            if isinstance(one.block, bpy.types.Object):
                yield one.block, one

    def _read(self) -> Iterator[Update]:
        for one in self.depsgraph.updates:
            block = one.id.original
            geometry, transform = one.is_updated_geometry, one.is_updated_transform
            yield Update(block, block.session_uid, geometry, transform)


_Event = Callable[[], None] | None
_Evaluated = Callable[[Evaluation], None] | None


@dataclass(frozen=True)
class Subscriber:
    """Functions of a feature that are called after events, or before those called `before_...`."""

    updated: _Evaluated = None  # something was edited and evaluated
    frame_changed: _Evaluated = None
    undone: _Event = None  # a step was undone or redone
    before_load: _Event = None
    loaded: _Event = None
    imported: _Event = None  # data-blocks of another file were linked or appended
    before_save: _Event = None
    saved: Callable[[str], None] | None = None  # takes the path of the file
    render_began: _Event = None
    render_ended: _Event = None
    enabled: _Event = None  # the add-on was enabled, and a file is open
    disabled: _Event = None  # the add-on is disabled, or could not be enabled
    ticks: tuple[Tick, ...] = ()  # called off when the add-on is disabled

    def register(self) -> None:
        """Subscribe; called after all earlier subscribers."""
        _subscribers.append(self)
        if self.enabled is not None:
            call_within(0.0, self.enabled)  # while Blender starts there is no file yet

    def unregister(self) -> None:
        """Unsubscribe."""
        if self in _subscribers:
            _subscribers.remove(self)
        for tick in (*self.ticks, *filter(None, [self.enabled])):
            call_off(tick)
        if self.disabled is not None:
            self.disabled()


_EVENTS = {  # names of Blender's lists of handlers
    "depsgraph_update_post": "updated",
    "frame_change_post": "frame_changed",
    "undo_post": "undone",
    "redo_post": "undone",
    "load_pre": "before_load",
    "load_post": "loaded",
    "blend_import_post": "imported",
    "save_pre": "before_save",
    "save_post": "saved",
    "render_init": "render_began",
    "render_complete": "render_ended",
    "render_cancel": "render_ended",
}
_subscribers: list[Subscriber] = []
_called: dict[str, Callable[..., None]] = {}  # the function in each list


def register() -> None:
    """Add one function to each of Blender's lists."""
    for name, event in _EVENTS.items():
        _called[name] = bpy.app.handlers.persistent(_caller(event))
        getattr(bpy.app.handlers, name).append(_called[name])


def unregister() -> None:
    """Remove these functions."""
    for name, function in _called.items():
        listed = getattr(bpy.app.handlers, name)
        if function in listed:
            listed.remove(function)
    _called.clear()


def publish(event: str, *given: Any) -> None:
    """Call all subscribers of an event, even if one fails."""
    for subscriber in list(_subscribers):
        function = getattr(subscriber, event)
        if function is None:
            continue
        try:
            function(*given)
        except Exception as error:
            traceback.print_exception(error)


def _caller(event: str) -> Callable[..., None]:
    if event in {"updated", "frame_changed"}:
        return lambda scene, depsgraph: publish(event, Evaluation(scene, depsgraph))
    if event == "saved":
        return lambda path, *_: publish(event, path)
    return lambda *_: publish(event)
