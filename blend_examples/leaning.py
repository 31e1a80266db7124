# SPDX-License-Identifier: GPL-3.0-or-later
"""Three tufts of reed: upright, leaning apart, and leaning to the sun.

Run through `blend_examples/run.sh leaning`, which sets everything up.
"""

from __future__ import annotations

import math

import bpy

from blend_examples.scene import begin, build_studio, finish, hidden, options, run, scatter
from blend_examples.studio import material

_STEP = 3.0  # from one tuft to the next
_LEANS: tuple[dict[str, float], ...] = ({}, {"lean_apart": math.radians(50)}, {"lean_along": 0.75})


def mound(at: float) -> bpy.types.Object:
    """A flat round surface."""
    bpy.ops.mesh.primitive_circle_add(
        vertices=64, radius=0.75, fill_type="TRIFAN", location=(at, 0, 0)
    )
    made = bpy.context.object
    made.data.materials.append(material("Earth", (0.22, 0.14, 0.08), 0.9))
    return made


def reed() -> bpy.types.Object:
    """A thin stalk that stands on the ground."""
    bpy.ops.mesh.primitive_cone_add(vertices=8, radius1=0.03, radius2=0.006, depth=1.1)
    made = bpy.context.object
    for vertex in made.data.vertices:
        vertex.co.z += 0.55
    made.data.shade_smooth()
    made.data.materials.append(material("Reed", (0.20, 0.42, 0.09), 0.6))
    return hidden(made)


def sun() -> bpy.types.Object:
    """A sun that stands low on the right."""
    made = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    made.data.energy = 1.5
    made.rotation_euler = (0.0, math.radians(70), 0.0)
    bpy.context.scene.collection.objects.link(made)
    return made


def main() -> None:
    given = options(__doc__, 300, "reeds").parse_args()
    begin()
    stalk, light = reed(), sun()
    for k, lean in enumerate(_LEANS):
        made = scatter(mound(_STEP * (k - 1)), max(given.count // 3, 1), given.seed)
        made.dapple.instance, made.dapple.lean_object = stalk, light
        made.dapple.random_tilt, made.dapple.random_scale_down = math.radians(6), 0.3
        for name, value in lean.items():
            setattr(made.dapple, name, value)
    build_studio(given.width, given.width // 3, (0.0, -8.6, 2.6), (0.0, 0.0, 0.5), 34)
    finish("leaning", given, f"{3 * (given.count // 3)} reeds: upright, apart, to the sun")


if __name__ == "__main__":
    run(main)
