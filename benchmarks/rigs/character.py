# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigged character: imported, its parts remeshed, its actions played."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from addon.blender.base.mesh_arrays import corner_vertices, read_points, to_world, triangle_corners
from addon.blender.remesh.density import Chosen
from addon.blender.remesh.operators import remesh_steps
from addon.core.base.steps import run_now
from benchmarks.remesh.measure import farthest

Mesh = tuple[NDArray[Any], NDArray[Any]]
FEATURE_ANGLE = 30.0  # degrees, the operator's own
WHOLE = 0.99  # sum of weights


@dataclass(frozen=True)
class Part:
    """An object of the character beside its remeshed copy."""

    old: bpy.types.Object
    new: bpy.types.Object
    share: float  # of the triangles
    lost: int  # creases and seams
    seconds: float


@dataclass
class Far:
    """Largest distances over all frames."""

    there: float = 0.0  # of the new surface from the old one
    back: float = 0.0  # of the old surface from the new one
    where: str = ""

    @property
    def most(self) -> float:
        return max(self.there, self.back)


def imported(path: Path) -> tuple[bpy.types.Object, list[bpy.types.Object]]:
    """The armature of a .glb file, and the meshes below it."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    meshes = [obj for obj in rig.children_recursive if obj.type == "MESH"]
    return rig, sorted(meshes, key=lambda obj: obj.name)


def all_actions() -> list[str]:
    """The actions of the file, by name."""
    return sorted(action.name for action in bpy.data.actions)


def show(rig: bpy.types.Object, action: str, share: float = 0.5) -> None:
    """Show the frame of an action at a share of its length."""
    for track in rig.animation_data.nla_tracks:
        track.mute = True
    rig.animation_data.action = bpy.data.actions[action]
    if hasattr(rig.animation_data, "action_slot") and not rig.animation_data.action_slot:
        rig.animation_data.action_slot = rig.animation_data.action_suitable_slots[0]
    first, last = bpy.data.actions[action].frame_range
    bpy.context.scene.frame_set(round(first + share * (last - first)))


def remeshed(obj: bpy.types.Object, share: float, max_distance: float) -> Part:
    """A copy of an object with about so many times its triangles: of a closed mesh, twice as many
    as vertices.
    """
    new = obj.copy()
    new.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(new)
    count = max(4, round(0.5 * share * len(triangle_corners(obj.data))))
    begin = time.perf_counter()
    options = {"feature_angle": FEATURE_ANGLE, "max_distance": max_distance}
    report = run_now(remesh_steps(new, count, Chosen(), options)).report
    return Part(obj, new, share, report.dropped_lines, time.perf_counter() - begin)


def played(
    rig: bpy.types.Object, parts: Sequence[Part], actions: Sequence[str], frames: int
) -> list[Far]:
    """The largest distances of each part over the frames of actions."""
    found = [Far() for _ in parts]
    for action in actions:
        first, last = bpy.data.actions[action].frame_range
        count = max(2, min(frames, round(last - first) + 1))
        for k in range(count):
            show(rig, action, k / (count - 1))
            where = f"{action} {bpy.context.scene.frame_current}"
            for part, far in zip(parts, found, strict=True):
                _note(part, where, far)
    return found


def _note(part: Part, where: str, far: Far) -> None:
    old, new = world_mesh(part.old), world_mesh(part.new)
    there, back = farthest(new, old), farthest(old, new)
    if max(there, back) > far.most:
        far.where = where
    far.there, far.back = max(there, far.there), max(back, far.back)


def world_mesh(obj: bpy.types.Object) -> Mesh:
    """Vertices (v, 3) in world space and triangles (t, 3) as they are shown now."""
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = shown.to_mesh()
    corners = triangle_corners(mesh)
    found = to_world(shown, read_points(mesh)), corner_vertices(mesh)[corners]
    shown.to_mesh_clear()
    return found


def grouped(obj: bpy.types.Object) -> float:
    """Share of the vertices whose weights add up to 1."""
    sums = [sum(one.weight for one in vertex.groups) for vertex in obj.data.vertices]
    return float((np.array(sums) > WHOLE).mean())
