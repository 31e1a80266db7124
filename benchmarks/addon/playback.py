# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of one scene with and without its scatters, in turns."""

from __future__ import annotations

import time
from collections.abc import Callable

import bpy
import numpy as np

from addon.blender.surface.surface_mesh import read_surface
from benchmarks.bake.made_up import add_bake, add_scatter

_FRAMES = range(2, 10)


def measure_playback(sites: int, rounds: int) -> dict[str, float]:
    """Median seconds of a frame: nothing on the surface, nothing but its normals read, scatters.

    The surface is a sphere that a shape key swells. "between keys" plays a bake half a frame on,
    where two keys are mixed; whole frames look at one.
    """
    surface = _swelling_sphere(_FRAMES.stop)
    arrays = read_surface(surface, bpy.context.evaluated_depsgraph_get())
    bound, baked = (add_scatter(surface, arrays, sites) for _ in range(2))
    add_bake(baked, arrays, sites, _FRAMES.stop, 0.5)
    cases: dict[str, tuple[bpy.types.Object | None, float, Callable[[], object]]] = {
        "alone": (None, 0.0, lambda: None),
        "its normals": (None, 0.0, lambda: _normals(surface)),
        "bound": (bound, 0.0, lambda: None),
        "baked": (baked, 0.0, lambda: None),
        "baked, between keys": (baked, 0.5, lambda: None),
    }
    taken: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(rounds):
        for name, (shown, part, read) in cases.items():
            for scatter in (bound, baked):
                scatter.modifiers[0].show_viewport = scatter == shown
            _frame(1, part, read)
            taken[name] += [_frame(frame, part, read) for frame in _FRAMES]
    return {name: float(np.median(times)) for name, times in taken.items()}


def _frame(frame: int, part: float, read: Callable[[], object]) -> float:
    begin = time.perf_counter()
    bpy.context.scene.frame_set(frame, subframe=part)
    read()
    return time.perf_counter() - begin


def _normals(surface: bpy.types.Object) -> object:
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return evaluated.data.vertex_normals[0].vector


def _swelling_sphere(frames: int) -> bpy.types.Object:
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=7)
    surface = bpy.context.object
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Swollen")
    places = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", places)
    key.data.foreach_set("co", 1.2 * places)
    for frame, value in ((1, 0.0), (frames, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    return surface
