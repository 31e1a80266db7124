# SPDX-License-Identifier: GPL-3.0-or-later
"""From the end of a brush stroke to settled points, by Auto Update, and where that time goes."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np

from addon.blender.base import activity
from addon.blender.solve import auto_update, optimize
from addon.core.base.steps import Stepper
from addon.core.solve import incremental
from addon.core.solve.relaxation import Relaxer

# Points, faces, object types, seconds that are the goal.
CASES = (
    (2_000, 25_000, 1, 0.15),
    (20_000, 100_000, 1, 0.5),
    (100_000, 100_000, 1, 1.0),
    (12_300, 500_000, 1, 0.5),
    (12_300, 500_000, 3, 0.5),
)
TYPES = ((300, 0.02), (2_000, 0.008), (10_000, 0.0))  # weights and radii on a surface of 2 x 2
_GROUP = "Density"
_RADIUS = 0.05  # of a stroke, on a surface of 2 x 2
_LIMIT = 600.0  # seconds
_EVENTS = 0.002  # seconds that Blender is presumed to take for events, between two calls of a timer


def measure_following(sites: int, faces: int, rounds: int, types: int = 1) -> dict[str, float]:
    """Median seconds from a stroke until points are shown and all is done, and of its parts."""
    surface = _surface(faces)
    scatter = _scatter(surface, sites, types)
    auto_update.enabled = True
    taken: dict[str, list[float]] = defaultdict(list)
    for number in range(rounds):
        for name, seconds in _stroke(surface, scatter, number).items():
            taken[name].append(seconds)
    auto_update.reset()
    auto_update.enabled = False
    return {name: float(np.median(values)) for name, values in taken.items()}


def _surface(faces: int) -> bpy.types.Object:
    side = round((faces / 2) ** 0.5)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side)
    surface = bpy.context.object
    group = surface.vertex_groups.new(name=_GROUP)
    group.add(range(len(surface.data.vertices)), 1.0, "REPLACE")
    return surface


def _scatter(surface: bpy.types.Object, sites: int, types: int) -> bpy.types.Object:
    bpy.ops.dapple.add_scatter(count=10)
    scatter = bpy.context.object
    scatter.dapple.auto_update_mode = "ON"
    scatter.dapple.amount, scatter.dapple.points_per_area = "PER_AREA", sites / 4.0
    scatter.dapple.density.attribute = _GROUP
    for weight, radius in TYPES[:types] if types > 1 else ():
        bpy.ops.dapple.edit_object_types(action="ADD")
        scatter.dapple.object_types[-1].weight, scatter.dapple.object_types[-1].radius = (
            weight,
            radius,
        )
    bpy.ops.dapple.optimize()
    return scatter


def _stroke(surface: bpy.types.Object, scatter: bpy.types.Object, number: int) -> dict[str, float]:
    """Paint a spot and wait; seconds from when the brush is lifted."""
    positions = np.empty(3 * len(surface.data.vertices), dtype=np.float32)
    surface.data.vertices.foreach_get("co", positions)
    middle = np.random.default_rng(number).uniform(-0.8, 0.8, 2)
    near = np.linalg.norm(positions.reshape(-1, 3)[:, :2] - middle, axis=1) < _RADIUS
    with _brush_on_surface():
        _look()
        surface.vertex_groups[_GROUP].add(np.flatnonzero(near).tolist(), 0.3, "REPLACE")
        surface.data.update()
        _look()
    surface.data.update()  # Blender tags it once more in the end
    with _parts() as parts:
        begin = time.perf_counter()
        before = scatter.dapple.solved_points
        while time.perf_counter() - begin < _LIMIT:
            wait = _look()
            if "points" not in parts and scatter.dapple.solved_points != before:
                parts["points"] = time.perf_counter() - begin
            if not auto_update.is_active() and "points" in parts:
                break
            time.sleep(min(wait or 0.0, _LIMIT) + _EVENTS)
        parts["all"] = time.perf_counter() - begin
    return dict(parts)


def _look() -> float | None:
    """What Blender does between two events; seconds until the timer is to be called again."""
    bpy.context.view_layer.update()
    return auto_update.tick()


@contextmanager
def _brush_on_surface() -> Iterator[None]:
    """A stroke, which a Blender without windows cannot paint."""
    real = activity.is_painting
    activity.is_painting = lambda: True
    try:
        yield
    finally:
        activity.is_painting = real


@contextmanager
def _parts() -> Iterator[dict[str, float]]:
    """Seconds of what an update calls, by what it is."""
    parts: dict[str, float] = {}
    timed: list[tuple[Any, str, str]] = [
        (incremental, "kept", "solving"),
        (incremental, "measured", "measuring"),
        (optimize, "sources_of", "comparing"),
        (optimize.Update, "write", "writing"),
        (Stepper, "run_for", "main thread"),
        (incremental, "masked_surface_of", "  surface"),
        (Relaxer, "relaxed", "  relaxing"),
        (incremental, "_scattered", "  columns"),
        (optimize, "previous_result", "reading points"),
    ]
    kept = [(owner, name, getattr(owner, name)) for owner, name, _ in timed]
    for owner, name, label in timed:
        setattr(owner, name, _timed(getattr(owner, name), label, parts))
    try:
        yield parts
    finally:
        for owner, name, call in kept:
            setattr(owner, name, call)


def _timed(call: Any, label: str, parts: dict[str, float]) -> Any:
    def timed(*arguments: Any, **named: Any) -> Any:
        begin = time.perf_counter()
        try:
            return call(*arguments, **named)
        finally:
            parts[label] = parts.get(label, 0.0) + time.perf_counter() - begin

    return timed
