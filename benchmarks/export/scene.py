# SPDX-License-Identifier: GPL-3.0-or-later
"""A scatter of two objects on a surface that is twisted, baked."""

from __future__ import annotations

import bpy
import numpy as np

COUNT = 100
FRAMES = range(1, 5)


def scattered(subdivided: bool) -> bpy.types.Object:
    """In a new file; the surface may have a modifier that subdivides it."""
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FRAMES[0], FRAMES[-1]
    surface = _surface(subdivided)
    things = bpy.data.collections.new("Things")
    scene.collection.children.link(things)
    for name, size in (("Pine", 0.1), ("Oak", 0.15)):
        things.objects.link(_cube(name, size))
    bpy.context.view_layer.objects.active = surface
    surface.select_set(True)
    bpy.ops.dapple.add_scatter(count=COUNT)
    scatter = bpy.context.object
    scatter.dapple.collection = things
    scatter.dapple.random_scale_down = 0.5
    bpy.ops.dapple.bake()
    scene.frame_set(FRAMES[0])
    return scatter


def _surface(subdivided: bool) -> bpy.types.Object:
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=4)
    surface = bpy.context.object
    twist = surface.modifiers.new("Twist", "SIMPLE_DEFORM")
    twist.deform_method, twist.deform_axis = "TWIST", "X"
    for frame, angle in ((FRAMES[0], 0.0), (FRAMES[-1], 2.0)):
        twist.angle = angle
        twist.keyframe_insert("angle", frame=frame)
    if subdivided:
        subdivision = surface.modifiers.new("Subdivision", "SUBSURF")
        subdivision.levels = subdivision.render_levels = 1
    return surface


def _cube(name: str, size: float) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=size, location=(9, 9, 9))
    cube = bpy.context.object
    cube.name = name
    for collection in cube.users_collection:
        collection.objects.unlink(cube)
    return cube


def matrices(scatter: bpy.types.Object, frame: int) -> np.ndarray:
    """Of all instances (n, 4, 4), on a frame."""
    bpy.context.scene.frame_set(frame)
    found = [
        np.array(one.matrix_world)
        for one in bpy.context.evaluated_depsgraph_get().object_instances
        if one.is_instance and one.parent.original == scatter
    ]
    return np.array(found)
