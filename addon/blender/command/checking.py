# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a result fits what is there, in every frame and not only in the one that is shown."""

from typing import Any

import bpy

from ...core.base.steps import Task
from ..base.times import show_time, time_of, times_of
from ..freshness.contents import solved_time
from ..freshness.scene_snapshot import AROUND, SURFACE, VALUES, Present
from ..freshness.staleness import verdict
from ..surface.reading import frame_kept

_NOTHING = Task(lambda _: None)


def stale_in(obj: bpy.types.Object, first: int, last: int) -> Any:
    """Steps that return why a result does not fit, in the first frame where it does not; empty
    when it fits. A scatter without a bake is compared in the frame in which it was optimized.
    """
    scene, present = bpy.context.scene, Present()
    times = _times(obj, scene, first, last)
    with frame_kept(scene):
        for step, time in enumerate(times):
            yield Task(_NOTHING.call, step / len(times), (step + 1) / len(times))
            show_time(scene, time)
            present.forget(SURFACE, VALUES, AROUND)
            reason = verdict(obj, bpy.context, present).reason
            if reason:
                return reason
    return ""


def _times(obj: bpy.types.Object, scene: bpy.types.Scene, first: int, last: int) -> list[float]:
    if obj.dapple.baked_keys:
        begin, end = times_of(scene, first, last)
        return [float(time) for time in range(begin, end + 1)]
    solved = solved_time(obj)
    return [time_of(scene) if solved is None else solved]
