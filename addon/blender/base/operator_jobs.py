# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work of an operator that a timer does in the background, one operator at a time.

It reads and writes the file in the window and the scene in which it was started. It pauses while
Blender renders, plays the animation or runs a tool, and while the artist changes frames. A change
of watched data ends the work, and nothing is written.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.steps import Steps
from . import activity
from .handlers import Evaluation, Subscriber
from .jobs import Job
from .object_handles import ObjectHandle
from .quiet import evaluate_changes, is_quiet
from .sidebars import redraw
from .timers import call_within
from .translation import operator_label, translated, translated_report

_POLL = 0.005  # seconds between two checks of the worker
_PART = 0.03  # seconds that one call may block the interface
PAUSED = 0.1  # seconds between two checks during a pause
REST = 1.0  # seconds without a frame change after which scrubbing has ended
_STATUS_TIME = 8.0  # seconds for which the status bar shows the outcome

Messages = list[tuple[str, str]]  # (INFO, WARNING or ERROR, text)


@dataclass(frozen=True)
class Outcome:
    """The result of the work and messages about it."""

    obj: bpy.types.Object
    messages: Messages = field(default_factory=list)


@dataclass
class Work:
    """The work of an operator."""

    label: str  # of the operator, in English
    about: ObjectHandle  # the object in whose panel the outcome is shown
    steps: Steps
    done: Callable[[bpy.types.Context, Any, bpy.types.Object], Outcome]  # called with the result
    # Names of data-blocks that must not change, by session_uid.
    watched: dict[int, str] = field(default_factory=dict)
    scene: int = 0  # its session_uid
    window: int = 0  # its address
    why: str = ""  # reason for a cancellation that the artist did not request
    shown: str = ""  # last line of the status bar
    job: Job = field(init=False)

    def __post_init__(self) -> None:
        self.job = Job(
            self.label,
            self.steps,
            self._done,
            self._failed,
            self._stopped,
            whole=False,
            works_during_renders=True,
        )

    def line(self) -> str:
        """Progress, or the reason for a pause."""
        work = operator_label(self.label)
        why = pause()
        if why:
            return translated("{work} pauses: {why}", work=work, why=why)
        return translated("{work}: {progress:.0%}", work=work, progress=self.job.progress)

    def _done(self, result: Any) -> str:
        outcome = self.done(bpy.context, result, self.about.get())
        _end(outcome.obj.session_uid, outcome.messages)
        return self.label

    def _failed(self, why: str) -> None:
        _end(self.about.uid, [("ERROR", why)])

    def _stopped(self, why: str) -> None:
        first = [("WARNING", self.why)] if self.why else []
        _end(self.about.uid, [*first, ("INFO", why)])


@dataclass
class _State:
    """State that the timer and the handlers share."""

    work: Work | None = None
    stepping: bool = False  # whether current changes come from the work itself
    frame_changed: float = 0.0  # time of the artist's last frame change, monotonic
    status: str = ""  # text in the status bars
    # Messages about finished work, by session_uid.
    notes: dict[int, Messages] = field(default_factory=dict)


_state = _State()


def current() -> Work | None:
    """The running work."""
    return _state.work


def begin(context: bpy.types.Context, work: Work) -> None:
    """Do the first step now and the others in a timer; errors of the first step are raised."""
    _state.notes.pop(work.about.uid, None)
    work.scene = context.scene.session_uid
    work.window = context.window.as_pointer() if context.window else 0
    _state.work, _state.frame_changed = work, 0.0
    try:
        with _own_changes():
            work.job.begin()
    except BaseException:
        _leave()
        raise
    call_within(0.0, tick)
    redraw()


def cancel(why: str = "") -> None:
    """Cancel the work; nothing is written."""
    if _state.work is not None:
        _state.work.why = _state.work.why or why
        _state.work.job.cancel()


def notes(obj: bpy.types.Object) -> Messages:
    """Messages about the last work on an object."""
    return notes_of(obj.session_uid)


def notes_of(uid: int) -> Messages:
    """The same by session_uid; the object may have been deleted."""
    return _state.notes.get(uid, [])


def dismiss(obj: bpy.types.Object) -> None:
    """Remove the messages about an object."""
    _state.notes.pop(obj.session_uid, None)
    redraw()


def pause() -> str:
    """Why the file must not be read or written now; empty if it may be."""
    if activity.is_rendering():
        return translated("Blender renders")
    if activity.is_playing():
        return translated("the animation plays")
    if activity.is_operated() or activity.is_painting():
        return translated("another tool is used")
    if activity.is_scrubbing() or time.monotonic() - _state.frame_changed < REST:
        return translated("the frame was changed")
    return ""


def tick() -> float | None:
    """Continue the work; returns seconds until the next call, None to end."""
    work = _state.work
    if work is None:
        return None
    if activity.is_rendering() or (pause() and not work.job.stepper.is_stopped):
        _show(work)
        return PAUSED
    try:
        with _where_it_began(work):
            ended = _advance(work)
    except BaseException:
        _end(work.about.uid, [])
        raise
    if ended:
        return None
    _show(work)
    return _POLL


def _advance(work: Work) -> bool:
    """Do some steps; returns whether the work has ended."""
    if work.job.waits:
        return False
    if bpy.context.scene.session_uid != work.scene:
        cancel(translated_report("Another scene is shown"))
    evaluate_changes()  # to notice those of the artist
    with _own_changes():
        return work.job.go_on(_PART)


@contextmanager
def _own_changes() -> Iterator[None]:
    _state.stepping = True
    try:
        yield
        evaluate_changes()
    finally:
        _state.stepping = False


@contextmanager
def _where_it_began(work: Work) -> Iterator[None]:
    """Use the window in which the work was started, or another one if that was closed."""
    with bpy.context.temp_override(window=_window(work)):
        yield


def _window(work: Work) -> bpy.types.Window | None:
    windows = list(bpy.context.window_manager.windows)
    same = [window for window in windows if window.as_pointer() == work.window]
    return next(iter([*same, *windows]), None)


def _end(uid: int, messages: Messages) -> None:
    """End the work and show messages in the panel of an object."""
    _leave()
    _state.notes[uid] = messages
    _write_status(" ".join(text for _, text in messages))
    if messages:
        call_within(_STATUS_TIME, _clear_status)
    redraw()


def _leave() -> None:
    """Stop the worker; steps restore their temporary changes."""
    work, _state.work = _state.work, None
    if work is not None:
        work.job.close()


def _show(work: Work) -> None:
    line = work.line()
    if line != work.shown:
        work.shown = line
        _write_status(translated("{line}    Esc in the 3D View cancels", line=line))
        redraw()


def _write_status(text: str) -> None:
    """Write into the status bars what is not there yet. While Blender opens the file of its command
    line, no window is active, and writing crashes it.
    """
    if text == _state.status:
        return
    _state.status = text
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(text or None)


def _clear_status() -> None:
    if _state.work is None:
        _write_status("")


def _updated(evaluation: Evaluation) -> None:
    """Cancel the work if watched data has changed."""
    work = _state.work
    if work is None or _state.stepping or is_quiet() or not work.watched:
        return
    for one in evaluation.updates:
        name = work.watched.get(one.uid)
        if one.is_edited and name is not None:
            cancel(translated_report("'{name}' was changed", name=name))


def _frame_changed(_evaluation: Evaluation) -> None:
    if not _state.stepping:
        _state.frame_changed = time.monotonic()


def _undone() -> None:
    """An undo may have changed anything."""
    _state.notes.clear()
    if _state.work is not None and _state.work.watched:
        cancel(translated_report("A step was undone or redone"))


def _before_load() -> None:
    _leave()
    _state.notes.clear()
    _write_status("")


def _disabled() -> None:
    _leave()
    _state.notes.clear()


SUBSCRIBER = Subscriber(
    updated=_updated,
    frame_changed=_frame_changed,
    undone=_undone,
    before_load=_before_load,
    disabled=_disabled,
    ticks=(tick, _clear_status),
)
