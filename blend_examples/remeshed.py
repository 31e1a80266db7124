# SPDX-License-Identifier: GPL-3.0-or-later
"""A monkey's head with a checkered texture, before and after Remesh with Dapple.

Run through `blend_examples/run.sh remeshed`, which sets everything up.
"""

from __future__ import annotations

import bpy

from blend_examples.scene import begin, build_studio, finish, options, run
from blend_examples.studio import material


def checkered() -> bpy.types.Material:
    made = material("Checkered", (0.8, 0.8, 0.8), 0.5)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    checker = nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = 24.0
    checker.inputs["Color1"].default_value = (0.75, 0.42, 0.16, 1)
    checker.inputs["Color2"].default_value = (0.93, 0.85, 0.70, 1)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["UV"], checker.inputs["Vector"])
    links.new(checker.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return made


def head(place: float, look: bpy.types.Material) -> bpy.types.Object:
    bpy.ops.mesh.primitive_monkey_add(
        size=1.8, location=(place, 0, 0.87), rotation=(-0.3, 0, -0.12 * place)
    )
    made = bpy.context.object
    made.data.materials.append(look)
    return made


def add_wires(thing: bpy.types.Object, dark: bpy.types.Material) -> None:
    """The edges of an object, as thin dark bars."""
    made = bpy.data.objects.new(f"{thing.name} Wires", thing.data.copy())
    made.matrix_world = thing.matrix_world
    made.data.materials.clear()
    made.data.materials.append(dark)
    bpy.context.scene.collection.objects.link(made)
    wires = made.modifiers.new("Wires", "WIREFRAME")
    wires.thickness, wires.use_even_offset = 0.006, False


def main() -> None:
    given = options(__doc__, 1500, "vertices").parse_args()
    begin()
    look, dark = checkered(), material("Wire", (0.03, 0.03, 0.03), 0.6)
    before, after = head(-1.15, look), head(1.15, look)
    bpy.context.view_layer.objects.active = after
    bpy.ops.dapple.remesh(count=given.count)
    for one in (before, after):
        add_wires(one, dark)
    build_studio(given.width, 9 * given.width // 20, (0.0, -6.4, 1.5), (0.0, 0.0, 0.85), 47)
    count = len(after.data.vertices)
    finish("remeshed", given, f"{count} vertices instead of {len(before.data.vertices)}")


if __name__ == "__main__":
    run(main)
