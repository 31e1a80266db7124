# SPDX-License-Identifier: GPL-3.0-or-later
"""Studs in the colors of an image on a sheet, and of a color attribute on a monkey's head.

Run through `blend_examples/run.sh colored`, which sets everything up.
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
    move_vertices,
    options,
    run,
    scatter,
)
from blend_examples.studio import material

_SIZE = 64  # of the image, in pixels


def sheet() -> bpy.types.Object:
    """A wavy sheet with a UV map."""
    made, vertices = grid("Sheet", 2.2, 40)
    uv = made.data.uv_layers.new(name="UVMap")
    corners = np.array([loop.vertex_index for loop in made.data.loops])
    places = vertices[corners, :2] / 2.2
    uv.uv.foreach_set("vector", (places - places.min(axis=0)).astype(np.float32).ravel())
    vertices[:, 2] = 0.5 + 0.12 * np.sin(3.0 * vertices[:, 0]) * np.cos(2.5 * vertices[:, 1])
    move_vertices(made, vertices)
    made.location.x = -1.5
    made.data.materials.append(material("Sheet", (0.05, 0.05, 0.06), 0.8))
    return made


def rings() -> bpy.types.Image:
    """Bright rings around the middle."""
    x, y = np.meshgrid(*2 * [(np.arange(_SIZE) + 0.5) / _SIZE - 0.5])
    wave = 0.5 + 0.5 * np.cos(8.0 * math.pi * np.hypot(x, y))
    pixels = np.stack([0.9 * wave, 0.15 + 0.3 * wave, 0.7 - 0.6 * wave, np.ones_like(x)], axis=2)
    made = bpy.data.images.new("Rings", _SIZE, _SIZE)
    made.pixels.foreach_set(pixels.astype(np.float32).ravel())
    made.pack()
    return made


def head() -> bpy.types.Object:
    """A monkey's head that is colored from its chin to its forehead."""
    bpy.ops.mesh.primitive_monkey_add(size=1.9, location=(1.5, 0, 0.95))
    made = bpy.context.object
    made.rotation_euler.z = math.radians(-25)
    colors = made.data.color_attributes.new("Fur", "FLOAT_COLOR", "POINT")
    heights = np.array([vertex.co.z for vertex in made.data.vertices])
    up = (heights - heights.min()) / np.ptp(heights)
    rows = np.column_stack([up, 0.25 + 0.4 * up, 0.6 * (1.0 - up), np.ones(len(up))])
    colors.data.foreach_set("color", rows.astype(np.float32).ravel())
    made.modifiers.new("Rounding", "SUBSURF").levels = 1
    made.data.shade_smooth()
    made.data.materials.append(material("Head", (0.05, 0.05, 0.06), 0.8))
    return made


def stud() -> bpy.types.Object:
    """A ball whose material reads the color of its instance."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.5)
    made = bpy.context.object
    made.data.shade_smooth()
    painted = material("Stud", (0.8, 0.8, 0.8), 0.4)
    nodes, links = painted.node_tree.nodes, painted.node_tree.links
    color = nodes.new("ShaderNodeAttribute")
    color.attribute_type, color.attribute_name = "INSTANCER", "dapple_color"
    links.new(color.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    made.data.materials.append(painted)
    return hidden(made)


def main() -> None:
    given = options(__doc__, 1400, "studs").parse_args()
    begin()
    ball, count = stud(), max(given.count // 2, 1)
    for surface in (sheet(), head()):
        made = scatter(surface, count, given.seed)
        made.dapple.instance, made.dapple.fit_to_spacing = ball, 1.0
        if surface.data.color_attributes.get("Fur"):
            made.dapple.color_attribute = "Fur"
        else:
            made.dapple.color_image = rings()
    build_studio(given.width, given.width // 2, (0.0, -6.4, 4.2), (0.0, 0.0, 0.6), 40)
    finish("colored", given, f"{2 * count} studs in the colors below them")


if __name__ == "__main__":
    run(main)
