# SPDX-License-Identifier: GPL-3.0-or-later
"""Studs on the ground where a camera at the left sees it, not behind the stones.

Run through `blend_examples/run.sh seen`, which sets everything up.
"""

from __future__ import annotations

import bpy

from blend_examples.scene import begin, build_studio, finish, hidden, options, run, scatter
from blend_examples.studio import aim, material

_STONES = ((-0.9, 0.0, 0.45), (0.8, 1.0, 0.35), (0.7, -1.1, 0.5))  # x, y and radius
_EYE = (-3.4, 0.0, 1.0)


def ground() -> bpy.types.Object:
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    made = bpy.context.object
    made.scale = (2.4, 1.8, 1.0)
    made.data.materials.append(material("Ground", (0.10, 0.13, 0.10), 0.9))
    return made


def stones() -> bpy.types.Collection:
    made = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(made)
    gray = material("Stone", (0.42, 0.40, 0.38), 0.8)
    for x, y, radius in _STONES:
        bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=(x, y, 0.6 * radius))
        stone = bpy.context.object
        stone.data.shade_smooth()
        stone.data.materials.append(gray)
        made.objects.link(stone)
    return made


def eye() -> bpy.types.Object:
    """A camera at the left that looks at the ground, and a body that shows it."""
    made = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    made.data.lens = 30
    bpy.context.scene.collection.objects.link(made)
    aim(made, _EYE, (0.0, 0.0, 0.1))
    bpy.ops.mesh.primitive_cone_add(vertices=4, radius1=0.3, radius2=0.1, depth=0.4)
    body = bpy.context.object
    body.location, body.rotation_euler = made.location, made.rotation_euler
    for vertex in body.data.vertices:  # the wide end ahead
        vertex.co.z *= -1.0
    body.data.materials.append(material("Eye", (0.05, 0.05, 0.06), 0.4))
    return made


def main() -> None:
    given = options(__doc__, 900, "studs").parse_args()
    begin()
    scene, surface, hiding = bpy.context.scene, ground(), stones()
    scene.camera = eye()
    made = scatter(surface, given.count, given.seed)
    scene.render.resolution_x, scene.render.resolution_y = 1600, 900
    density = made.dapple.density
    density.use_camera_view, density.camera_margin, density.camera_hidden = True, 0.0, True
    density.hiding_collection = hiding
    bpy.ops.dapple.optimize()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, radius=0.035)
    stud = bpy.context.object
    stud.data.materials.append(material("Stud", (0.9, 0.55, 0.1), 0.4))
    made.dapple.instance = hidden(stud)
    build_studio(given.width, given.width // 2, (0.6, -6.0, 5.6), (-0.4, 0.0, 0.1), 38)
    finish("seen", given, f"{given.count} studs that the camera sees")


if __name__ == "__main__":
    run(main)
