# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs on things that move."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import bpy
import dapple3d as dapple
import numpy as np

from benchmarks.everyday import scenes
from benchmarks.everyday.judged import (
    Found,
    Job,
    measured,
    overlap,
    points,
    surface_now,
    worst,
)

COUNT = 600
Forbidden = Callable[[np.ndarray, int], np.ndarray]


def baked(obj: Any) -> float:
    """Seconds that Bake takes."""
    scenes.active(obj)
    begin = time.perf_counter()
    bpy.ops.dapple.bake()
    return time.perf_counter() - begin


def frames() -> range:
    return range(1, scenes.FRAMES + 1)


def watched(
    obj: Any, surface: Any, *, even: bool = True, forbidden: Forbidden | None = None
) -> Found:
    """All frames, played."""
    found = []
    for frame in frames():
        bpy.context.scene.frame_set(frame)
        places = points(obj)[0]
        one = measured(surface_now(surface), places, even=even)
        if forbidden is not None:
            one = replace(one, inside=int(np.count_nonzero(forbidden(places, frame))))
            one = replace(one, between=_later(obj, frame, forbidden))
        found.append(one)
    return worst(found)


def _later(obj: Any, frame: int, forbidden: Forbidden) -> int:
    """How many points are where there must be none, half a frame later."""
    if frame == scenes.FRAMES:
        return 0
    bpy.context.scene.frame_set(frame, subframe=0.5)
    return int(np.count_nonzero(forbidden(points(obj)[0], frame)))


def bending(**settings: Any) -> Callable[[], Found]:
    def run() -> Found:
        surface = scenes.body()
        obj = scenes.scatter(surface, COUNT)
        for name, value in settings.items():
            setattr(obj.dapple, name, value)
        seconds = baked(obj)
        return replace(watched(obj, surface), seconds=seconds)

    return run


def painted() -> Found:
    surface = scenes.body()
    obj = scenes.scatter(surface, COUNT)
    obj.dapple.density.attribute = "tip"
    bpy.ops.dapple.optimize()
    seconds = baked(obj)
    return replace(watched(obj, surface, even=False), seconds=seconds)


def between_frames() -> Found:
    surface = scenes.body()
    obj = scenes.scatter(surface, COUNT)
    seconds = baked(obj)
    found = []
    for frame in list(frames())[:-1:4]:
        bpy.context.scene.frame_set(frame, subframe=0.5)
        found.append(measured(surface_now(surface), points(obj)[0], even=False))
    return replace(worst(found), seconds=seconds)


def shape_keys() -> Found:
    surface = scenes.body()
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 1.5
    for frame, value in ((1, 0.0), (scenes.FRAMES, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_set(1)
    obj = scenes.scatter(surface, COUNT)
    seconds = baked(obj)
    return replace(watched(obj, surface), seconds=seconds)


def mixed() -> Found:
    surface = scenes.body()
    obj = scenes.scatter(surface, COUNT)
    scenes.add_types(obj, (30, 0.16), (120, 0.06), (0, 0.0))
    bpy.ops.dapple.optimize()
    seconds = baked(obj)
    found = []
    for frame in frames():
        bpy.context.scene.frame_set(frame)
        places, names = points(obj)
        found.append(Found(overlap=overlap(places, scenes.radii_of(obj, names))))
    return replace(worst(found), seconds=seconds)


def fitted() -> Found:
    surface = scenes.body()
    obj = scenes.scatter(surface, COUNT)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.0, location=(9, 9, 9))
    obj.dapple.instance = bpy.context.object
    obj.dapple.fit_to_spacing = 1.0
    seconds = baked(obj)
    largest = 0.0
    for frame in frames():
        bpy.context.scene.frame_set(frame)
        matrices = [
            np.array(one.matrix_world)
            for one in bpy.context.evaluated_depsgraph_get().object_instances
            if one.is_instance and one.parent.original == obj
        ]
        places = np.array([one[:3, 3] for one in matrices])
        radii = np.array([np.linalg.norm(one[:3, 0]) for one in matrices])
        largest = max(largest, overlap(places, radii))
    return Found(seconds=seconds, overlap=largest)


def on_ground(change: Callable[[Any, Any], Forbidden], **settings: Any) -> Callable[[], Found]:
    """A ground that stands still, and a density that moves."""

    def run() -> Found:
        surface = scenes.grid(60)
        obj = scenes.scatter(surface, COUNT)
        for name, value in settings.items():
            setattr(obj.dapple, name, value)
        forbidden = change(obj, surface)
        scenes.active(obj)
        bpy.context.scene.frame_set(1)
        bpy.ops.dapple.optimize()
        seconds = baked(obj)
        found = watched(obj, surface, even=False, forbidden=forbidden)
        return replace(found, seconds=seconds, alpha=obj.dapple.report.alpha_min)

    return run


def wandering_cube(obj: Any, _surface: Any) -> Forbidden:
    thing = scenes.moving(
        scenes.cube(0.6, (0, 0, 0)), (1, (-0.5, 0.0, 0.0)), (scenes.FRAMES, (0.5, 0.2, 0.0))
    )
    obj.dapple.density.avoid_collection = scenes.collection_of(thing)
    obj.dapple.density.avoid_margin = 0.0
    rounded = 0.001 * 2.0 / np.sqrt(COUNT)

    def inside(places: np.ndarray, _frame: int) -> np.ndarray:
        middle = np.array(thing.matrix_world.translation)[:2]
        return (np.abs(places[:, :2] - middle) < 0.3 - rounded).all(axis=1)

    return inside


def wandering_camera(obj: Any, _surface: Any) -> Forbidden:
    bpy.ops.object.camera_add(location=(0.0, 0.0, 1.5))
    camera = bpy.context.object
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1.0
    render = bpy.context.scene.render
    render.resolution_x = render.resolution_y = 512
    bpy.context.scene.camera = camera
    scenes.moving(camera, (1, (-0.3, 0.0, 1.5)), (scenes.FRAMES, (0.3, 0.0, 1.5)))
    obj.dapple.density.use_camera_view, obj.dapple.density.camera_margin = True, 0.0

    def outside(places: np.ndarray, _frame: int) -> np.ndarray:
        middle = np.array(camera.matrix_world.translation)[:2]
        return np.abs(places[:, :2] - middle).max(axis=1) > 0.5 + 0.02

    return outside


def animated_attribute(obj: Any, surface: Any) -> Forbidden:
    modifier = surface.modifiers.new("Above", "NODES")
    modifier.node_group = scenes.threshold_group(-0.5, 0.02)
    obj.dapple.density.attribute = "Above"

    def below(places: np.ndarray, frame: int) -> np.ndarray:
        cell = 2.0 / 60
        return places[:, 0] < -0.5 + 0.02 * frame - cell - 1e-3

    return below


def beside_another(obj: Any, surface: Any) -> Forbidden:
    body = scenes.moving(
        scenes.cube(0.5, (0, 0, 0)), (1, (-0.4, 0.0, 0.0)), (scenes.FRAMES, (0.4, 0.0, 0.0))
    )
    other = scenes.scatter(body, 80)
    obj.dapple.density.avoid_collection = scenes.collection_of(other)
    obj.dapple.density.avoid_margin = 0.05
    return lambda places, _frame: (
        np.min(np.linalg.norm(places[:, None] - points(other)[0][None], axis=2), axis=1)
        < 0.05 - 1e-3
    )


def crossing(make: Callable[[], Any], **limits: Any) -> Callable[[], Found]:
    """New Topology: Reattach; evenness from the fifth frame after the first on."""

    def run() -> Found:
        surface = make()
        obj = scenes.scatter(surface, COUNT)
        obj.dapple.new_topology = "REATTACH"
        seconds = baked(obj)
        found = []
        for frame in list(frames())[5:]:
            bpy.context.scene.frame_set(frame)
            found.append(measured(surface_now(surface), points(obj)[0]))
        return replace(worst(found), seconds=seconds)

    return run


def remeshed() -> Any:
    surface = scenes.body()
    modifier = surface.modifiers.new("Remesh", "REMESH")
    modifier.mode, modifier.voxel_size = "VOXEL", 0.12
    return surface


def cut() -> Any:
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5)
    tool = scenes.moving(
        bpy.context.object, (1, (-0.6, 0.0, 0.8)), (scenes.FRAMES, (0.6, 0.0, 0.8))
    )
    tool.hide_render = True
    tool.display_type = "WIRE"
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.0, segments=48, ring_count=24)
    surface = bpy.context.object
    modifier = surface.modifiers.new("Boolean", "BOOLEAN")
    modifier.object, modifier.operation = tool, "DIFFERENCE"
    return surface


def built() -> Any:
    surface = scenes.grid(40)
    modifier = surface.modifiers.new("Build", "BUILD")
    modifier.frame_start, modifier.frame_duration = -scenes.FRAMES, 3.0 * scenes.FRAMES
    return surface


def tiled() -> Found:
    surface = scenes.body()
    obj = scenes.scatter(surface, 150)
    bpy.ops.dapple.make_tiles()
    tiles = next(
        each
        for each in bpy.data.objects
        if each not in (obj, surface) and each.parent in (surface, obj)
    )
    off = []
    for frame in (1, scenes.FRAMES // 2, scenes.FRAMES):
        bpy.context.scene.frame_set(frame)
        now, corners = surface_now(surface), surface_now(tiles).vertices
        there = dapple.project(now, corners).positions
        off.append(float(np.linalg.norm(there - corners, axis=1).max()) / now.spacing(150))
    return Found(wrong="" if max(off) < 0.3 else f"tiles {max(off):.1f} spacings off")


def turning() -> Found:
    surface = scenes.body()
    obj = scenes.scatter(surface, COUNT)
    obj.dapple.forward, obj.dapple.random_turn = "Z", 0.0
    seconds = baked(obj)
    last, fastest = None, 0.0
    for frame in frames():
        bpy.context.scene.frame_set(frame)
        shown = np.array(
            [
                np.array(one.matrix_world)[:3, 0]
                for one in bpy.context.evaluated_depsgraph_get().object_instances
                if one.is_instance and one.parent.original == obj
            ]
        )
        shown /= np.linalg.norm(shown, axis=1, keepdims=True)
        if last is not None:
            angles = np.degrees(np.arccos(np.clip((shown * last).sum(axis=1), -1.0, 1.0)))
            fastest = max(fastest, float(angles.max()))
        last = shown
    return Found(
        seconds=seconds, wrong="" if fastest < 60.0 else f"turned by {fastest:.0f} degrees"
    )


BAKES = (
    Job("a bake", bending()),
    Job("a bake with a painted group", painted, "a bake", 2.0),
    Job("a loop", bending(smoothing="LOOP"), "a bake", 4.0),
    Job("smooth both ways", bending(smoothing="BOTH_WAYS"), "a bake", 4.0),
    Job(
        "keep density",
        bending(population="KEEP_DENSITY"),
        "a bake",
        2.0,
        variation=0.3,  # of those that do not fade: these leave gaps
    ),
    Job(
        "a key every 5 frames",
        bending(keyframe_step=5),
        "a bake",
        2.0,
        variation=0.05,
        alpha=0.4,
        off=0.15,
    ),
    Job("stickiness", bending(stickiness=1.0), "a bake", 2.0, variation=0.08),
    Job("between frames", between_frames, off=0.1),
    Job("shape keys, armature, subdivision", shape_keys, "a bake", 2.0),
    Job("a bake of three types", mixed, "a bake", 5.0),
    Job("Fit to Spacing 1", fitted, "a bake", 2.0),
    Job("a still ground", on_ground(lambda *_: lambda places, _frame: np.zeros(len(places), bool))),
    Job("off a moving cube", on_ground(wandering_cube), "a bake", 3.0),
    Job(
        "off a moving cube, keep density",
        on_ground(wandering_cube, population="KEEP_DENSITY"),
        "a bake",
        3.0,
    ),
    Job("in a moving camera's view", on_ground(wandering_camera), "a bake", 3.0),
    Job("an animated attribute", on_ground(animated_attribute), "a bake", 2.5),
    Job("off another scatter that moves", on_ground(beside_another), "a bake", 3.0),
    Job("remesh after bending", crossing(remeshed), variation=0.05),
    Job("a moving Boolean", crossing(cut), variation=0.05),
    Job("Build", crossing(built), variation=0.05),
    Job("tiles on a moving body", tiled),
    Job("a forward axis", turning),
)
