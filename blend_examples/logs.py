# SPDX-License-Identifier: GPL-3.0-or-later
"""Grass that keeps off fallen logs: off discs around them, and off their convex hulls.

Run through `blend_examples/run.sh logs`, which sets everything up.
"""

from __future__ import annotations

import math

import bpy
import numpy as np

from blend_examples.scene import (
    begin,
    build_studio,
    finish,
    grid,
    hidden,
    mesh_object,
    options,
    run,
    scatter,
)
from blend_examples.studio import material

_SIZE, _STEP = 3.0, 3.5  # of a meadow, and from one to the next
_LENGTH, _RADIUS = 0.95, 0.07  # of a log
_LOGS = 8


def log() -> bpy.types.Object:
    """A log that lies on the ground, with its cut ends in another color."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=16, radius=_RADIUS, depth=_LENGTH)
    made = bpy.context.object
    made.name = "Log"
    made.data.materials.append(material("Bark", (0.22, 0.11, 0.05), 0.9))
    made.data.materials.append(material("Wood", (0.72, 0.52, 0.30), 0.8))
    for polygon in made.data.polygons:
        polygon.use_smooth = len(polygon.vertices) == 4
        polygon.material_index = int(len(polygon.vertices) > 4)
    for vertex in made.data.vertices:
        x, y, z = vertex.co
        vertex.co = (z, y, x + 0.8 * _RADIUS)
    return hidden(made)


def tuft() -> bpy.types.Object:
    """Seven blades of grass."""
    vertices, faces = [], []
    for k in range(7):
        turn = 2.4 * k
        along, across = (
            np.array([math.cos(turn), math.sin(turn)]),
            np.array([-math.sin(turn), math.cos(turn)]),
        )
        for height, wide, lean in ((0.0, 0.007, 0.005), (0.06, 0.005, 0.015), (0.11, 0.0, 0.04)):
            for side in (-1.0, 1.0):
                vertices.append([*(lean * along + side * wide * across), height])
        faces += [
            (6 * k, 6 * k + 1, 6 * k + 3, 6 * k + 2),
            (6 * k + 2, 6 * k + 3, 6 * k + 5, 6 * k + 4),
        ]
    made = mesh_object("Tuft", vertices, faces)
    made.data.materials.append(material("Grass", (0.13, 0.30, 0.05), 0.7))
    return hidden(made)


def meadow(at: float) -> bpy.types.Object:
    made, _ = grid("Meadow", _SIZE, 30)
    made.location.x = at
    made.data.materials.append(material("Soil", (0.16, 0.11, 0.07), 1.0))
    return made


def main() -> None:
    given = options(__doc__, 2500, "tufts on each meadow").parse_args()
    begin()
    wood, grass = log(), tuft()
    for at, shape in ((-_STEP / 2, "DISC"), (_STEP / 2, "HULL")):
        surface = meadow(at)
        fallen = scatter(surface, _LOGS, given.seed)
        bpy.ops.dapple.edit_object_types(action="ADD")
        kind = fallen.dapple.object_types[0]
        kind.instance, kind.radius, kind.borders = wood, _LENGTH / 2, "MOVE_IN"
        bpy.ops.dapple.optimize()
        things = bpy.data.collections.new(f"Logs {shape}")
        bpy.context.scene.collection.children.link(things)
        things.objects.link(fallen)
        made = scatter(surface, given.count, given.seed)
        made.dapple.instance = grass
        density = made.dapple.density
        density.avoid_collection, density.avoid_shape = things, shape
        density.avoid_margin = 0.04
        bpy.ops.dapple.optimize()
    build_studio(given.width, given.width // 2, (0.0, -5.2, 5.6), (0.0, -0.15, 0.0), 36)
    finish("logs", given, f"{given.count} tufts beside discs and beside hulls")


if __name__ == "__main__":
    run(main)
