# SPDX-License-Identifier: GPL-3.0-or-later
"""Shots to bake: balls that are bent more and more, with a scatter on each."""

from __future__ import annotations

import hashlib
from pathlib import Path

import bpy
import numpy as np

import addon
from addon.blender.scatter.key_stores import read_baked

_BEND = 1.5  # radians, in the last frame


def make(folder: Path, shots: int, frames: int, sites: int) -> list[Path]:
    """Saved files of so many shots."""
    addon.register()
    folder.mkdir()
    paths = [folder / f"shot_{seed}.blend" for seed in range(shots)]
    for seed, path in enumerate(paths):
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, frames
        _bent_ball(frames)
        bpy.ops.dapple.add_scatter(count=sites, seed=seed)
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return paths


def _bent_ball(frames: int) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=128, ring_count=64)
    obj = bpy.context.object
    obj.scale.z = 2.0
    bend = obj.modifiers.new("Bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.deform_axis = "BEND", "X"
    for frame, angle in ((1, 0.0), (frames, _BEND)):
        bend.angle = angle
        bend.keyframe_insert("angle", frame=frame)
    bpy.context.scene.frame_set(1)


def digest(paths: list[Path]) -> str:
    """Of the keys of the bakes in files."""
    found = hashlib.blake2b(digest_size=6)
    for path in (path for path in paths if path.suffix == ".blend"):
        bpy.ops.wm.open_mainfile(filepath=str(path))
        (obj,) = (obj for obj in bpy.context.scene.objects if obj.dapple.baked_keys)
        stored = read_baked(obj)
        for columns in (stored.keys, stored.triangles, stored.frames):
            for name in sorted(columns):
                found.update(np.ascontiguousarray(columns[name]).tobytes())
    return found.hexdigest()
