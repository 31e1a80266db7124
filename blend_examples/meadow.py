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
    build_outdoors,
    fade_into_haze,
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
from blend_examples.studio import color_by_chance, material

SIZE, CELLS, AROUND = 12.0, 100, 50.0  # of the ground with plants; so far the land goes on
NEAR, EDGE = -3.4, 5.4  # before the one nothing is in view, beyond the other there are no plants
GRASS = [(0.5, (0.13, 0.29, 0.03)), (0.85, (0.22, 0.36, 0.05)), (1.0, (0.40, 0.40, 0.10))]
PETALS = [(0.55, (0.95, 0.60, 0.04)), (0.9, (0.90, 0.88, 0.80)), (1.0, (0.75, 0.08, 0.05))]
STONE, SOIL, FIELD = (0.30, 0.28, 0.26), (0.16, 0.11, 0.06), (0.10, 0.17, 0.03)
Array = NDArray[np.float64]


def ground() -> bpy.types.Object:
    """Low hills; the attributes Grass and Flowers, both 0 on a winding path."""
    made, vertices = grid("Ground", SIZE, CELLS, AROUND)
    x, y = vertices[:, 0], vertices[:, 1]
    way = np.abs(x - 0.9 * np.sin(0.9 * y) - 0.2)
    beside = np.clip((way - 0.22) / 0.25, 0.0, 1.0)
    far = np.clip(np.hypot(x, y) / SIZE - 0.4, 0.0, None)
    hills = 0.22 * np.sin(1.3 * x) * np.cos(1.1 * y) + 0.08 * np.sin(2.9 * x + 2.3 * y)
    ridges = np.sin(0.31 * x + 1.0) * np.cos(0.23 * y) + 0.5 * np.sin(0.7 * x - 0.5 * y)
    vertices[:, 2] = hills / (1 + far) ** 2 + 0.5 * far * (0.9 + ridges) - 0.05 * (1 - beside)
    move_vertices(made, vertices)
    patches = np.clip(0.5 + np.sin(1.9 * x + 0.6) * np.sin(1.6 * y - 0.4), 0.0, 1.0)
    seen = within_view(x, y)
    paint(made, "Grass", seen * beside * (0.35 + 0.65 * (1 - patches)))
    paint(made, "Flowers", seen * beside * patches**2)
    paint(made, "Rocks", seen)
    paint(made, "Cover", np.maximum(beside, np.clip(np.hypot(x, y) / SIZE, 0.0, 1.0)))
    made.data.materials.append(soil())
    return made


def within_view(x: Array, y: Array) -> Array:
    """Less with the distance from the camera, and nothing where it does not look."""
    along = y - NEAR
    found: Array = np.clip((EDGE - np.maximum(np.abs(x), y)) / 1.5, 0.0, 1.0)
    found *= (along > 0.0) & (np.abs(x) < 1.9 + 0.55 * along)
    return found / (1.0 + (along / 4.0) ** 2)


def soil() -> bpy.types.Material:
    """Earth on the path, and green where there are too many blades to see one."""
    made = material("Soil", SOIL, 1.0)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    cover, color = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeMix")
    cover.attribute_name, color.data_type = "Cover", "RGBA"
    factor, first, second = (one for one in color.inputs if one.enabled)
    first.default_value, second.default_value = (*SOIL, 1), (*FIELD, 1)
    links.new(cover.outputs["Fac"], factor)
    result = next(one for one in color.outputs if one.enabled)
    links.new(result, nodes["Principled BSDF"].inputs["Base Color"])
    return fade_into_haze(made, 9.0, 48.0)


def blade(angle: float, height: float, lean: float) -> Array:
    """Five points of a thin leaf that bends outward, as a strip that ends in a tip."""
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
    made.data.materials.append(color_by_chance(f"{name} green", "id", "INSTANCER", GRASS, 0.6))
    return hidden(made)


def flower() -> bpy.types.Object:
    """A stem with eight petals around an eye."""
    turns = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    reach = np.where(np.arange(16) % 2, 0.022, 0.055)
    height = np.where(np.arange(16) % 2, 0.168, 0.18)
    ring = np.column_stack([reach * np.cos(turns), reach * np.sin(turns), height])
    eye = np.column_stack([0.016 * np.cos(turns), 0.016 * np.sin(turns), 0 * turns + 0.176])
    stem = [(0.006, 0, 0), (-0.006, 0, 0), (0, 0, 0.165)]
    petals = [(3 + k, 3 + (k + 1) % 16, 19) for k in range(16)]
    made = mesh_object(
        "Flower",
        np.vstack([stem, ring, [(0, 0, 0.160)], eye]),
        [(0, 1, 2), *petals, tuple(range(20, 36))],
    )
    made.data.materials.append(color_by_chance("Petals", "id", "INSTANCER", PETALS, 0.6))
    made.data.materials.append(material("Stem", GRASS[0][1], 0.7))
    made.data.materials.append(material("Eye", (0.35, 0.14, 0.02), 0.8))
    made.data.polygons[0].material_index = 1
    made.data.polygons[-1].material_index = 2
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
    given = options(__doc__, 7000, "plants and rocks").parse_args()
    begin()
    surface = ground()
    grass, petals, stone = tuft("Tuft", 11, 0.26, 0.16), flower(), rock()
    made = scatter(surface, given.count, given.seed)
    common = {"align_to_normal": 0.4, "random_scale_down": 0.5, "random_tilt": 0.25}
    add_class(made, "Grass", instance=grass, weight=0.84, density="Grass", **common)
    add_class(made, "Flowers", instance=petals, weight=0.15, density="Flowers", **common)
    add_class(made, "Rocks", instance=stone, weight=0.01, radius=0.1, scale=0.09, density="Rocks")
    made.dapple.object_types[2].random_scale_down = 0.5
    bpy.ops.dapple.optimize()
    build_outdoors(given.width, given.width * 5 // 8, (0.35, -5.6, 1.9), (0.1, -0.3, 0.5), 36)
    counts = np.bincount([v.value for v in made.data.attributes["dapple_object_type"].data])
    finish("meadow", given, f"{' + '.join(map(str, counts))} tufts, flowers and rocks")


if __name__ == "__main__":
    run(main)
