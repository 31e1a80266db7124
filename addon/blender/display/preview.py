# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: while the artist scrubs or poses, points are kept even within a time budget.

A timer reads the surface after Blender has evaluated it, a worker computes the places of the
points, and the timer writes them as a separate binding, which the node group plays in the viewport
only. Renders play the bake or the stored binding, so a preview neither runs in a render nor changes
it. Handlers only note that something happened.
"""

from dataclasses import dataclass
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps
from ..base import activity
from ..base.all_or_nothing import sentence
from ..base.handlers import Evaluation, Subscriber
from ..base.jobs import Job
from ..base.object_handles import ObjectHandle
from ..base.step_operators import AllOrNothing
from ..base.timers import call_within
from ..base.translation import translated
from ..scatter.object import check_all_over, surface_of
from ..scatter.points import own_points
from ..surface.polls import ready
from .preview_steps import Preview, begin_steps, clear_bindings, follow_steps

_TICK = 0.05  # seconds between two checks of the surface
_POLL = 0.005  # seconds between two checks of a worker
_LABEL = "Live Preview"


@dataclass
class _State:
    """State that the timer and the handlers share; file data is always looked up again."""

    previews: dict[int, Preview]  # by the scatter's session_uid
    dirty: bool = False
    undone: bool = False  # an undo may have restored a preview that is off
    end_reason: str = ""  # reason why a preview ended by itself


_state = _State({})


def is_on(obj: bpy.types.Object) -> bool:
    """Whether a scatter has a preview."""
    return obj.session_uid in _state.previews


def is_settled() -> bool:
    """Whether all previews are up to date with their surfaces."""
    return not _state.dirty and all(one.job is None for one in _state.previews.values())


def stop_all() -> None:
    """End all previews."""
    for uid in list(_state.previews):
        _give_up(uid)
    clear_bindings()


def note(obj: bpy.types.Object) -> str:
    """The state of a scatter's preview, for the panel."""
    if not is_on(obj):
        return _state.end_reason
    follower = _state.previews[obj.session_uid].follower
    if follower is None:
        return translated("The preview is being prepared")
    if follower.over_budget:
        return translated("Over budget: points stick to the surface")
    return translated("Points are kept even")


def start(obj: bpy.types.Object) -> None:
    """Preview a scatter; ScatterError if it does not fit its surface.

    If there are windows, this is checked in the background, and the panel shows the error.
    """
    check_all_over(obj)
    preview = Preview(ObjectHandle(obj), ObjectHandle(surface_of(obj)))
    if not own_points(obj).all():
        raise ScatterError(
            f"Scatter '{obj.name}' has points that its bake added: clear the bake to preview"
        )
    _give_up(obj.session_uid)
    clear_bindings(keep=_state.previews)  # a copy of a previewed scatter has its preview too
    preview.job = _job(preview, begin_steps(preview))
    preview.job.begin()
    _state.previews[obj.session_uid] = preview
    _state.end_reason, _state.dirty = "", True
    call_within(_TICK, tick)


def stop(obj: bpy.types.Object) -> None:
    """End a scatter's preview: it shows its bake or its stored binding again."""
    _give_up(obj.session_uid)
    clear_bindings(keep=_state.previews)


def restart(obj: bpy.types.Object) -> None:
    """Restart a scatter's preview, if there is one, from its current points."""
    preview = _state.previews.get(obj.session_uid)
    clear_bindings(keep=_state.previews)
    if preview is not None:
        _restart_steps(preview)


def _restart_steps(preview: Preview) -> None:
    try:
        start(preview.scatter.get())
    except Exception as error:
        _end(preview, sentence(_LABEL, error))


def tick() -> float | None:
    """Check the surfaces of previews; returns seconds until the next call, None to end."""
    if _state.undone and not activity.is_rendering():
        _state.undone = False
        clear_bindings(keep=_state.previews)
    if not _state.previews and not _state.undone:
        return None
    if activity.is_rendering():
        return _TICK
    dirty, _state.dirty = _state.dirty, False
    for preview in list(_state.previews.values()):
        _check(preview, dirty)
    is_running = any(one.job is not None for one in _state.previews.values())
    return _POLL if is_running else _TICK


def _check(preview: Preview, dirty: bool) -> None:
    """Continue a preview's job, or start one if its surface may have changed."""
    if preview.job is not None:
        _state.dirty |= dirty  # checked when the job is done
    elif _has_other_surface(preview):
        _restart_steps(preview)
    elif dirty:
        preview.job = _job(preview, follow_steps(preview))
    if preview.job is not None:
        preview.job.go_on()


def _job(preview: Preview, steps: Steps) -> Job:
    def done(_result: Any) -> str:
        preview.job = None
        return ""

    def stopped(_why: str) -> None:
        preview.job, _state.dirty = None, True

    return Job(_LABEL, steps, done, lambda why: _end(preview, why), stopped)


def _has_other_surface(preview: Preview) -> bool:
    """Whether another surface was chosen, or one of both objects deleted."""
    try:
        surface = preview.scatter.get().dapple.surface
    except ScatterError:
        return True
    return surface is None or surface.session_uid != preview.surface.uid


def _give_up(uid: int) -> None:
    """End a preview and abandon its worker."""
    preview = _state.previews.pop(uid, None)
    if preview is not None and preview.job is not None:
        preview.job.abandon()


def _end(preview: Preview, why: str) -> None:
    _give_up(preview.scatter.uid)
    _state.end_reason = translated("Preview ended: {why}", why=why)
    clear_bindings(keep=_state.previews)


def _touched() -> None:
    _state.dirty = True


def _evaluated(_evaluation: Evaluation) -> None:
    _touched()


def _undone() -> None:
    _state.undone = _state.dirty = True
    call_within(_TICK, tick)


def _before_load() -> None:
    stop_all()
    _state.undone, _state.end_reason = False, ""


def _disabled() -> None:
    if hasattr(bpy.data, "objects"):  # False while Blender starts, before there is a file
        stop_all()


SUBSCRIBER = Subscriber(
    updated=_evaluated,
    frame_changed=_evaluated,
    render_ended=_touched,
    undone=_undone,
    before_load=_before_load,
    loaded=clear_bindings,  # a file saved during recovery may contain a preview
    before_save=stop_all,  # the saved file shows the bake or the stored binding
    disabled=_disabled,
    ticks=(tick,),
)


class DAPPLE_OT_live_preview(AllOrNothing, bpy.types.Operator):
    """Keep the points even in the viewport while scrubbing or posing, but not in renders. Run
    again to stop"""

    bl_idname = "dapple.live_preview"
    bl_label = "Live Preview"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        obj = context.object
        (stop if is_on(obj) else start)(obj)


CLASSES = (DAPPLE_OT_live_preview,)
