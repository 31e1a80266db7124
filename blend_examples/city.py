# SPDX-License-Identifier: GPL-3.0-or-later
"""A city on hills: a picture says where it is dense, and where a river flows.

Run through `blend_examples/run.sh city`, which sets everything up.
"""

from __future__ import annotations

import bpy
import numpy as np
from numpy.typing import NDArray

from blend_examples.scene import (
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

SIZE, CELLS, PIXELS, AROUND = 5.0, 100, 256, 40.0
ROOFS = [
    (0.5, (0.46, 0.13, 0.06)),
    (0.8, (0.55, 0.22, 0.10)),
    (1.0, (0.16, 0.17, 0.19)),
]
FIELDS = [(0.12, 0.18, 0.06), (0.24, 0.25, 0.10)]
Array = NDArray[np.float64]


def river(x: Array, y: Array) -> Array:
    """Distance from the middle of the river; the square of the plan is 2 wide."""
    return np.abs(y - 0.35 * np.sin(2.2 * x) + 0.25)


def plan() -> bpy.types.Image:
    """A picture of the city: two centers, a river without houses, none beyond the edge."""
    x, y = np.meshgrid(np.linspace(-1, 1, PIXELS), np.linspace(-1, 1, PIXELS))
    first = np.exp(-((x + 0.35) ** 2 + (y - 0.25) ** 2) / 0.10)
    second = 0.7 * np.exp(-((x - 0.45) ** 2 + (y + 0.15) ** 2) / 0.06)
    values = 0.24 + first + second
    values *= np.clip((river(x, y) - 0.07) / 0.02, 0, 1)
    values *= np.clip((0.99 - np.hypot(x, y)) / 0.35, 0, 1)
    pixels = np.ones((PIXELS, PIXELS, 4), np.float32)
    pixels[..., :3] = np.clip(values / values.max(), 0, 1)[..., None]
    image = bpy.data.images.new("Plan", PIXELS, PIXELS, float_buffer=True)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def lay_flat(thing: bpy.types.Object, vertices: Array) -> None:
    """A UV map as seen from above."""
    corners = np.empty(len(thing.data.loops), np.int32)
    thing.data.loops.foreach_get("vertex_index", corners)
    places = vertices[corners, :2] / SIZE + 0.5
    thing.data.uv_layers.new(name="Above").uv.foreach_set("vector", places.astype("f4").ravel())


def ground() -> bpy.types.Object:
    """Where the city may stand; around it the land goes on."""
    made, vertices = grid("Ground", SIZE, CELLS)
    shape(made, vertices)
    lay_flat(made, vertices)
    soil = fade_into_haze(earth(), 8.0, 60.0)
    land = ring(*grid("Whole", SIZE, CELLS, AROUND))
    for one in (made, land):
        one.data.materials.append(soil)
    return made


def ring(whole: bpy.types.Object, vertices: Array) -> bpy.types.Object:
    """The part of a grid around the square of the city; the grid itself is removed."""
    faces = np.array([list(face.vertices) for face in whole.data.polygons])
    outside = np.abs(vertices[faces].mean(axis=1)[:, :2]).max(axis=1) > SIZE / 2
    used, indices = np.unique(faces[outside], return_inverse=True)
    bpy.data.objects.remove(whole)
    land = mesh_object("Land", vertices[used], indices.reshape(-1, 4))
    shape(land, vertices[used])
    return land


def shape(thing: bpy.types.Object, vertices: Array) -> None:
    """Hills that grow into mountains far away, and a river bed."""
    x, y = vertices[:, 0], vertices[:, 1]
    hills = 0.16 * np.sin(1.5 * x + 0.5) * np.cos(1.2 * y) + 0.05 * np.sin(3.1 * x - 2.2 * y)
    far = np.clip(np.hypot(x, y) / SIZE - 0.7, 0.0, None)
    ridges = np.sin(0.31 * x + 1.0) * np.cos(0.23 * y) + 0.5 * np.sin(0.7 * x - 0.5 * y)
    water = np.exp(-((river(2 * x / SIZE, 2 * y / SIZE) / 0.055) ** 4))
    vertices[:, 2] = hills / (1 + far) + 0.22 * far * (1 + ridges) - 0.05 * water
    move_vertices(thing, vertices)
    paint(thing, "Water", water)


def earth() -> bpy.types.Material:
    """Grass with some change in it, and water."""
    made = material("Earth", (0.14, 0.20, 0.07), 1.0)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    noise, fields = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeValToRGB")
    water, color = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeMix")
    rough, color.data_type = nodes.new("ShaderNodeMapRange"), "RGBA"
    factor, first, second = (one for one in color.inputs if one.enabled)
    water.attribute_name, noise.inputs["Scale"].default_value = "Water", 1.6
    for element, at, tint in zip(fields.color_ramp.elements, (0.40, 0.60), FIELDS, strict=True):
        element.position, element.color = at, (*tint, 1)
    rough.inputs["To Min"].default_value, rough.inputs["To Max"].default_value = 1.0, 0.12
    second.default_value = (0.02, 0.07, 0.10, 1)
    shader = nodes["Principled BSDF"].inputs
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Position"], noise.inputs["Vector"])
    links.new(noise.outputs["Fac"], fields.inputs["Fac"])
    links.new(water.outputs["Fac"], factor)
    links.new(fields.outputs["Color"], first)
    links.new(next(one for one in color.outputs if one.enabled), shader["Base Color"])
    links.new(water.outputs["Fac"], rough.inputs["Value"])
    links.new(rough.outputs["Result"], shader["Roughness"])
    return made


def house() -> bpy.types.Object:
    """A block with a roof, 1 wide, standing in the ground a little."""
    low = [(-0.5, -0.4, -0.3), (0.5, -0.4, -0.3), (0.5, 0.4, -0.3), (-0.5, 0.4, -0.3)]
    high = [(x, y, 1.0) for x, y, _ in low]
    ridge = [(-0.5, 0, 1.35), (0.5, 0, 1.35)]
    walls = [(0, 1, 5, 4), (1, 2, 6, 9, 5), (2, 3, 7, 6), (3, 0, 4, 8, 7)]
    made = mesh_object("House", low + high + ridge, [*walls, (4, 5, 9, 8), (6, 7, 8, 9)], False)
    made.data.materials.append(material("Wall", (0.72, 0.66, 0.56), 0.8))
    made.data.materials.append(color_by_chance("Roof", "id", "INSTANCER", ROOFS, 0.7))
    for k in (4, 5):
        made.data.polygons[k].material_index = 1
    return hidden(made)


def main() -> None:
    given = options(__doc__, 1800, "houses").parse_args()
    begin()
    surface = ground()
    block = house()
    made = scatter(surface, given.count, given.seed)
    made.dapple.density.image = plan()
    bpy.ops.dapple.optimize()
    made.dapple.instance = block
    made.dapple.fit_to_spacing, made.dapple.scale = 1.0, 0.9  # no house cuts another
    made.dapple.align_to_normal, made.dapple.random_scale_down = 0.0, 0.25
    build_outdoors(given.width, given.width * 5 // 8, (1.7, -5.6, 2.5), (0.0, -0.1, 0.25), 44)
    report = made.dapple.report
    finish("city", given, f"{report.count} houses, area variation {report.capacity_variation:.4f}")


if __name__ == "__main__":
    run(main)
