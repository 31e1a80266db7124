# SPDX-License-Identifier: GPL-3.0-or-later
"""Studs on a monkey's head: the more the surface bends, the more and the smaller they are.

Run through `blend_examples/run.sh studs`, which sets everything up.
"""

from __future__ import annotations

import bpy

from blend_examples.scene import begin, build_studio, finish, options, run, scatter
from blend_examples.studio import BODY, build_stud, material


def head() -> bpy.types.Object:
    bpy.ops.mesh.primitive_monkey_add(size=1.7, location=(0, 0, 0.83), rotation=(-0.35, 0, 0.35))
    made = bpy.context.object
    rounding = made.modifiers.new("Rounding", "SUBSURF")
    rounding.levels = rounding.render_levels = 2
    made.data.shade_smooth()
    made.data.materials.append(material("Skin", BODY, 0.45))
    return made


def main() -> None:
    given = options(__doc__, 2400, "studs").parse_args()
    begin()
    surface, stud = head(), build_stud()
    made = scatter(surface, given.count, given.seed)
    made.dapple.density.curvature = 0.9
    bpy.ops.dapple.optimize()
    made.dapple.instance = stud
    made.dapple.scale = 0.30 * made.dapple.report.spacing
    made.dapple.density_scale = -1.0  # larger where there are fewer
    build_studio(given.width, 3 * given.width // 4, (1.5, -4.6, 2.0), (0.0, 0.0, 0.8), 70)
    report = made.dapple.report
    finish("studs", given, f"{report.count} studs, area variation {report.capacity_variation:.4f}")


if __name__ == "__main__":
    run(main)
