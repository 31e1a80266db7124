# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of the scene and times of the animation, which differ under Time Stretching.

Animation and the nodes that play a bake use times, so keyframes are baked at whole times.
"""

import math

import bpy

from ...core.base.errors import ScatterError

_WHOLE = 1e-3  # tolerance of whole times: frames are stored in single precision


def time_of(scene: bpy.types.Scene) -> float:
    """The current time of a scene."""
    return float(scene.frame_current_final)


def whole_time(scene: bpy.types.Scene) -> int | None:
    """The same if it is a whole number, otherwise None."""
    time = time_of(scene)
    return round(time) if abs(time - round(time)) <= _WHOLE else None


def show_time(scene: bpy.types.Scene, time: float) -> None:
    """Make a time the current one."""
    frame = time / _stretch(scene)
    if _stretch(scene) != 1.0 and abs(frame - round(frame)) < _WHOLE:
        frame = round(frame)
    whole = math.floor(frame)
    scene.frame_set(whole, subframe=frame - whole)


def times_of(scene: bpy.types.Scene, first: int, last: int) -> tuple[int, int]:
    """The first and last whole time of a range that contains these frames."""
    stretch = _stretch(scene)
    if stretch == 1.0:
        return first, last
    return math.floor(first * stretch + _WHOLE), math.ceil(last * stretch - _WHOLE)


def chosen_times(scene: bpy.types.Scene, first: int, last: int) -> tuple[int, int]:
    """The same; ScatterError if there is none."""
    first, last = times_of(scene, first, last)
    if last < first:
        raise ScatterError(f"The frame range is empty: {first} to {last}")
    return first, last


def _stretch(scene: bpy.types.Scene) -> float:
    """Duration of a frame."""
    return float(scene.render.frame_map_old / scene.render.frame_map_new)
