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
    build_studio,
    finish,
    grid,
    hidden,
    mesh_object,
    move_vertices,
    options,
    run,
    scatter,
)
from blend_examples.studio import material

SIZE, CELLS, PIXELS = 5.0, 120, 256


def plan() -> bpy.types.Image:
    """A picture of the city: two centers, a river without houses, thinner toward the edge."""
    x, y = np.meshgrid(np.linspace(-1, 1, PIXELS), np.linspace(-1, 1, PIXELS))
    first = np.exp(-((x + 0.35) ** 2 + (y - 0.25) ** 2) / 0.10)
    second = 0.7 * np.exp(-((x - 0.45) ** 2 + (y + 0.15) ** 2) / 0.06)
    values = 0.09 + first + second
    river = np.abs(y - 0.35 * np.sin(2.2 * x) + 0.25)
    values *= np.clip((river - 0.05) / 0.03, 0, 1)
    pixels = np.ones((PIXELS, PIXELS, 4), np.float32)
    pixels[..., :3] = np.clip(values / values.max(), 0, 1)[..., None]
    image = bpy.data.images.new("Plan", PIXELS, PIXELS, float_buffer=True)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def lay_flat(thing: bpy.types.Object, vertices: NDArray[np.float64]) -> None:
    """A UV map as seen from above."""
    corners = np.empty(len(thing.data.loops), np.int32)
    thing.data.loops.foreach_get("vertex_index", corners)
    places = vertices[corners, :2] / SIZE + 0.5
    thing.data.uv_layers.new(name="Above").uv.foreach_set("vector", places.astype("f4").ravel())


def ground() -> bpy.types.Object:
    made, vertices = grid("Ground", SIZE, CELLS)
    x, y = vertices[:, 0], vertices[:, 1]
    vertices[:, 2] = 0.16 * np.sin(1.5 * x + 0.5) * np.cos(1.2 * y) + 0.05 * np.sin(
        3.1 * x - 2.2 * y
    )
    move_vertices(made, vertices)
    lay_flat(made, vertices)
    made.data.materials.append(material("Earth", (0.24, 0.26, 0.17), 1.0))
    return made


def house() -> bpy.types.Object:
    """A block with a roof, 1 wide, standing in the ground a little."""
    low = [(-0.5, -0.4, -0.3), (0.5, -0.4, -0.3), (0.5, 0.4, -0.3), (-0.5, 0.4, -0.3)]
    high = [(x, y, 1.0) for x, y, _ in low]
    ridge = [(-0.5, 0, 1.35), (0.5, 0, 1.35)]
    walls = [(0, 1, 5, 4), (1, 2, 6, 9, 5), (2, 3, 7, 6), (3, 0, 4, 8, 7)]
    made = mesh_object("House", low + high + ridge, [*walls, (4, 5, 9, 8), (6, 7, 8, 9)], False)
    made.data.materials.append(material("Wall", (0.72, 0.66, 0.56), 0.8))
    made.data.materials.append(material("Roof", (0.42, 0.12, 0.06), 0.7))
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
    made.dapple.scale = 0.48 * made.dapple.report.spacing
    made.dapple.align, made.dapple.scale_randomness = 0.0, 0.35
    build_studio(given.width, given.width * 5 // 8, (1.6, -5.4, 3.4), (0.0, -0.1, 0.0), 46, False)
    report = made.dapple.report
    finish("city", given, f"{report.count} houses, area variation {report.capacity_variation:.4f}")


if __name__ == "__main__":
    run(main)
