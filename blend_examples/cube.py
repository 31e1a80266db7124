# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's default cube after one click on Add Scatter.

Run through `blend_examples/run.sh cube`, which sets everything up.
"""

from __future__ import annotations

import bpy

from blend_examples.scene import begin, build_studio, finish, options, run, scatter
from blend_examples.studio import Color, material

_CUBE: Color = (0.45, 0.47, 0.50)


def default_cube() -> bpy.types.Object:
    """The one that a new file has, as it is."""
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(0.0, 0.0, 1.0))
    made = bpy.context.object
    made.data.materials.append(material("Cube", _CUBE, 0.7))
    return made


def main() -> None:
    given = options(__doc__, 300, "cones").parse_args()
    begin()
    made = scatter(default_cube(), given.count, given.seed)
    build_studio(
        given.width, 3 * given.width // 4, (4.6, -5.6, 4.2), (0.0, 0.0, 0.95), 58, floor=False
    )
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_WORKBENCH"  # as the 3D View shows it
    scene.display.shading.color_type, scene.display.shading.show_cavity = "MATERIAL", True
    report = made.dapple.report
    finish("cube", given, f"{report.count} cones, area variation {report.capacity_variation:.4f}")


if __name__ == "__main__":
    run(main)
