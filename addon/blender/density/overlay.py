# SPDX-License-Identifier: GPL-3.0-or-later
"""The density as colors over the surface, in the viewport only.

Handlers and property updates only note changes. A moment after the last change, a timer reads the
surface in parts and a worker computes the colors; until then the last colors are drawn. Nothing is
computed while Blender renders.
"""

import time
from dataclasses import dataclass, field
from typing import Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.density.colors import Colored, Singles, computed
from ..base import activity
from ..base.all_or_nothing import sentence
from ..base.handlers import Evaluation, Subscriber
from ..base.jobs import Job
from ..base.object_handles import ObjectHandle
from ..base.quiet import is_quiet
from ..base.timers import call_within
from ..base.translation import translated
from ..scatter.object import surface_of
from ..surface.reading import read_parts
from . import legend as density_legend
from .shown_term import Request, legend_of, request_of, watched_by

PAUSE = 0.2  # seconds without a change before the colors are computed
_POLL = 0.01  # seconds between two looks at the worker
_LABEL = "Show Density"
_PART = 300_000  # corners uploaded to the graphics card at a time
_NOTHING = Colored(np.empty((0, 3), np.float32), np.empty((0, 4), np.float32), 0.0)
Part = tuple[Singles, Singles]  # positions and colors of corners


@dataclass
class _Shown:
    """The scatter whose density is shown, with its triangles."""

    scatter: ObjectHandle | None = None
    request: Request | None = None
    watched: frozenset[int] = frozenset()  # session_uids of data that the colors depend on
    colored: Colored = _NOTHING
    legend: tuple[str, str, str] | None = None  # title, and the meaning of both ends
    batches: list[Any] = field(default_factory=list)  # drawn batches
    waiting: list[Part] = field(default_factory=list)  # parts to be uploaded
    # Batches of the newest colors until all are uploaded.
    coming: list[Any] = field(default_factory=list)
    job: Job | None = None  # the running computation
    changed: float = 0.0  # time of the last change, monotonic; 0 if the colors are current
    end_reason: str = ""  # reason why it ended
    handles: tuple[Any, ...] = ()


_shown = _Shown()


def is_on(obj: bpy.types.Object) -> bool:
    """Whether the density of a scatter is shown."""
    return _shown.scatter is not None and _shown.scatter.uid == obj.session_uid


def note() -> str:
    """Why the density is not shown; empty if it is."""
    if _shown.scatter is not None and _shown.legend is None:
        return translated("The density is being computed")
    return _shown.end_reason


def start(obj: bpy.types.Object) -> None:
    """Show the density of a scatter; ScatterError if it cannot be computed.

    If there are windows, this is checked in the background, and the panel shows the error.
    """
    stop()
    _shown.scatter, _shown.end_reason = ObjectHandle(obj), ""
    try:
        _begin()
    except ScatterError:
        stop()
        raise
    if not bpy.app.background:
        space = bpy.types.SpaceView3D
        _shown.handles = (
            space.draw_handler_add(draw, (), "WINDOW", "POST_VIEW"),
            space.draw_handler_add(_draw_legend, (), "WINDOW", "POST_PIXEL"),
        )
    call_within(_POLL, tick)
    _redraw()


def stop() -> None:
    """Stop showing a density."""
    _give_up()
    for handle in _shown.handles:
        bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
    if _shown.handles:
        _redraw()
    _shown.handles, _shown.scatter, _shown.request = (), None, None
    _shown.colored, _shown.legend = _NOTHING, None
    _shown.batches, _shown.coming, _shown.waiting, _shown.changed = [], [], [], 0.0


def touch(obj: bpy.types.Object) -> None:
    """Data has changed that a scatter's density may depend on."""
    if is_on(obj):
        _shown.changed = time.monotonic()


def is_computing() -> bool:
    """Whether new colors are being computed or will be."""
    return _shown.job is not None or bool(_shown.changed)


def triangles() -> tuple[Singles, Singles]:
    """The drawn triangles: corners (3 m, 3) in world space and their colors (3 m, 4)."""
    return _shown.colored.positions, _shown.colored.colors


def legend() -> tuple[str, str, str] | None:
    """The title of the legend and the meaning of both ends of its colors."""
    return _shown.legend


def _begin() -> None:
    """Compute the colors again."""
    _give_up()
    assert _shown.scatter is not None
    obj = _shown.scatter.get()
    _shown.request, _shown.changed = request_of(obj), 0.0
    _shown.watched = watched_by(obj, _shown.request)
    steps = _steps(_shown.scatter, ObjectHandle(surface_of(obj)), _shown.request)
    _shown.job = Job(_LABEL, steps, _done, _failed, _stopped)
    _shown.job.begin()


def _steps(scatter: ObjectHandle, surface: ObjectHandle, request: Request) -> Steps:
    read = yield from read_parts(surface, request.settings, scatter)
    settings, density, alone = request.settings, request.density, request.alone
    return (yield Task(lambda worker: computed(read.arrays(), settings, density, alone, worker)))


def _done(found: Colored) -> str:
    _shown.job = None
    _shown.colored = found
    _shown.waiting, _shown.coming = _parts(found.positions, found.colors), []
    _shown.legend = legend_of(_shown.scatter.get(), found) if _shown.scatter else None
    _redraw()
    return ""


def _failed(why: str) -> None:
    stop()
    _shown.end_reason = translated("Density is not shown: {error}", error=why)


def _stopped(_why: str) -> None:
    """A render took its place."""
    _shown.job, _shown.changed = None, time.monotonic()


def _give_up() -> None:
    if _shown.job is not None:
        _shown.job.abandon()
    _shown.job = None


def tick() -> float | None:
    """Start or continue the computation; returns seconds until the next call, None to end."""
    if _shown.scatter is None:
        return None
    if activity.is_rendering():
        return PAUSE
    try:
        _check(_shown.scatter.get())
    except Exception as error:
        _failed(sentence(_LABEL, error))
        return None
    if _shown.job is not None:
        _shown.job.go_on()
    uploads = bool(_shown.waiting) and bool(_shown.handles)
    if uploads:
        _redraw()
    return _POLL if uploads or _shown.job is not None else PAUSE


def _check(obj: bpy.types.Object) -> None:
    """Start the computation once nothing has changed for a moment."""
    if request_of(obj) != _shown.request and not _shown.changed:
        _shown.changed = time.monotonic()
    if _shown.changed and time.monotonic() - _shown.changed >= PAUSE:
        _begin()


def draw() -> None:
    """Draw the batches; upload one part of the newest colors."""
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    _upload(shader)
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    for batch in _shown.batches:
        batch.draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def _draw_legend() -> None:
    if _shown.legend is not None and bpy.context.space_data.overlay.show_overlays:
        density_legend.draw(*_shown.legend, bpy.context.preferences.system.ui_scale)


def _parts(positions: Singles, colors: Singles) -> list[Part]:
    """The corners in parts that are uploaded at a time."""
    firsts = range(0, len(positions), _PART)
    return [(positions[k : k + _PART], colors[k : k + _PART]) for k in firsts]


def _upload(shader: Any) -> None:
    """Upload one more part; the graphics card accepts data only while drawing."""
    if not _shown.waiting:
        return
    positions, colors = _shown.waiting.pop(0)
    content = {"pos": positions, "color": colors}
    _shown.coming.append(batch_for_shader(shader, "TRIS", content))
    if not _shown.waiting:
        _shown.batches, _shown.coming = _shown.coming, []


def _redraw() -> None:
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()


def _updated(evaluation: Evaluation) -> None:
    if _shown.scatter is None:
        return
    # Temporary changes list all objects, as reading a vertex group makes a copy of the mesh.
    seen = {one.uid for one in evaluation.updates if one.is_edited or not is_quiet()}
    # A script that changes pixels causes an update without names.
    if not evaluation.updates or seen & _shown.watched:
        _shown.changed = time.monotonic()


def _undone() -> None:
    if _shown.scatter is not None:
        _shown.changed = time.monotonic()


def _before_load() -> None:
    stop()
    _shown.end_reason = ""


SUBSCRIBER = Subscriber(
    updated=_updated,
    frame_changed=_updated,
    undone=_undone,
    before_load=_before_load,
    disabled=stop,
    ticks=(tick,),
)
