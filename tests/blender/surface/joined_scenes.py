# SPDX-License-Identifier: GPL-3.0-or-later
"""Joined surfaces for tests."""

import addon_host
import bpy


def tile(name, location, scale=(1.0, 1.0, 1.0), cuts=8):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, location=location)
    obj = bpy.context.object
    obj.name, obj.scale = name, scale
    return obj


def tiles():
    """Three that touch; the middle one is mirrored."""
    made = [
        tile("Left", (0, 0, 0)),
        tile("Middle", (2, 0, 0), (-1, 1, 1)),
        tile("Right", (4, 0, 0)),
    ]
    bpy.context.view_layer.update()
    return made


def select(*objects):
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]


def over(*objects, **options):
    select(*objects)
    assert bpy.ops.dapple.add_scatter(**options) == {"FINISHED"}
    return bpy.context.object


def reason(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def collection_of(*objects, name="Terrain"):
    made = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(made)
    for obj in objects:
        made.objects.link(obj)
        bpy.context.scene.collection.objects.unlink(obj)
    return made


def cloth(rig_of):
    """A wider tube over an animated tail, carried by the same bones."""
    over_it = rig_of.copy()
    over_it.data, over_it.name = rig_of.data.copy(), "Cloth"
    bpy.context.collection.objects.link(over_it)
    for vertex in over_it.data.vertices:
        vertex.co.x *= 1.2
        vertex.co.y *= 1.2
    return over_it
