# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update: scatters are solved again a moment after the last change of their inputs, and at
once when a stroke, a move or another operator has ended. Optimize requests such an update, which
then starts from the seed.

Handlers and property updates only note changes. A timer reads the inputs in parts, a worker solves,
and the timer writes; until then the old points stay. A change during this work discards it and
starts the pause again. An automatic update makes no undo step: an undo of the artist's change
restores settings or points that do not fit, which is a change like any other. A requested update
makes an undo step when its points have been written.

In background mode there are no automatic updates, except in tests that call the timer themselves.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.base.schedule import Schedule
from ..base import activity, step_operators
from ..base.activity import is_operated
from ..base.handlers import Evaluation, Subscriber
from ..base.jobs import Job
from ..base.object_handles import ObjectHandle
from ..base.quiet import is_quiet
from ..base.sidebars import redraw
from ..base.step_operators import is_under_way
from ..base.timers import call_in
from ..display import preview
from .changes import NOBODY, Cause, Changes, follows, scatters
from .optimize import optimize_steps

_POLL = 0.005  # seconds between two checks of a worker
_PART = 0.01  # seconds that one call may block the interface
_BLOCKED_PAUSE = 0.1  # seconds between two checks while the file must not be written
_TOOL = 0.02  # the same while the artist uses a tool and waits for the result

enabled = not bpy.app.background


@dataclass(frozen=True)
class _Request:
    """A request of the artist."""

    step: str  # name of the undo step: the label of the button
    deletes_keyframes: bool


@dataclass
class _Update:
    """A scatter that is being solved."""

    scatter: ObjectHandle
    cause: Cause  # the scatter itself and the scatters that caused its update
    request: _Request | None  # None: the update follows a change
    job: Job = field(init=False)
    shown: int = -1  # percent shown by the panel

    def __post_init__(self) -> None:
        requested, deletes_keyframes = (
            self.request is not None,
            self.request is not None and self.request.deletes_keyframes,
        )
        steps = optimize_steps(
            self.scatter, requested=requested, deletes_keyframes=deletes_keyframes
        )
        self.job = Job("Optimize", steps, self._done, self._failed, self._stopped, whole=False)

    def writes(self) -> dict[int, Cause]:
        """The causes of changes to the data that this update writes, by session_uid."""
        try:
            obj = self.scatter.get()
        except ScatterError:  # it was removed
            return {}
        return dict.fromkeys((obj.session_uid, obj.data.session_uid), self.cause)

    def _done(self, result: Any) -> str:
        _end(self)
        if not result:
            _state.changes.wait_for_frame(self.scatter.get())
            return ""
        _state.changes.wrote(self.writes())
        restart_preview(self.scatter.get())
        return self.request.step if self.request else ""

    def _failed(self, why: str) -> None:
        _end(self)
        _state.failures[self.scatter.uid] = why

    def _stopped(self, _why: str) -> None:
        """A render or an operator has stopped the update: schedule it again."""
        _state.update = None
        _state.schedule.change(self.scatter.uid)


@dataclass
class _State:
    """State that the timer and the handlers share; file data is always looked up again."""

    schedule: Schedule = field(default_factory=Schedule)
    changes: Changes = field(default_factory=Changes)
    update: _Update | None = None
    caused: dict[int, Cause] = field(default_factory=dict)  # why each scheduled scatter is updated
    # Reasons why scatters could not be solved.
    failures: dict[int, str] = field(default_factory=dict)
    # Requested solutions from the seed.
    requested: dict[int, _Request] = field(default_factory=dict)


_state = _State()


def progress(obj: bpy.types.Object) -> float | None:
    """The progress of a scatter's update in [0, 1]; None if none is pending."""
    update = _state.update
    if update is not None and update.scatter.uid == obj.session_uid:
        return update.job.progress
    is_next = obj.session_uid in _state.schedule and (is_requested(obj) or follows(obj))
    return 0.0 if is_next else None


def trouble(obj: bpy.types.Object) -> str:
    """The reason why the last update of a scatter failed; empty if it succeeded."""
    return _state.failures.get(obj.session_uid, "")


def touch(obj: bpy.types.Object) -> None:
    """Note that a setting of a scatter has changed, and perhaps its dependencies."""
    if enabled and not is_quiet():
        _state.changes.relink()
        _change(obj.session_uid)
        _wake()


def request(obj: bpy.types.Object, step: str = "Optimize") -> None:
    """Solve a scatter from its seed, as Optimize does; a running update of it is discarded.

    `step` is the name of the undo step. Keyframes are deleted only if the scatter has some now.
    """
    forget(obj)
    _change(obj.session_uid)
    _state.requested[obj.session_uid] = _Request(step, obj.dapple.baked_keys > 0)
    _state.schedule.hurry(obj.session_uid)
    _state.changes.relink()
    _wake()
    redraw()


def is_requested(obj: bpy.types.Object) -> bool:
    """Whether a solution of a scatter from its seed is running or pending."""
    return obj.session_uid in _state.requested


def forget(obj: bpy.types.Object) -> None:
    """Discard a pending or running update of a scatter that was solved in another way."""
    _state.requested.pop(obj.session_uid, None)
    _state.schedule.forget(obj.session_uid)
    if _state.update is not None and _state.update.scatter.uid == obj.session_uid:
        _give_up()


def cancel() -> None:
    """Cancel all updates until the next change."""
    _state.requested.clear()
    _state.schedule.clear()
    _give_up()
    redraw()


def is_solving() -> bool:
    """Whether some scatter is being solved now."""
    return _state.update is not None and _state.update.job.is_running


def has_noted() -> bool:
    """Whether there are changes that have not been processed."""
    return _state.changes.any_noted()


def is_active() -> bool:
    """Whether the update of some scatter is running or pending."""
    return _state.update is not None or bool(_state.schedule)


def tick() -> float | None:
    """Continue the work; returns seconds until the next call, None to end."""
    wait = _check()
    return 0.0 if _state.changes.any_noted() else wait


def _check() -> float | None:
    _state.changes.note_operator_end()
    if is_blocked():
        _schedule_changed()
        _pause()
        waits = is_active() or _state.changes.wait() is not None
        return (_TOOL if _state.changes.used_tool else _BLOCKED_PAUSE) if waits else None
    if enabled and _state.update is None:
        _state.changes.check_images()
    _schedule_changed()
    if _state.changes.take_operator_end():
        _state.schedule.settle()
    if _state.update is None:
        _begin()
    if _state.update is not None:
        _go_on(_state.update)
    if _state.update is not None:
        return _POLL if _state.update.job.waits else 0.0
    return _idle_time()


def _idle_time() -> float | None:
    """Seconds until there may be work."""
    tool = _TOOL if _state.changes.used_tool and _state.schedule else None
    waits = [_state.schedule.wait(), _state.changes.wait(), tool]
    return min((one for one in waits if one is not None), default=None)


def _schedule_changed() -> None:
    """Schedule the scatters that depend on changed data."""
    writes = _state.update.writes() if _state.update is not None else {}
    for uid, cause in _state.changes.changed_scatters(writes):
        _change(uid, cause)
    existing = _state.changes.known_scatters()
    for uid in _state.requested.keys() - existing:  # an undo may have removed them
        del _state.requested[uid]
    if _state.update is not None and _state.update.scatter.uid not in existing:
        _give_up()


def _change(uid: int, cause: Cause = NOBODY) -> None:
    _state.changes.start_update(uid)
    _state.failures.pop(uid, None)
    _state.caused[uid] = cause
    _state.schedule.change(uid)
    if _state.update is not None and _state.update.scatter.uid == uid:
        _give_up()


def _begin() -> None:
    uid = _state.schedule.take()
    obj = next((one for one in scatters() if one.session_uid == uid), None)
    if obj is None:
        return
    handle = ObjectHandle(obj)
    request = _state.requested.get(handle.uid)
    if request is not None or follows(obj):
        cause = _state.caused.pop(handle.uid, NOBODY) | {handle.uid}
        _state.update = _Update(handle, cause, request)
    else:
        _state.changes.skip(handle.uid)


def _go_on(update: _Update) -> None:
    try:
        if not (update.request and is_operated()):
            update.job.go_on(_PART)
    except BaseException:
        _end(update)
        raise
    _show(update)


def _end(update: _Update) -> None:
    _state.update = None
    _state.requested.pop(update.scatter.uid, None)


def _give_up() -> None:
    """Abandon the running update and its worker."""
    update, _state.update = _state.update, None
    if update is not None:
        update.job.abandon()


def _show(update: _Update) -> None:
    hundredths = -1 if _state.update is None else int(100 * update.job.progress)
    if hundredths != update.shown or _state.update is None:
        update.shown = hundredths
        redraw()


def _wake() -> None:
    """Call the timer now; it may be waiting for the next check of images."""
    call_in(0.0, tick)


def _updated(evaluation: Evaluation) -> None:
    """Note changes and process them soon."""
    if not enabled or is_quiet():
        return
    if _state.changes.note(evaluation):
        _wake()


def _frame_changed(evaluation: Evaluation) -> None:
    """A change at another frame may matter at this one."""
    if enabled and not is_quiet() and _state.changes.note_frame(evaluation.scene):
        _wake()


def _undone() -> None:
    """An undo may have changed anything."""
    if enabled:
        _state.changes.mark_all()
        _give_up()
        _wake()


def reset(clock: Callable[[], float] = time.monotonic) -> None:
    """Forget all changes, updates and requests."""
    _give_up()
    vars(_state).update(vars(_State(Schedule(clock))))


def _pause() -> None:
    """Cancel the update if an operator needs the file; the worker may run during playback."""
    if _state.update is not None and is_under_way():
        _state.update.job.cancel()


SUBSCRIBER = Subscriber(
    updated=_updated,
    frame_changed=_frame_changed,
    undone=_undone,
    before_load=reset,
    disabled=reset,
    ticks=(tick,),
)


def restart_preview(obj: bpy.types.Object) -> None:
    """Restart the live preview from the new points."""
    preview.restart(obj)


def is_blocked() -> bool:
    """Whether Blender renders, plays or paints a stroke, or an operator of the add-on works."""
    return (
        activity.is_rendering()
        or step_operators.is_under_way()
        or activity.is_playing()
        or activity.is_painting()
    )
