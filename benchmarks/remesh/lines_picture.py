# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples along the lines of meshes, rendered by Blender: docs/images/lines.webp.

build/venv/bin/python benchmarks/remesh/lines_picture.py OUT.webp fandisk.ply lilium.ply
"""

import math
import sys
from pathlib import Path
from typing import Any

import bpy
import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from benchmarks.remesh.picture import STEP, material, render, set_scene, upright

RADIUS = 0.01
WAYS: tuple[tuple[int, int, dict[str, Any]], ...] = (
    (0, 220, {"corners": True}),
    (0, 220, {"line_spacing": "natural"}),
    (1, 90, {}),
)
SAMPLES = 24
YAW = (30.0, 0.0)


def add_body(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> None:
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    mesh.materials.append(material("Body", (0.25, 0.25, 0.25)))
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Body", mesh))


def add_balls(positions: NDArray[np.float64]) -> None:
    bpy.ops.mesh.primitive_ico_sphere_add(radius=RADIUS, subdivisions=2)
    mesh = bpy.context.object.data
    mesh.materials.append(material("Balls", (0.0, 0.0, 0.0)))
    shader = mesh.materials[0].node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.8, 0.08, 0.02, 1.0)
    for at in positions:
        ball = bpy.data.objects.new("Ball", mesh)
        ball.location = at
        bpy.context.scene.collection.objects.link(ball)
    bpy.data.objects.remove(bpy.context.object)


def main(out: str, *paths: str) -> None:
    """
    Args:
        out: the picture, as WebP.
        paths: a mesh with creases, and one with a border.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for k, (which, count, options) in enumerate(WAYS):
        mesh = dapple.read_mesh(paths[which])
        found = dapple.sample_lines(
            dapple.Surface(mesh.vertices, mesh.faces), count, **options
        ).samples
        both = upright(
            np.concatenate([mesh.vertices, found.positions]), math.radians(YAW[which])
        ) + np.array([k * STEP, 0.0, 0.0])
        add_body(both[: len(mesh.vertices)], mesh.faces)
        add_balls(both[len(mesh.vertices) :])
    set_scene(len(WAYS))
    render(out, 1500, 540, SAMPLES)


if __name__ == "__main__":
    main(*sys.argv[1:])
