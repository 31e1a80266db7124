# SPDX-License-Identifier: GPL-3.0-or-later
"""Rivets along the creases of a tank, posts along the border of a field, stitches along a seam.

Run through `blend_examples/run.sh edges`, which sets everything up.
"""

from __future__ import annotations

import math
from typing import Any

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


def tank() -> bpy.types.Object:
    bpy.ops.mesh.primitive_cylinder_add(
        vertices=48, radius=0.8, depth=1.5, location=(-2.5, 0, 0.75)
    )
    made = bpy.context.object
    made.rotation_euler.z = math.radians(-60)
    made.data.materials.append(material("Steel", (0.25, 0.29, 0.33), 0.35))
    made.data.shade_smooth()
    made.data.set_sharp_from_angle(angle=math.radians(30))
    for edge in made.data.edges:  # four sheets of steel
        if all(edge.index >= 0 and _is_weld(made.data.vertices[k].co) for k in edge.vertices):
            edge.use_seam = True
    return made


def _is_weld(place: Any) -> bool:
    turn = math.degrees(math.atan2(place.y, place.x)) % 90.0
    return min(turn, 90.0 - turn) < 1.0


def field() -> bpy.types.Object:
    made, vertices = grid("Field", 2.0, 40)
    x, y = vertices[:, 0], vertices[:, 1]
    vertices[:, 2] = 0.35 + 0.16 * np.sin(1.7 * x + 0.6) * np.cos(2.1 * y) + 0.08 * x
    move_vertices(made, vertices)
    made.data.materials.append(material("Grass", (0.16, 0.28, 0.07), 0.9))
    return made


def cushion() -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=1.7, location=(2.6, 0, 0.5))
    made = bpy.context.object
    made.scale, made.rotation_euler.z = (1.0, 1.0, 0.55), math.radians(25)
    bpy.ops.object.transform_apply(location=False, rotation=False)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=3)
    bpy.ops.object.mode_set(mode="OBJECT")
    made.modifiers.new("Rounding", "SUBSURF").render_levels = 3
    made.modifiers["Rounding"].levels = 3
    made.data.shade_smooth()
    for edge in made.data.edges:
        edge.use_seam = all(_is_seam(made.data.vertices[k].co) for k in edge.vertices)
    made.data.materials.append(material("Leather", (0.36, 0.10, 0.05), 0.5))
    return made


def _is_seam(place: Any) -> bool:
    """Around the sides, and across the top."""
    return abs(place.z) < 1e-4 or (abs(place.x) < 1e-4 and place.z > -1e-4)


def solid(
    name: str, size: tuple[float, float, float], color: Any, up: float = 0.0
) -> bpy.types.Object:
    """A box that stands at height `up`, of which only the instances are to be seen."""
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    made = bpy.context.object
    made.name = name
    for vertex in made.data.vertices:
        for k in range(3):
            vertex.co[k] *= size[k]
        vertex.co.z += up
    made.modifiers.new("Bevel", "BEVEL").width = 0.25 * min(size)
    made.data.materials.append(material(name, color, 0.5))
    return hidden(made)


def rivet() -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.035)
    made = bpy.context.object
    made.data.shade_smooth()
    made.data.materials.append(material("Rivet", (0.75, 0.62, 0.35), 0.3))
    return hidden(made)


def along(surface: bpy.types.Object, given: Any, share: float, thing: Any, **settings: Any) -> int:
    """A scatter along the edges of a surface; the number of its points."""
    made = scatter(surface, max(round(share * given.count), 1), given.seed)
    made.dapple.scatter_on = "EDGES"
    for name, value in settings.items():
        setattr(made.dapple, name, value)
    bpy.ops.dapple.optimize()
    made.dapple.instance = thing
    return int(made.dapple.report.count)


def main() -> None:
    given = options(__doc__, 400, "things").parse_args()
    begin()
    seams = {"edge_creases": False, "edge_borders": False, "edge_seams": True}
    post = solid("Post", (0.05, 0.035, 0.26), (0.45, 0.28, 0.14), 0.11)
    stitch = solid("Stitch", (0.055, 0.018, 0.018), (0.9, 0.8, 0.6))
    count = along(tank(), given, 0.5, rivet(), edge_seams=True)
    count += along(field(), given, 0.15, post, edge_creases=False, align_to_normal=0.0)
    count += along(cushion(), given, 0.35, stitch, **seams)
    build_studio(given.width, given.width // 3, (0.0, -8.6, 4.6), (0.0, 0.0, 0.45), 42)
    finish("edges", given, f"{count} things along edges")


if __name__ == "__main__":
    run(main)
