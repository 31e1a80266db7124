# SPDX-License-Identifier: GPL-3.0-or-later
"""The scatters that ship as assets, each on a hill of its own: a picture of all, and previews.

Run through `blend_examples/run.sh ready`, which sets everything up.
"""

from __future__ import annotations

import math

import bpy
import numpy as np
from mathutils import Vector

from blend_examples.scene import (
    begin,
    build_studio,
    finish,
    grid,
    move_vertices,
    options,
    run,
)
from blend_examples.studio import Color, aim, material
from scripts.ready_scatters import READY, Ready, build

ACROSS, APART, RADIUS, PREVIEW = 3, 2.8, 1.25, 128
_GROUND: dict[str, Color] = {
    "Grass Meadow": (0.05, 0.07, 0.015),
    "Pebbles": (0.12, 0.10, 0.08),
    "Reptile Scales": (0.01, 0.03, 0.025),
    "Studs": (0.05, 0.012, 0.01),
    "Conifer Forest": (0.05, 0.05, 0.025),
    "Mushrooms": (0.035, 0.05, 0.015),
}


def hill(name: str, x: float, y: float, color: Color) -> bpy.types.Object:
    """A round, low hill with soft slopes."""
    made, vertices = grid(f"Hill of {name}", 2.0, 64)
    u, v = vertices[:, 0].copy(), vertices[:, 1].copy()
    vertices[:, 0] = RADIUS * u * np.sqrt(1.0 - 0.5 * v * v)  # the square as a disc
    vertices[:, 1] = RADIUS * v * np.sqrt(1.0 - 0.5 * u * u)
    away = np.hypot(vertices[:, 0], vertices[:, 1]) / RADIUS
    vertices[:, 2] = 0.62 * np.clip(np.cos(0.5 * math.pi * away), 0.0, 1.0) ** 1.1
    bumps = np.sin(3.0 * vertices[:, 0] + x) * np.cos(2.6 * vertices[:, 1] + y)
    vertices[:, 2] += 0.08 * np.clip(1.0 - away**2, 0.0, 1.0) * bumps
    move_vertices(made, vertices)
    made.data.shade_smooth()
    made.location, made.rotation_euler.z = (x, y, 0.0), math.pi  # its Y axis comes forward
    made.data.materials.append(material(name, color, 0.9))
    bpy.context.view_layer.update()
    return made


def place(ready: Ready, k: int) -> bpy.types.Object:
    """The asset on its hill."""
    x, y = APART * (k % ACROSS - 1), -APART * (k // ACROSS) + 0.5 * APART
    surface, obj = hill(ready.name, x, y, _GROUND[ready.name]), build(ready)
    bpy.context.scene.collection.objects.link(obj)
    obj.asset_clear()
    bpy.context.view_layer.objects.active = obj
    bpy.ops.dapple.place_scatter(surface=surface.name)
    return obj


def preview(ready: Ready, obj: bpy.types.Object, others: list[bpy.types.Object]) -> None:
    """The picture of one of them, alone."""
    scene, target = bpy.context.scene, obj.dapple.surface.location + Vector((0.0, -0.1, 0.42))
    aim(scene.camera, target + Vector((0.2, -3.1, 1.75)), target)
    scene.camera.data.lens = 52
    scene.render.resolution_x = scene.render.resolution_y = PREVIEW
    scene.render.filepath = str(ready.preview)
    for one in others:
        one.hide_render = one.dapple.surface.hide_render = one != obj
    bpy.ops.render.render(write_still=True)


def _light() -> None:
    """More sky than in a studio, and a floor that leaves the colors to what stands on it."""
    scene = bpy.context.scene
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.7
    floor = bpy.data.materials["Floor"].node_tree.nodes["Principled BSDF"]
    floor.inputs["Base Color"].default_value = (0.62, 0.58, 0.53, 1.0)
    scene.cycles.samples = 16


def main() -> None:
    parser = options(__doc__, 0, "of nothing: each asset has its own")
    parser.add_argument("--previews", action="store_true", help="of the assets, too")
    given = parser.parse_args()
    begin()
    made = [place(ready, k) for k, ready in enumerate(READY)]
    build_studio(given.width, given.width * 5 // 8, (0.0, -8.4, 6.4), (0.0, -0.15, 0.0), 39)
    _light()
    finish("ready", given, f"{len(made)} scatters")
    for ready, obj in zip(READY, made, strict=True) if given.previews else ():
        preview(ready, obj, made)


if __name__ == "__main__":
    run(main)
