# SPDX-License-Identifier: GPL-3.0-or-later
"""A monkey's head with 5, 50 and 500 hair guides, which are the first of the same points.

Run through `blend_examples/run.sh hair`, which sets everything up.
"""

from __future__ import annotations

import bpy

from blend_examples.scene import begin, build_studio, finish, hidden, options, run, scatter
from blend_examples.studio import Color, material

_SKIN: Color = (0.60, 0.36, 0.22)
_HAIR: Color = (0.03, 0.02, 0.015)
_APART = 2.3
_COUNTS = (5, 50, 500)


def head(place: float) -> bpy.types.Object:
    bpy.ops.mesh.primitive_monkey_add(size=1.5, location=(place, 0, 0.75), rotation=(-0.3, 0, 0))
    made = bpy.context.object
    made.data.shade_smooth()
    return made


def add_guides(made: bpy.types.Object, count: int, thickness: float) -> None:
    """Hair guides of the first points, as thin spikes that do not shrink to a line in a picture."""
    bpy.context.view_layer.objects.active = made
    bpy.ops.dapple.add_hair_guides(count=count)
    curves = bpy.context.object.data
    radius = curves.attributes.new("radius", "FLOAT", "POINT")
    points = len(curves.points) // count
    tapered = [thickness * (1.0 - k % points / points) for k in range(len(curves.points))]
    radius.data.foreach_set("value", tapered)
    curves.materials.append(bpy.data.materials["Hair"])


def main() -> None:
    given = options(__doc__, max(_COUNTS), "points").parse_args()
    begin()
    skin = material("Skin", _SKIN, 0.6)
    material("Hair", _HAIR, 0.4)
    counts = sorted({min(count, given.count) for count in _COUNTS})
    for k, count in enumerate(counts):
        surface = head(_APART * (k - (len(counts) - 1) / 2))
        surface.data.materials.append(skin)
        add_guides(hidden(scatter(surface, given.count, given.seed)), count, 0.008)
    build_studio(given.width, 2 * given.width // 5, (0.0, -7.4, 1.7), (0.0, 0.0, 0.75), 40)
    bpy.context.scene.cycles_curves.shape = "THICK"
    finish("hair", given, f"{', '.join(map(str, counts))} guides of {given.count} points")


if __name__ == "__main__":
    run(main)
