# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a bake does not fit any more: its keys, its range of frames, the motion."""

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.solve.stale import moved
from ..base.times import time_of, times_of, whole_time
from ..base.translation import told
from ..scatter.key_stores import frames
from ..scatter.object import solve_again
from .scene_snapshot import Looked, Present


def bake_reason(
    obj: bpy.types.Object, scene: bpy.types.Scene, present: Present, looked: Looked
) -> str:
    """The first of the reasons in words; empty when the bake fits."""
    reasons = (
        _key_reason(obj, present),
        _range_reason(obj, scene),
        _motion_reason(obj, scene, looked),
    )
    return next((solve_again(obj, reason) for reason in reasons if reason), "")


def _key_reason(obj: bpy.types.Object, present: Present) -> str:
    wrong = present.wrong_key(obj)
    return told("The keyframes are damaged: {wrong}", wrong=wrong) if wrong else ""


def _range_reason(obj: bpy.types.Object, scene: bpy.types.Scene) -> str:
    first = obj.dapple.baked_start
    last = first + obj.dapple.baked_frames - 1
    start, end = times_of(scene, scene.frame_start, scene.frame_end)
    if first <= start and end <= last:
        return ""
    return told(
        "Frames {first} to {last} are baked, the scene has {start} to {end}",
        first=first,
        last=last,
        start=start,
        end=end,
    )


def _motion_reason(obj: bpy.types.Object, scene: bpy.types.Scene, looked: Looked) -> str:
    frame = _baked_frame(obj, scene)
    if frame is None:
        return ""
    columns = frames(obj)
    stored = np.array([columns[f"dapple_sketch{k}"][frame] for k in range(3)], dtype=np.float64)
    if stored.any() or looked.bare:
        if obj.dapple.bound_to == "REST" and looked.vertices != columns["dapple_vertices"][frame]:
            return ""  # other faces of the same shape: vertices cannot be compared
        if not moved(stored, looked.sketched):
            return ""
    return told(
        "Surface '{surface}' moves differently than when it was baked (frame {frame})",
        surface=obj.dapple.surface.name,
        frame=whole_time(scene),
    )


def _baked_frame(obj: bpy.types.Object, scene: bpy.types.Scene) -> int | None:
    """Index of the time that is shown in the bake, if it is a whole one of it."""
    time = whole_time(scene)
    if time is None or not 0 <= time - obj.dapple.baked_start < obj.dapple.baked_frames:
        return None
    return time - obj.dapple.baked_start


def is_baked_bare(obj: bpy.types.Object, scene: bpy.types.Scene, looked: Looked) -> bool:
    """Whether a surface has no faces now as it had none in the bake."""
    baked = looked.bare and obj.dapple.baked_keys > 0
    return baked and looked.vertices in bound_vertices(obj, scene)


def bound_vertices(obj: bpy.types.Object, scene: bpy.types.Scene) -> list[int]:
    """Numbers of vertices that fit now: between two frames, that of either."""
    if not obj.dapple.baked_keys:
        return [obj.dapple.surface_vertices]
    table = frames(obj)["dapple_vertices"]
    if not len(table):
        raise ScatterError(f"Scatter '{obj.name}' has no baked frame: bake again")
    time = time_of(scene) - obj.dapple.baked_start
    around = np.clip([np.floor(time), np.ceil(time)], 0, len(table) - 1).astype(int)
    return [int(count) for count in table[around]]
