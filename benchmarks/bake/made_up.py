# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters and bakes that are made up, not solved, so that any number of sites takes seconds."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np

from addon.blender.scatter.key_writing import write_baked
from addon.blender.scatter.store import new_scatter, write_scattered
from addon.core.bake.keys import Keyframes
from addon.core.solve.solve import Report, Scattered, point_columns
from addon.core.surface.arrays import SurfaceArrays
from addon.core.surface.binding import attached_to
from addon.core.surface.records import Placed


def add_scatter(
    surface: bpy.types.Object, arrays: SurfaceArrays, sites: int, in_order: bool = False
) -> bpy.types.Object:
    """A scatter with sites anywhere on a surface, perhaps in the order of its faces."""
    faces, weights = _places(arrays, sites, in_order)
    binding = attached_to(arrays, faces, weights)
    ids = np.arange(sites, dtype=np.int32)
    columns = point_columns(ids, np.zeros_like(ids), seed=0)
    positions = binding.positions(arrays.vertices)
    scatter = new_scatter(surface, bpy.context.scene.collection)
    report = Report(count=sites, spacing=0.01)
    write_scattered(scatter, arrays, Scattered(positions, binding, columns, report))
    return scatter


def _places(arrays: SurfaceArrays, sites: int, in_order: bool) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.Generator(np.random.PCG64(0))
    faces = random.integers(0, len(arrays.faces), sites).astype(np.int32)
    if in_order:
        faces.sort()
    return faces, random.dirichlet((1.0, 1.0, 1.0), sites)


def add_bake(
    scatter: bpy.types.Object,
    arrays: SurfaceArrays,
    sites: int,
    frames: int,
    moving: float,
    in_order: bool = False,
) -> None:
    """Keys of a scatter: in each frame a share of the sites slides, a tenth to other faces."""
    random = np.random.Generator(np.random.PCG64(1))
    faces, weights = _places(arrays, sites, in_order)
    carry = np.zeros(sites)
    keyframes = Keyframes(frames)
    for _ in range(frames):
        slides = random.random(sites) < moving
        weights[slides] = np.abs(weights[slides] + random.normal(0.0, 0.03, (slides.sum(), 3)))
        weights /= weights.sum(axis=1, keepdims=True)
        leaving = slides & (random.random(sites) < 0.1)
        faces[leaving] = (faces[leaving] + 1) % len(arrays.faces)
        carry[leaving] += random.normal(0.0, 0.3, leaving.sum())
        binding = replace(attached_to(arrays, faces, weights.copy()), angle=carry.copy())
        keyframes.add(Placed(faces.copy(), binding), arrays, arrays, 0.01)
    write_baked(scatter, keyframes.packed(), 1, Report(count=sites, spacing=0.01))
