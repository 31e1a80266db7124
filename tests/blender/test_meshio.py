# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes read in bulk are what Blender says of each vertex, corner and triangle."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes

FACES = {
    "triangles": [(0, 1, 2), (0, 2, 3), (0, 3, 4)],
    "quads": [(0, 1, 2, 3), (0, 3, 4, 5)],
    "dented quad": [(0, 1, 6, 3), (0, 3, 4, 5)],
    "all kinds": [(0, 1, 2), (0, 2, 3, 4), (5, 0, 4, 6, 1)],
    "none": [],
}
PLACES = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 1), (-2, 2, 0), (-2, 0, 0), (0.2, 0.1, 0)]


@pytest.mark.parametrize("faces", FACES.values(), ids=FACES.keys())
def test_a_surface_has_the_triangles_and_corners_of_its_mesh(faces):
    meshio, corners = addon_host.part("blender.meshio"), addon_host.part("blender.corners")
    mesh = bpy.data.meshes.new("Faces")
    mesh.from_pydata(PLACES, [], faces)
    obj = bpy.data.objects.new("Faces", mesh)
    bpy.context.collection.objects.link(obj)
    obj.location = (1, 2, 3)
    found = meshio.read_surface(obj, bpy.context.evaluated_depsgraph_get())
    mesh.calc_loop_triangles()
    expected = [tuple(triangle.vertices) for triangle in mesh.loop_triangles]
    assert [tuple(face) for face in found.faces] == expected
    assert np.allclose(found.vertices, np.add(PLACES, (1, 2, 3)))
    at_corners = [loop.vertex_index for loop in mesh.loops]
    assert corners.corner_vertices(mesh).tolist() == at_corners


def test_weights_of_a_group_are_those_of_each_vertex():
    weights = addon_host.part("blender.weights")
    obj = scenes.tail()
    other = obj.vertex_groups.new(name="some")
    other.add([3, 5], 0.25, "REPLACE")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = obj.evaluated_get(depsgraph).to_mesh()
    for name in ("root", "tip", "some"):
        index = obj.vertex_groups[name].index
        expected = [
            sum(element.weight for element in vertex.groups if element.group == index)
            for vertex in mesh.vertices
        ]
        assert weights.read_weights(obj, mesh, name).tolist() == expected
    assert max(expected) == 0.25
    empty = scenes.sphere()
    empty.vertex_groups.new(name="unused")
    mesh = empty.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert not weights.read_weights(empty, mesh, "unused").any()
