# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a result for the panel: whether it is up to date, and files of unfinished bakes.

Drawing only shows the last known state. Handlers note changes; a moment after the last change, a
timer checks only what has changed. Images are checked regularly, since Blender has no handler for
changed pixels. In background mode there is no timer, and the state is computed when it is needed.
"""

import time
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ..base import activity, jobs, step_operators
from ..base.handlers import Evaluation, Subscriber
from ..base.object_handles import ObjectHandle
from ..base.quiet import is_quiet
from ..base.sidebars import is_shown, redraw
from ..base.timers import call_in
from ..surface.images import picture_digest
from .scene_snapshot import AROUND, SceneSnapshot, depends_on
from .staleness import Verdict, verdict
from .unfinished_bakes import all_work_files, left_over, unfinished

PAUSE = 0.2  # seconds without a change before a check, or more if checks after edits take long
PATIENCE = 5.0  # ratio of that pause to the duration of a check
IMAGE_PATIENCE = 20.0  # the same for images
IMAGE_PAUSE = 2.0  # seconds between two checks of an image, or more if they take long

at_once = bpy.app.background


@dataclass(frozen=True)
class Findings:
    """The known state of a result."""

    verdict: Verdict
    unfinished: int  # solved frames from which Bake continues
    left_over: int  # frames that no bake can use
    files: bool  # whether there are any files of unfinished bakes


@dataclass
class _Request:
    """A scatter that the panel shows."""

    scatter: ObjectHandle
    snapshot: SceneSnapshot = field(default_factory=SceneSnapshot)
    depends: dict[int, tuple[str, ...]] = field(default_factory=dict)  # by session_uid
    findings: Findings | None = None
    outdated: bool = True
    # Properties of the image that are compared quickly, and its digest.
    picture: tuple[Any, str] = (None, "")


@dataclass
class _State:
    """State that the timer, the handlers and the panel share; file data is always
    looked up again.
    """

    requested: dict[int, _Request] = field(
        default_factory=dict
    )  # by the session_uid of the scatter
    changed: float = 0.0  # time of the last change, monotonic
    took: float = 0.0  # seconds that the last check took
    worked: bool = False  # whether Blender or the add-on was busy since then
    images_checked: float = 0.0  # time of the last check of images
    image_check_took: float = 0.0
    checking: bool = False


_state = _State()


def findings(obj: bpy.types.Object, context: bpy.types.Context) -> Findings | None:
    """The known state of a scatter; None until it has been found."""
    if at_once:
        return _find(obj, context, SceneSnapshot())
    one = _state.requested.get(obj.session_uid)
    if one is None:
        one = _state.requested[obj.session_uid] = _Request(ObjectHandle(obj))
        _wake()
    fits = one.findings is not None and not one.findings.verdict.reason
    return None if one.outdated and fits else one.findings


def is_watching() -> bool:
    """Whether the panel shows some scatter, so that it is checked."""
    return bool(_state.requested)


def has_work_files(obj: bpy.types.Object, context: bpy.types.Context) -> bool:
    """Whether there are files of unfinished bakes; True until that is known."""
    if at_once:
        return bool(all_work_files(obj))
    known = findings(obj, context)
    return known is None or known.files


def touch(obj: bpy.types.Object) -> None:
    """A scatter has changed in a way that no handler notices."""
    if obj.session_uid in _state.requested:
        _mark(_state.requested[obj.session_uid])


def tick() -> float | None:
    """Check scatters that may have changed; returns seconds until the next call, None to end."""
    if _busy():
        _state.worked = True
        return PAUSE
    # The artist goes on editing, but what work has changed stays as it is.
    pause = PAUSE if _state.worked else max(PAUSE, PATIENCE * _state.took)
    wait = pause - (time.monotonic() - _state.changed)
    if wait > 0.0:
        return max(wait, PAUSE)
    _state.worked = False
    for uid, one in list(_state.requested.items()):
        obj = _object(one)
        if obj is None or not is_shown(obj):
            del _state.requested[uid]
        elif one.outdated:
            _check(one, obj)
    _check_images()
    if any(one.outdated for one in _state.requested.values()):
        return PAUSE
    return IMAGE_PAUSE if any(_picture(one) for one in _state.requested.values()) else None


def _check(one: _Request, obj: bpy.types.Object) -> None:
    begin = time.monotonic()
    one.depends = depends_on(obj, bpy.context.scene)
    _state.checking = True
    try:
        one.findings = _find(obj, bpy.context, one.snapshot)
    finally:
        _state.checking = False
    one.outdated = False
    _state.took = time.monotonic() - begin
    redraw()


def _find(obj: bpy.types.Object, context: bpy.types.Context, snapshot: SceneSnapshot) -> Findings:
    found = verdict(obj, context, snapshot)
    return Findings(found, unfinished(obj), left_over(obj), bool(all_work_files(obj)))


def _object(one: _Request) -> bpy.types.Object | None:
    try:
        return one.scatter.get()
    except ScatterError:  # it was removed
        return None


def _picture(one: _Request) -> bpy.types.Image | None:
    obj = _object(one)
    return obj.dapple.density.image if obj is not None else None


def _check_images() -> None:
    """Check whether images were painted, for which Blender has no handler."""
    pause = max(IMAGE_PAUSE, IMAGE_PATIENCE * _state.image_check_took)
    if time.monotonic() - _state.images_checked < pause:
        return
    begin = time.monotonic()
    for one in _state.requested.values():
        image = _picture(one)
        if image is not None:
            _check_image(one, image)
    _state.images_checked = time.monotonic()
    _state.image_check_took = _state.images_checked - begin


def _check_image(one: _Request, image: bpy.types.Image) -> None:
    """An image is read only if it has unsaved changes or its file changed."""
    token = (image.session_uid, image.is_dirty, image.filepath, image.source, tuple(image.size))
    if token == one.picture[0] and not image.is_dirty:
        return
    seen = (token, picture_digest(image))
    if one.picture[0] is not None and seen != one.picture:
        one.snapshot.forget(AROUND)
        one.outdated = True
    one.picture = seen


def _mark(one: _Request) -> None:
    one.outdated = True
    _state.changed = time.monotonic()
    _state.worked = _state.worked or _busy()
    _wake()


def _wake() -> None:
    """Call the timer soon; it may be waiting for the next check of images."""
    call_in(PAUSE, tick)


def _busy() -> bool:
    """Whether Blender renders or plays the animation, or the add-on works."""
    if activity.is_rendering() or activity.is_playing():
        return True
    return step_operators.is_under_way() or jobs.is_working()


def _updated(evaluation: Evaluation) -> None:
    """Mark the scatters that depend on edited data, but not for the copies that a check makes."""
    if not _state.requested or (_state.checking and is_quiet()):
        return
    touched = {one.uid: one.is_edited for one in evaluation.updates}
    for one in _state.requested.values():
        for uid in touched.keys() & one.depends.keys():
            if touched[uid]:
                one.snapshot.forget(*one.depends[uid])
            _mark(one)


def _frame_changed(evaluation: Evaluation) -> None:
    _updated(evaluation)
    _mark_all()


def _saved(_path: str) -> None:
    _mark_all()


def _mark_all() -> None:
    for one in _state.requested.values():
        _mark(one)


SUBSCRIBER = Subscriber(
    updated=_updated,
    frame_changed=_frame_changed,
    render_ended=_mark_all,
    undone=_state.requested.clear,
    before_load=_state.requested.clear,
    saved=_saved,
    disabled=_state.requested.clear,
    ticks=(tick,),
)
