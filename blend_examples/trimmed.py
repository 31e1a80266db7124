# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables on three terraces: up to the border, moved in from it, and left out at it.

Run through `blend_examples/run.sh trimmed`, which sets everything up.
"""

from __future__ import annotations

import math

import bpy

from blend_examples.scene import begin, build_studio, finish, hidden, options, run, scatter
from blend_examples.studio import material

_CORNERS = 120
_STEP = 3.3  # from one terrace to the next


def terrace(at: float) -> bpy.types.Object:
    """A surface with a winding border."""
    turns = [2.0 * math.pi * k / _CORNERS for k in range(_CORNERS)]
    outline = [(1.25 + 0.17 * math.sin(3 * t) + 0.12 * math.cos(5 * t), t) for t in turns]
    vertices = [(r * math.cos(t), r * math.sin(t), 0.0) for r, t in outline]
    mesh = bpy.data.meshes.new("Terrace")
    mesh.from_pydata(vertices, [], [tuple(range(_CORNERS))])
    mesh.materials.append(material("Stone", (0.55, 0.52, 0.47), 0.9))
    made = bpy.data.objects.new("Terrace", mesh)
    made.location.x = at
    bpy.context.scene.collection.objects.link(made)
    return made


def column(
    name: str, radius: float, height: float, color: tuple[float, float, float]
) -> bpy.types.Object:
    """A round thing that stands on the ground."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=radius, depth=height)
    made = bpy.context.object
    made.name = name
    for vertex in made.data.vertices:
        vertex.co.z += 0.5 * height
    made.modifiers.new("Bevel", "BEVEL").width = 0.2 * min(radius, height)
    made.data.materials.append(material(name, color, 0.5))
    return hidden(made)


def main() -> None:
    given = options(__doc__, 80, "tables and pots").parse_args()
    begin()
    table = column("Table", 0.22, 0.16, (0.62, 0.16, 0.07))
    pot = column("Pot", 0.05, 0.1, (0.12, 0.32, 0.16))
    counts = []
    for k, borders in enumerate(("KEEP", "MOVE_IN", "REMOVE")):
        made = scatter(terrace(_STEP * (k - 1)), given.count, given.seed)
        for thing in (table, pot):
            bpy.ops.dapple.edit_object_types(action="ADD")
            made.dapple.object_types[-1].instance = thing
            made.dapple.object_types[-1].radius_from_bounds = True
        tables = made.dapple.object_types[0]
        tables.use_count, tables.count, tables.borders = True, max(given.count // 5, 1), borders
        bpy.ops.dapple.optimize()
        kinds = made.data.attributes["dapple_object_type"].data
        counts.append(sum(one.value == 0 for one in kinds))
    build_studio(given.width, given.width // 3, (0.0, -7.2, 7.4), (0.0, -0.1, 0.0), 33)
    finish("trimmed", given, "{} tables kept, {} moved in, {} left".format(*counts))


if __name__ == "__main__":
    run(main)
