# SPDX-License-Identifier: GPL-3.0-or-later
"""A meadow of three classes: grass and flowers by painted densities, rocks that keep their room.

Run through `blend_examples/run.sh meadow`, which sets everything up.
"""

from __future__ import annotations

import math

import bpy
import numpy as np
from numpy.typing import NDArray

from blend_examples.scene import (
    add_class,
    begin,
    build_studio,
    finish,
    grid,
    hidden,
    mesh_object,
    move_vertices,
    options,
    paint,
    run,
    scatter,
)
from blend_examples.studio import material

SIZE, CELLS = 6.0, 96
GRASS, PETALS, STONE = (0.10, 0.28, 0.03), (0.95, 0.75, 0.10), (0.30, 0.28, 0.26)
Array = NDArray[np.float64]


def ground() -> bpy.types.Object:
    """Low hills; the attributes Grass and Flowers, both 0 on a winding path."""
    made, vertices = grid("Ground", SIZE, CELLS)
    x, y = vertices[:, 0], vertices[:, 1]
    vertices[:, 2] = 0.22 * np.sin(1.3 * x) * np.cos(1.1 * y) + 0.08 * np.sin(2.9 * x + 2.3 * y)
    way = np.abs(x - 0.9 * np.sin(0.9 * y) - 0.2)
    beside = np.clip((way - 0.28) / 0.25, 0.0, 1.0)
    vertices[:, 2] -= 0.05 * (1 - beside)
    move_vertices(made, vertices)
    patches = np.clip(0.5 + np.sin(1.9 * x + 0.6) * np.sin(1.6 * y - 0.4), 0.0, 1.0)
    paint(made, "Grass", beside * (0.35 + 0.65 * (1 - patches)))
    paint(made, "Flowers", beside * patches**2)
    made.data.materials.append(material("Soil", (0.10, 0.075, 0.03), 1.0))
    return made


def blade(angle: float, height: float, lean: float) -> Array:
    """Five points of a thin leaf that bends outwards, as a strip that ends in a tip."""
    rows = []
    for t, width in ((0.0, 0.012), (0.55, 0.010), (1.0, 0.0)):
        out, up = lean * t * t, height * t * (1 - 0.25 * lean * t)
        rows += [(out, -width, up), (out, width, up)][: 1 if t == 1.0 else 2]
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    points = np.array(rows)
    points[:, :2] = points[:, :2] @ turn.T
    return points


def tuft(name: str, blades: int, height: float, lean: float) -> bpy.types.Object:
    vertices, faces = [], []
    for k in range(blades):
        base = 5 * k
        vertices.append(blade(2.4 * k, height * (0.7 + 0.3 * math.sin(5.1 * k)), lean))
        faces += [(base, base + 1, base + 3, base + 2), (base + 2, base + 3, base + 4)]
    made = mesh_object(name, np.vstack(vertices), faces)
    made.data.materials.append(material(f"{name} green", GRASS, 0.7))
    return hidden(made)


def flower() -> bpy.types.Object:
    """A stem with a ring of petals."""
    turns = np.linspace(0, 2 * np.pi, 10, endpoint=False)
    ring = np.column_stack([0.055 * np.cos(turns), 0.055 * np.sin(turns), 0 * turns + 0.17])
    stem = [(0.006, 0, 0), (-0.006, 0, 0), (0, 0, 0.16)]
    made = mesh_object(
        "Flower",
        np.vstack([stem, ring, [(0, 0, 0.15)]]),
        [(0, 1, 2), *((3 + k, 3 + (k + 1) % 10, 13) for k in range(10))],
    )
    made.data.materials.append(material("Petals", PETALS, 0.6))
    made.data.materials.append(material("Stem", GRASS, 0.7))
    made.data.polygons[0].material_index = 1
    return hidden(made)


def rock() -> bpy.types.Object:
    """A lump of radius 1 that sits a little in the ground."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=1.0)
    made = bpy.context.object
    made.name = made.data.name = "Rock"
    places = np.array([v.co for v in made.data.vertices])
    places *= 1 + 0.14 * np.sin(places @ np.array([[4.1], [3.3], [2.7]]))
    places[:, 2] = 0.55 * places[:, 2] + 0.15
    move_vertices(made, places)
    made.data.materials.append(material("Stone", STONE, 0.9))
    return hidden(made)


def main() -> None:
    given = options(__doc__, 2600, "plants and rocks").parse_args()
    begin()
    surface = ground()
    grass, petals, stone = tuft("Tuft", 9, 0.26, 0.16), flower(), rock()
    made = scatter(surface, given.count, given.seed)
    size = 0.30 * made.dapple.report.spacing
    common = {"align": 0.4, "scale_randomness": 0.5, "tilt": 0.25}
    add_class(made, "Grass", instance=grass, share=0.72, density="Grass", **common)
    add_class(made, "Flowers", instance=petals, share=0.25, density="Flowers", **common)
    add_class(made, "Rocks", instance=stone, share=0.03, radius=3 * size, scale=2.6 * size)
    made.dapple.classes[2].scale_randomness = 0.35
    bpy.ops.dapple.optimize()
    build_studio(given.width, given.width * 5 // 8, (0.6, -5.6, 2.5), (0.1, -0.5, 0.0), 38, False)
    counts = np.bincount([v.value for v in made.data.attributes["dapple_class"].data])
    finish("meadow", given, f"{' + '.join(map(str, counts))} tufts, flowers and rocks")


if __name__ == "__main__":
    run(main)
