# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes with the inputs of a result: weights, images, a camera, obstacles; and
messages about it.
"""

import addon_host
import bpy
import numpy as np
import scenes


def reason(obj):
    bpy.context.view_layer.update()
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def note(obj):
    bpy.context.view_layer.update()
    return addon_host.part("blender.freshness.staleness").verdict(obj, bpy.context).note


def linked(obj, collection=None):
    (collection or bpy.context.scene.collection).objects.link(obj)
    return obj


def weighed(surface, name="Grass"):
    group = surface.vertex_groups.new(name=name)
    group.add(range(len(surface.data.vertices)), 0.5, "REPLACE")
    group.add(range(40), 1.0, "REPLACE")
    return group


def colored(surface, name="Moss"):
    attribute = surface.data.attributes.new(name, "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.linspace(0.5, 1.0, len(attribute.data)))
    return attribute


def picture(name="Picture"):
    image = bpy.data.images.new(name, 4, 4)
    pixels = np.linspace(0.5, 1.0, 64, dtype=np.float32).reshape(-1, 4)
    pixels[:, 3] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    return image


def camera():
    made = linked(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    made.location = (0.0, 0.0, 2.0)
    bpy.context.scene.camera = made
    return made


def obstacle():
    mesh = bpy.data.meshes.new("Stone")
    mesh.from_pydata([(0, 0, 2), (1, 0, 2), (0, 1, 2), (0, 0, 3)], [], [(0, 1, 2), (0, 1, 3)])
    collection = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(collection)
    return linked(bpy.data.objects.new("Stone", mesh), collection)


def solved(surface, **density):
    obj = scenes.scattered(surface)
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == note(obj) == ""
    return obj
