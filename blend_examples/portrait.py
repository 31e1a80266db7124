# SPDX-License-Identifier: GPL-3.0-or-later
"""A stippled portrait: every dot is a pin, an instance on a board.

The picture is scikit-image's astronaut (Eileen Collins, NASA, in the public domain). Run through
`blend_examples/run.sh portrait`, which sets everything up.
"""

from __future__ import annotations

import bpy
import dapple3d as dapple
import numpy as np
import skimage.data
from skimage.color import rgb2gray

from addon.nodes import set_input
from addon.nodes.builder import Builder, new_group
from blend_examples.scene import begin, build_studio, finish, hidden, mesh_object, options, run
from blend_examples.studio import material

WIDTH = 2.6  # of the board
CROP = (slice(0, 330), slice(60, 390))  # rows and columns of the face


def pins(points: np.ndarray, pin: bpy.types.Object) -> bpy.types.Object:
    """The points with the pin on each of them, by a node group."""
    made = mesh_object("Pins", points, [], smooth=False)
    geometry = ("Geometry", "NodeSocketGeometry")
    tree = new_group("Pins", [geometry, ("Pin", "NodeSocketObject")], [geometry])
    tree.is_modifier = True
    b = Builder(tree)
    thing = b.node("GeometryNodeObjectInfo", b.input("Pin"), True).outputs["Geometry"]
    b.output("Geometry", b.out("GeometryNodeInstanceOnPoints", b.input("Geometry"), True, thing))
    modifier = made.modifiers.new("Pins", "NODES")
    modifier.node_group = tree
    set_input(modifier, "Pin", pin)
    return made


def build_pin(radius: float) -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, radius=radius)
    made = bpy.context.object
    made.name = made.data.name = "Pin"
    made.data.shade_smooth()
    made.data.materials.append(material("Ink", (0.010, 0.012, 0.020), 0.35))
    return hidden(made)


def main() -> None:
    given = options(__doc__, 9000, "pins").parse_args()
    begin()
    picture = rgb2gray(skimage.data.astronaut())[CROP]
    picture = np.clip(0.06 + 0.98 * picture, 0.0, 1.0)
    dots = dapple.stipple(picture, given.count, seed=given.seed)
    scale = WIDTH / picture.shape[1]
    flat = dots.positions * (scale, -scale) + (-WIDTH / 2, WIDTH / 2)
    points = np.column_stack([flat, np.zeros(len(flat))])
    pins(points, build_pin(dots.radius * scale))
    side = WIDTH / 2 + 0.12
    corners = [
        (-side, -side, -0.01),
        (side, -side, -0.01),
        (side, side, -0.01),
        (-side, side, -0.01),
    ]
    board = mesh_object("Board", corners, [(0, 1, 2, 3)], smooth=False)
    board.data.materials.append(material("Paper", (0.86, 0.83, 0.76), 0.8))
    build_studio(given.width, given.width, (0.0, -0.5, 6.2), (0.0, 0.0, 0.0), 74, False)
    finish("portrait", given, f"{len(flat)} pins of radius {dots.radius * scale:.4f}")


if __name__ == "__main__":
    run(main)
