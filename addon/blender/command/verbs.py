# SPDX-License-Identifier: GPL-3.0-or-later
"""The verbs of the command: steps on scatters that return their part of the report."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bpy

from ...core.bake.baker import Baker
from ...core.base.errors import ScatterError
from ...core.base.steps import PAUSE, Steps, Task
from ..bake.steps import bake_steps
from ..base.object_handles import ObjectHandle
from ..base.times import show_time, time_of, times_of
from ..export.points import export_points
from ..freshness.content_changes import solved_time
from ..freshness.scene_snapshot import AROUND, SURFACE, VALUES, SceneSnapshot
from ..freshness.staleness import verdict
from ..scatter.object import is_unsolved
from ..solve.optimize import optimize_steps
from ..surface.reading import frame_kept
from .arguments import Arguments

Facts = dict[str, Any]  # of a scatter, in the report

BAKED, OPTIMIZED, EXPORTED = "baked", "optimized", "exported"
CURRENT, OUTDATED = "up to date", "out of date"
_NOTHING = Task(lambda _: None)


@dataclass(frozen=True)
class Verb:
    """A verb of the command."""

    steps: Callable[[list[bpy.types.Object], Arguments], Steps]  # context.object is the first
    saves: bool = False  # whether the file is changed
    together: bool = False  # whether all scatters are one piece of work


def _bake(group: list[bpy.types.Object], options: Arguments) -> Steps:
    (obj,) = group
    first, last = _range(options)
    if options.if_needed and not (yield from _why_not_current(obj, options, needs_bake=True)):
        return {"state": CURRENT}
    baker: Baker = yield from bake_steps(bpy.context, first, last)
    return {
        "state": BAKED,
        "frames": [first, last],
        "keyframes": obj.dapple.baked_keys,
        "solved": baker.done - baker.taken,
        "resumed": baker.taken,
        "optimized_first": baker.reoptimized_reason,
        "warnings": [baker.trouble] if baker.trouble else [],
        **_figures(obj),
    }


def _optimize(group: list[bpy.types.Object], options: Arguments) -> Steps:
    (obj,) = group
    if obj.dapple.baked_keys and not options.delete_keyframes:
        raise ScatterError(
            f"Scatter '{obj.name}' is baked: --delete-keyframes deletes the keyframes, or use bake"
        )
    with frame_kept(bpy.context.scene, show=options.frame):
        frame = bpy.context.scene.frame_current
        yield from optimize_steps(ObjectHandle(obj))
    return {"state": OPTIMIZED, "frame": frame, **_figures(obj)}


def _check(group: list[bpy.types.Object], options: Arguments) -> Steps:
    (obj,) = group
    reason = yield from _why_not_current(obj, options, needs_bake=options.baked)
    return {"state": OUTDATED if reason else CURRENT, "reason": reason}


def _export(group: list[bpy.types.Object], options: Arguments) -> Steps:
    """Export like File > Export."""
    yield PAUSE
    written = export_points(options.file, group, _exported_frames(options))
    left = f"Left out because they are not meshes: {', '.join(written.left_out)}"
    skewed = f"{written.skewed} instances are skewed: they are written without the skew"
    return {
        "state": EXPORTED,
        "files": [str(path) for path in written.files],
        "warnings": [left] * bool(written.left_out) + [skewed] * bool(written.skewed),
    }


def _exported_frames(options: Arguments) -> list[int]:
    """Numbers of the frames; empty for the current frame."""
    if options.frames is not None:
        return list(range(options.frames[0], options.frames[1] + 1))
    return [] if options.frame is None else [options.frame]


def _why_not_current(obj: bpy.types.Object, options: Arguments, needs_bake: bool) -> Any:
    """Why a scatter is not up to date; empty if it is."""
    if is_unsolved(obj):
        return "It has no points yet: optimize"
    if needs_bake and not obj.dapple.baked_keys:
        return "It is not baked"
    with _range_shown(bpy.context.scene, *_range(options)):
        return (yield from stale_in(obj, *_range(options)))


def _figures(obj: bpy.types.Object) -> Facts:
    report = obj.dapple.report
    names = ("spacing", "capacity_variation", "alpha_min", "converged")
    return {"points": report.count, **{name: getattr(report, name) for name in names}}


def _range(options: Arguments) -> tuple[int, int]:
    scene = bpy.context.scene
    return options.frames or (scene.frame_start, scene.frame_end)


@contextmanager
def _range_shown(scene: bpy.types.Scene, first: int, last: int) -> Iterator[None]:
    """Use these frames as the range of the scene, with which a bake is compared."""
    before = scene.frame_start, scene.frame_end
    try:
        scene.frame_start, scene.frame_end = first, last
        yield
    finally:
        scene.frame_start, scene.frame_end = before


VERBS = {
    "bake": Verb(_bake, saves=True),
    "optimize": Verb(_optimize, saves=True),
    "check": Verb(_check),
    "export": Verb(_export, together=True),
}


def stale_in(obj: bpy.types.Object, first: int, last: int) -> Any:
    """Steps that return why a result does not fit in the first frame where it does not; empty if it
    fits. A scatter without a bake is compared in the frame in which it was optimized.
    """
    scene, snapshot = bpy.context.scene, SceneSnapshot()
    times = _times(obj, scene, first, last)
    with frame_kept(scene):
        for step, time in enumerate(times):
            yield Task(_NOTHING.call, step / len(times), (step + 1) / len(times))
            show_time(scene, time)
            snapshot.forget(SURFACE, VALUES, AROUND)
            reason = verdict(obj, bpy.context, snapshot).reason
            if reason:
                return reason
    return ""


def _times(obj: bpy.types.Object, scene: bpy.types.Scene, first: int, last: int) -> list[float]:
    if obj.dapple.baked_keys:
        begin, end = times_of(scene, first, last)
        return [float(time) for time in range(begin, end + 1)]
    solved = solved_time(obj)
    return [time_of(scene) if solved is None else solved]
