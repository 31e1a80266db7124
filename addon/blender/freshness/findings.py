# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel says of a result without waiting for it: whether it fits, what is on the disk.

Drawing only shows what was found last. Handlers note what changed; once nothing has changed for a
moment, an app timer looks again, at what changed alone. While nothing changes nothing is done, but
for a picture: Blender has no handler for changed pixels. In background mode there is no timer, and
what is asked for is found at once.
"""

import time
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ..base import artist, renders, step_operators
from ..base.handlers import Evaluation, Subscriber
from ..base.object_handles import Held
from ..base.sidebars import is_shown, redraw
from ..base.timers import call_in
from ..surface.images import picture_digest
from .scene_snapshot import AROUND, Present, depends_on
from .staleness import Verdict, verdict
from .unfinished_bakes import all_work_files, left_over, unfinished

PAUSE = 0.2  # seconds without a change before a check, or more if checks take long
PATIENCE = 5.0  # ratio of that pause to the duration of a check
RARELY = 20.0  # the same for images
GLANCE = 2.0  # seconds between two checks of an image, or more if they take long

at_once = bpy.app.background


@dataclass(frozen=True)
class Findings:
    """The known state of a result."""

    verdict: Verdict
    unfinished: int  # solved frames from which Bake continues
    left_over: int  # frames that no bake can use
    files: bool  # whether there are any files of unfinished bakes


@dataclass
class _Asked:
    """A scatter that the panel shows."""

    scatter: Held
    present: Present = field(default_factory=Present)
    depends: dict[int, tuple[str, ...]] = field(default_factory=dict)  # by session_uid
    findings: Findings | None = None
    doubtful: bool = True
    # Properties of the image that are compared quickly, and its digest.
    picture: tuple[Any, str] = (None, "")


@dataclass
class _State:
    """What the timer, the handlers and the panel share; file data is always looked up anew."""

    asked: dict[int, _Asked] = field(default_factory=dict)  # by the session_uid of the scatter
    changed: float = 0.0  # time of the last change, monotonic
    took: float = 0.0  # seconds that the last check took
    glanced: float = 0.0  # time of the last check of images
    glance_took: float = 0.0


_state = _State()


def findings(obj: bpy.types.Object, context: bpy.types.Context) -> Findings | None:
    """The known state of a scatter; None until it has been found."""
    if at_once:
        return _find(obj, context, Present())
    one = _state.asked.get(obj.session_uid)
    if one is None:
        one = _state.asked[obj.session_uid] = _Asked(Held(obj))
        _wake()
    fits = one.findings is not None and not one.findings.verdict.reason
    return None if one.doubtful and fits else one.findings


def is_watching() -> bool:
    """Whether the panel shows some scatter, so that it is checked."""
    return bool(_state.asked)


def has_work_files(obj: bpy.types.Object, context: bpy.types.Context) -> bool:
    """Whether there are files of unfinished bakes; True until that is known."""
    if at_once:
        return bool(all_work_files(obj))
    known = findings(obj, context)
    return known is None or known.files


def touch(obj: bpy.types.Object) -> None:
    """A scatter has changed in a way that no handler notices."""
    if obj.session_uid in _state.asked:
        _doubt(_state.asked[obj.session_uid])


def tick() -> float | None:
    """Check scatters that may have changed; returns seconds until the next call, None to end."""
    wait = max(PAUSE, PATIENCE * _state.took) - (time.monotonic() - _state.changed)
    if _busy() or wait > 0.0:
        return max(wait, PAUSE)
    for uid, one in list(_state.asked.items()):
        obj = _object(one)
        if obj is None or not is_shown(obj):
            del _state.asked[uid]
        elif one.doubtful:
            _look(one, obj)
    _glance_at_pictures()
    if any(one.doubtful for one in _state.asked.values()):
        return PAUSE
    return GLANCE if any(_picture(one) for one in _state.asked.values()) else None


def _look(one: _Asked, obj: bpy.types.Object) -> None:
    begin = time.monotonic()
    one.depends = depends_on(obj, bpy.context.scene)
    one.findings = _find(obj, bpy.context, one.present)
    one.doubtful = False
    _state.took = time.monotonic() - begin
    redraw()


def _find(obj: bpy.types.Object, context: bpy.types.Context, present: Present) -> Findings:
    found = verdict(obj, context, present)
    return Findings(found, unfinished(obj), left_over(obj), bool(all_work_files(obj)))


def _object(one: _Asked) -> bpy.types.Object | None:
    try:
        return one.scatter.get()
    except ScatterError:  # it was removed
        return None


def _picture(one: _Asked) -> bpy.types.Image | None:
    obj = _object(one)
    return obj.dapple.density.image if obj is not None else None


def _glance_at_pictures() -> None:
    """Check whether images were painted, for which Blender has no handler."""
    pause = max(GLANCE, RARELY * _state.glance_took)
    if time.monotonic() - _state.glanced < pause:
        return
    begin = time.monotonic()
    for one in _state.asked.values():
        image = _picture(one)
        if image is not None:
            _glance(one, image)
    _state.glanced = time.monotonic()
    _state.glance_took = _state.glanced - begin


def _glance(one: _Asked, image: bpy.types.Image) -> None:
    """An image is read only if it has unsaved changes or its file changed."""
    token = (image.session_uid, image.is_dirty, image.filepath, image.source, tuple(image.size))
    if token == one.picture[0] and not image.is_dirty:
        return
    seen = (token, picture_digest(image))
    if one.picture[0] is not None and seen != one.picture:
        one.present.forget(AROUND)
        one.doubtful = True
    one.picture = seen


def _doubt(one: _Asked) -> None:
    one.doubtful = True
    _state.changed = time.monotonic()
    _wake()


def _wake() -> None:
    """Call the timer soon; it may be waiting for the next check of images."""
    call_in(PAUSE, tick)


def _busy() -> bool:
    """Whether Blender renders, plays the animation or runs an operator of the add-on."""
    return renders.busy() or step_operators.is_under_way() or artist.is_playing()


def _updated(evaluation: Evaluation) -> None:
    """Mark the scatters that depend on edited data."""
    if not _state.asked:
        return
    touched = {one.uid: one.is_edited for one in evaluation.updates}
    for one in _state.asked.values():
        for uid in touched.keys() & one.depends.keys():
            if touched[uid]:
                one.present.forget(*one.depends[uid])
            _doubt(one)


def _frame_changed(evaluation: Evaluation) -> None:
    _updated(evaluation)
    _all_doubtful()


def _saved(_path: str) -> None:
    _all_doubtful()


def _all_doubtful() -> None:
    for one in _state.asked.values():
        _doubt(one)


SUBSCRIBER = Subscriber(
    updated=_updated,
    frame_changed=_frame_changed,
    render_ended=_all_doubtful,
    undone=_state.asked.clear,
    before_load=_state.asked.clear,
    saved=_saved,
    disabled=_state.asked.clear,
    ticks=(tick,),
)
