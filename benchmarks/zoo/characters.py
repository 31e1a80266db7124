# SPDX-License-Identifier: GPL-3.0-or-later
"""Characters as artists hand them over: scattered over, baked through two actions, and drawn.

The files are not part of the project. Each is imported, points go on its skinned parts as one
surface, and every action is baked by the defaults. Judged are how even the points are, how far
instances stand from the shading normals on the first frame, what share of them leans by more than 5
degrees later, having crossed an edge, and how far any turns in a frame beside its neighbors.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector
from mathutils.kdtree import KDTree

import addon
from benchmarks.compare.tables import say, table
from benchmarks.zoo.standing import degrees_off

_HEAD = (
    "character",
    "action",
    "variation",
    "alpha min",
    "degrees off",
    "leaning",
    "turn",
    "s",
    "goals",
)
_ACTIONS = ("Running_A", "Jump_Full_Long")
_POINTS = 1500
_VARIATION, _UPRIGHT, _TURN = 0.04, 0.5, 60.0
_LEANING, _SHARE = 5.0, 0.1  # degrees, and of the instances
_NEIGHBORS = 6


def main() -> None:
    options = _options()
    options.output.mkdir(parents=True, exist_ok=True)
    files = sorted(options.folder.glob("*.glb"))
    if not files:
        raise SystemExit(f"{options.folder} holds no .glb: name a folder that does")
    addon.register()
    try:
        found = [
            measured(file, action, options.frames, options.output)
            for file in files
            for action in _ACTIONS
        ]
    finally:
        addon.unregister()
    print(table(_HEAD, [_row(one) for one in found]))
    print(f"\npictures: {options.output}")


def _options() -> argparse.Namespace:
    data = Path(os.environ.get("DAPPLE_DATA") or Path.cwd().parent / "shared" / "data")
    parser = argparse.ArgumentParser(prog="benchmarks/zoo/run.sh --characters", description=__doc__)
    parser.add_argument("--folder", type=Path, default=data / "assets", help="of .glb files")
    parser.add_argument("--frames", type=int, default=24, help="of each action, at most")
    parser.add_argument("--output", type=Path, default=Path("build/zoo"), help="for the pictures")
    return parser.parse_args()


def measured(file: Path, action: str, frames: int, output: Path) -> dict[str, Any]:
    """The figures of one character through one action."""
    say(f"{file.stem}, {action}")
    scene = _imported(file, action, frames)
    bpy.ops.dapple.add_scatter(count=_POINTS)
    scatter = bpy.context.object
    surface = scatter.dapple.surface
    bpy.ops.dapple.bake()
    report = scatter.dapple.report
    scene.frame_set(scene.frame_start)
    off = float(degrees_off(scatter, surface).max())
    leaning, turn, before = 0.0, 0.0, None
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        here = _matrices(scatter)
        if before is not None:
            turn = max(turn, _turn_beside_neighbors(before, here))
        if frame % 4 == 0:
            leaning = max(leaning, float((degrees_off(scatter, surface) > _LEANING).mean()))
        before = here
    scene.frame_set((scene.frame_start + scene.frame_end) // 2)
    _draw(output / f"{file.stem}-{action}.png")
    return {
        "names": (file.stem, action),
        "variation": report.capacity_variation,
        "alpha_min": report.alpha_min,
        "degrees_off": off,
        "leaning": leaning,
        "turn": turn,
        "seconds": report.milliseconds / 1000,
    }


def _imported(file: Path, action: str, frames: int) -> bpy.types.Scene:
    """A scene with the character in that action, its skinned parts selected."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(file))
    scene = bpy.context.scene
    rig = next(obj for obj in bpy.data.objects if obj.type == "ARMATURE")
    rig.animation_data.action = bpy.data.actions[action]
    if hasattr(rig.animation_data, "action_slot") and not rig.animation_data.action_slot:
        rig.animation_data.action_slot = rig.animation_data.action_suitable_slots[0]
    for track in rig.animation_data.nla_tracks:
        track.mute = True
    first, last = bpy.data.actions[action].frame_range
    scene.frame_start, scene.frame_end = int(first), int(min(last, first + frames - 1))
    scene.frame_set(scene.frame_start)
    for obj in bpy.data.objects:
        skinned = any(modifier.type == "ARMATURE" for modifier in obj.modifiers)
        obj.select_set(skinned)
        if skinned:
            bpy.context.view_layer.objects.active = obj
        elif obj.type == "MESH":
            obj.hide_render = True
    return scene


def _matrices(scatter: bpy.types.Object) -> np.ndarray:
    """Axes and places (n, 4, 4) of the instances, in the order of the points."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return np.array(
        [
            np.array(instance.matrix_world)
            for instance in depsgraph.object_instances
            if instance.is_instance and instance.parent.original == scatter
        ]
    )


def _turn_beside_neighbors(before: np.ndarray, after: np.ndarray) -> float:
    """Largest turn in degrees, less the middle one of the nearest neighbors' turns."""
    a, b = (_rotations(matrices) for matrices in (before, after))
    trace = np.einsum("nij,nij->n", a, b)
    turns = np.degrees(np.arccos(np.clip(0.5 * (trace - 1.0), -1.0, 1.0)))
    tree = KDTree(len(after))
    for k, matrix in enumerate(after):
        tree.insert(Vector(matrix[:3, 3]), k)
    tree.balance()
    beside = [
        np.median([turns[j] for _, j, _ in tree.find_n(Vector(matrix[:3, 3]), _NEIGHBORS + 1)])
        for matrix in after
    ]
    return float((turns - beside).max())


def _rotations(matrices: np.ndarray) -> np.ndarray:
    axes = matrices[:, :3, :3]
    return axes / np.linalg.norm(axes, axis=1, keepdims=True)


def _draw(path: Path) -> None:
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location, camera.rotation_euler = (3.0, -4.6, 2.2), (1.37, 0.0, 0.58)
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.display.shading.light = "STUDIO"
    scene.display.shading.show_cavity = True
    scene.render.resolution_x, scene.render.resolution_y = 900, 900
    scene.render.filepath = str(path.resolve())
    bpy.ops.render.render(write_still=True)


def _row(one: dict[str, Any]) -> list[str]:
    missed = [
        name
        for name, holds in (
            (f"variation {_VARIATION}", one["variation"] <= _VARIATION),
            (f"{_UPRIGHT} degrees", one["degrees_off"] <= _UPRIGHT),
            (f"leaning {_SHARE}", one["leaning"] <= _SHARE),
            (f"turn {_TURN:.0f}", one["turn"] < _TURN),
        )
        if not holds
    ]
    return [
        *one["names"],
        *(f"{one[name]:.3f}" for name in ("variation", "alpha_min")),
        f"{one['degrees_off']:.2f}",
        f"{one['leaning']:.3f}",
        *(f"{one[name]:.1f}" for name in ("turn", "seconds")),
        "missed: " + ", ".join(missed) if missed else "met",
    ]


if __name__ == "__main__":
    main()
