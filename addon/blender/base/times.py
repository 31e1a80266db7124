# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of the scene and times of the animation: Time Stretching maps the one to the other.

Animation, and the nodes that play a bake, know times only; so keys are baked at whole times.
"""

import math

import bpy

_WHOLE = 1e-3  # so far from a whole time is one: frames are stored in single precision


def time_of(scene: bpy.types.Scene) -> float:
    """Time that the scene shows now."""
    return float(scene.frame_current_final)


def whole_time(scene: bpy.types.Scene) -> int | None:
    """The same where it is a whole one."""
    time = time_of(scene)
    return round(time) if abs(time - round(time)) <= _WHOLE else None


def show_time(scene: bpy.types.Scene, time: float) -> None:
    """Go to a time."""
    frame = time / _stretch(scene)
    if _stretch(scene) != 1.0 and abs(frame - round(frame)) < _WHOLE:
        frame = round(frame)
    whole = math.floor(frame)
    scene.frame_set(whole, subframe=frame - whole)


def times_of(scene: bpy.types.Scene, first: int, last: int) -> tuple[int, int]:
    """Whole times that hold these frames."""
    stretch = _stretch(scene)
    if stretch == 1.0:
        return first, last
    return math.floor(first * stretch + _WHOLE), math.ceil(last * stretch - _WHOLE)


def _stretch(scene: bpy.types.Scene) -> float:
    """Time from one frame to the next."""
    return float(scene.render.frame_map_old / scene.render.frame_map_new)
