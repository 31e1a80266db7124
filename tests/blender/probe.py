# SPDX-License-Identifier: GPL-3.0-or-later
"""A render engine that draws nothing and records the data of the render's own evaluation."""

from contextlib import contextmanager
from types import SimpleNamespace

import bpy
import numpy as np
import scenes


class ProbeEngine(bpy.types.RenderEngine):
    bl_idname = "DAPPLE_TESTS_PROBE"
    bl_label = "Probe"
    watched = ""  # name of a scatter object
    seen = ()
    read = None  # reads further values from the surface and the render's depsgraph

    def render(self, depsgraph):
        obj = bpy.data.objects[ProbeEngine.watched]
        surface = obj.dapple.surface if obj.dapple.surface else obj
        evaluated = surface.evaluated_get(depsgraph)
        ProbeEngine.seen += (
            {
                "mode": depsgraph.mode,
                "frame": depsgraph.scene.frame_current + depsgraph.scene.frame_subframe,
                "positions": scenes.positions(obj, depsgraph),
                "surface_vertices": len(evaluated.to_mesh().vertices),
                "surface": ProbeEngine.read(surface, depsgraph) if ProbeEngine.read else None,
            },
        )
        self.empty_picture(depsgraph.scene)

    def empty_picture(self, scene):
        result = self.begin_result(0, 0, scene.render.resolution_x, scene.render.resolution_y)
        pixels = np.zeros((scene.render.resolution_x * scene.render.resolution_y, 4), np.float32)
        result.layers[0].passes["Combined"].rect = pixels
        self.end_result(result)


@contextmanager
def registered(engine=ProbeEngine):
    bpy.utils.register_class(engine)
    try:
        yield
    finally:
        bpy.utils.unregister_class(engine)


def prepare(engine):
    """Use this engine for small renders of the scene."""
    scene = bpy.context.scene
    scene.render.engine = engine.bl_idname
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.render.resolution_percentage = 100
    if scene.camera is None:
        scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        scene.collection.objects.link(scene.camera)


def triangles(surface, depsgraph):
    """Vertices in world space and triangles of a mesh as a depsgraph has it."""
    evaluated = surface.evaluated_get(depsgraph)
    mesh, matrix = evaluated.to_mesh(), np.array(evaluated.matrix_world)
    places = np.array([vertex.co for vertex in mesh.vertices], dtype=np.float64).reshape(-1, 3)
    mesh.calc_loop_triangles()
    faces = np.array([one.vertices for one in mesh.loop_triangles], dtype=np.int32)
    return SimpleNamespace(vertices=places @ matrix[:3, :3].T + matrix[:3, 3], faces=faces)


def render(obj, frame, subframe=0.0, read=None):
    """Data of a scatter object and its surface in a render of this frame."""
    prepare(ProbeEngine)
    ProbeEngine.watched, ProbeEngine.seen, ProbeEngine.read = obj.name, (), read
    bpy.context.scene.frame_set(frame, subframe=subframe)
    bpy.ops.render.render()
    return ProbeEngine.seen[-1]
