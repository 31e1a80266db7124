# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes read in bulk are what Blender says of each vertex, corner and triangle."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from mathutils import Vector

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
    reading = addon_host.part("blender.surface.surface_mesh")
    corners = addon_host.part("blender.base.mesh_arrays")
    mesh = bpy.data.meshes.new("Faces")
    mesh.from_pydata(PLACES, [], faces)
    obj = bpy.data.objects.new("Faces", mesh)
    bpy.context.collection.objects.link(obj)
    obj.location = (1, 2, 3)
    found = reading.read_surface(obj, bpy.context.evaluated_depsgraph_get())
    mesh.calc_loop_triangles()
    expected = [tuple(triangle.vertices) for triangle in mesh.loop_triangles]
    assert [tuple(face) for face in found.faces] == expected
    assert np.allclose(found.vertices, np.add(PLACES, (1, 2, 3)))
    at_corners = [loop.vertex_index for loop in mesh.loops]
    assert corners.corner_vertices(mesh).tolist() == at_corners


def test_weights_of_a_group_are_those_of_each_vertex():
    weights = addon_host.part("blender.surface.values")
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
        assert weights.read_weights(obj, mesh, name).values.tolist() == expected
    assert max(expected) == 0.25
    empty = scenes.sphere()
    empty.vertex_groups.new(name="unused")
    mesh = empty.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert not weights.read_weights(empty, mesh, "unused").values.any()


@pytest.mark.parametrize("kind", ["ico", "quads", "concave", "ngons", "mirrored", "meta"])
def test_a_surface_read_in_parts_is_the_one_that_is_read_at_once(kind):
    surface = of_kind(kind)
    parts, held = (
        addon_host.part("blender.surface.parts"),
        addon_host.part("blender.base.object_handles"),
    )
    settings = addon_host.part("core.settings.values")
    asked = settings.Settings(density=settings.DensitySettings(attribute="Grass"))
    if kind == "meta":
        asked = settings.Settings()
    steps = addon_host.part("core.base.steps")
    read = steps.run_now(parts.read_parts(asked, held.Held(surface), held.Held(surface)))
    found = read.arrays()
    expected = addon_host.part("blender.surface.surroundings").read_with(
        asked, surface, bpy.context.evaluated_depsgraph_get()
    )
    for name in ("vertices", "faces", "matrix"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    assert found.topology == expected.topology
    for name, values in expected.weights.items():
        np.testing.assert_allclose(found.weights[name], values, rtol=1e-6)


def of_kind(kind):
    if kind == "meta":
        bpy.ops.object.metaball_add()
        return bpy.context.object
    if kind == "ico":
        bpy.ops.mesh.primitive_ico_sphere_add()
    else:
        scenes.sphere() if kind == "ngons" else bpy.ops.mesh.primitive_grid_add()
    surface = bpy.context.object
    random = np.random.Generator(np.random.PCG64(4))
    if kind == "concave":
        for vertex in surface.data.vertices:
            vertex.co += Vector(random.normal(0.0, 0.3, 3).tolist())
    if kind == "ngons":
        surface.modifiers.new("Dual", "DECIMATE").decimate_type = "DISSOLVE"
        surface.modifiers["Dual"].angle_limit = 0.4
    if kind == "mirrored":
        surface.scale = (-1.0, 2.0, 1.0)
    group = surface.vertex_groups.new(name="Grass")
    for vertex in surface.data.vertices:
        group.add([vertex.index], float(random.random()), "REPLACE")
    bpy.context.view_layer.update()
    return surface


@pytest.mark.parametrize("domain", ["POINT", "FACE", "CORNER"])
@pytest.mark.parametrize("kind", ["FLOAT", "BYTE_COLOR"])
def test_values_read_in_parts_are_those_that_are_read_at_once(domain, kind):
    surface = of_kind("quads")
    attribute = surface.data.attributes.new("Moss", kind, domain)
    random = np.random.Generator(np.random.PCG64(5))
    width = 4 if kind == "BYTE_COLOR" else 1
    values = random.random(width * len(attribute.data)).astype(np.float32)
    attribute.data.foreach_set("color" if width == 4 else "value", values)
    settings, parts = (
        addon_host.part("core.settings.values"),
        addon_host.part("blender.surface.parts"),
    )
    held, steps = addon_host.part("blender.base.object_handles"), addon_host.part("core.base.steps")
    asked = settings.Settings(density=settings.DensitySettings(attribute="Moss"))
    read = steps.run_now(parts.read_parts(asked, held.Held(surface), held.Held(surface)))
    expected = addon_host.part("blender.surface.surroundings").read_with(
        asked, surface, bpy.context.evaluated_depsgraph_get()
    )
    np.testing.assert_array_equal(read.arrays().weights["Moss"], expected.weights["Moss"])
