# SPDX-License-Identifier: GPL-3.0-or-later
"""Scales on a newt that walks: they lie from head to tail, and stay even while it winds.

Run through `blend_examples/run.sh scales`, which sets everything up.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import bpy
import numpy as np

from blend_examples import newt, studio
from blend_examples.creature import render, select
from blend_examples.scene import begin, finish, hidden, mesh_object, options, run, scatter
from blend_examples.sheet import contact_sheet

FRAMES = 24  # of one cycle, which ends as it began
KEYS = 8  # poses of the cycle
STRIDE = 1.1
COLORS = [
    (0.62, (0.10, 0.34, 0.20)),
    (0.90, (0.22, 0.46, 0.16)),
    (1.00, (0.62, 0.52, 0.12)),
]
# Yaw in degrees of the bones of the spine, and how late the wave is there, in parts of a cycle.
WAVE = {
    "chest": (14.0, 0.05),
    "head": (-10.0, 0.0),
    "hips": (-10.0, 0.25),
    "tail.1": (16.0, 0.40),
    "tail.2": (22.0, 0.55),
    "tail.3": (26.0, 0.70),
    "tail.4": (26.0, 0.85),
}
SWING, LIFT = 30.0, 16.0  # of the legs, in degrees


def walk(armature: bpy.types.Object) -> None:
    """A wave along the spine; diagonal pairs of legs take turns."""
    for key in range(KEYS + 1):
        part, frame = key / KEYS, 1 + FRAMES * key / KEYS
        armature.location.x = STRIDE * (part - 0.5)
        armature.keyframe_insert("location", frame=frame)
        for name, (yaw, late) in WAVE.items():
            turn(armature, name, 0.0, yaw * math.sin(2 * math.pi * (part - late)), frame)
        for name, (_, side, _) in newt.LEGS.items():
            shift = 0.0 if name in ("leg.fore.L", "leg.hind.R") else 0.5
            swing = SWING * side * math.sin(2 * math.pi * (part + shift))
            lift = LIFT * max(0.0, math.cos(2 * math.pi * (part + shift)))
            turn(armature, name, lift, swing, frame)


def turn(armature: bpy.types.Object, name: str, pitch: float, yaw: float, frame: float) -> None:
    bone = armature.pose.bones[name]
    bone.rotation_euler = (math.radians(pitch), 0.0, math.radians(yaw))
    bone.keyframe_insert("rotation_euler", frame=frame)


def scale() -> bpy.types.Object:
    """A domed plate with its tip at +x, raised over the next one; about 1 long either way."""
    turns = np.linspace(0.0, 2.0 * np.pi, 20, endpoint=False)
    wide, long = np.sin(turns), np.cos(turns)
    x = np.where(long > 0.0, 1.15 * np.abs(long) ** 1.6, 0.75 * long)
    outline = np.column_stack([x, 0.78 * wide, 0.0 * x])
    inner = outline * [0.55, 0.55, 1.0] + [0.05, 0.0, 0.16]
    vertices = np.vstack([outline, inner, [(0.05, 0.0, 0.2)]])
    vertices[:, 2] += 0.16 * (vertices[:, 0] + 0.75)
    count = len(turns)
    faces: list[tuple[int, ...]] = []
    for k in range(count):
        after = (k + 1) % count
        faces += [(k, after, count + after, count + k), (count + k, count + after, 2 * count)]
    made = mesh_object("Scale", vertices, faces)
    made.data.materials.append(
        studio.color_by_chance("Scale", "id", "INSTANCER", COLORS, roughness=0.35)
    )
    return hidden(made)


def build(count: int, seed: int) -> bpy.types.Object:
    """The newt with its scales; the scatter."""
    armature = newt.build_armature()
    body = newt.build_body(armature)
    body.data.materials.append(studio.material("Skin", (0.03, 0.05, 0.02), 0.6))
    newt.build_eyes(armature, studio.eye_materials())
    walk(armature)
    bpy.context.scene.frame_set(1)
    thing = scale()
    made = scatter(body, count, seed)
    made.dapple.quality = "REGULAR"
    made.dapple.forward, made.dapple.random_turn = "-X", 0.06
    made.dapple.instance, made.dapple.scale = thing, 0.78 * made.dapple.report.spacing
    bpy.ops.dapple.optimize()
    select(made)
    bpy.ops.dapple.bake()
    return made


def main() -> None:
    given = options(__doc__, 1500, "scales").parse_args()
    begin()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 1 + FRAMES
    made = build(given.count, given.seed)
    width = given.width
    studio.build_studio(max(width, 1), max(width * 5 // 8, 1))
    scene.frame_set(1)
    report = made.dapple.report
    said = (
        f"{given.count} scales, {FRAMES + 1} frames, area variation {report.capacity_variation:.3f}"
    )
    given.width = 0  # the picture is of several frames
    finish("scales", given, said)
    if width:
        with tempfile.TemporaryDirectory() as folder:
            pictures = render(range(1, 1 + FRAMES), Path(folder))
            caption = f"{given.count} scales on a walking newt"
            contact_sheet(pictures, caption, given.out / "scales.png")


if __name__ == "__main__":
    run(main)
