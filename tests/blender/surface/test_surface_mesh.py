# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that are read in bulk equal those that Blender gives element by element."""

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
    reading = addon_host.part("blender.surface.mesh")
    corners = addon_host.part("blender.base.mesh_arrays")
    mesh = bpy.data.meshes.new("Faces")
    mesh.from_pydata(PLACES, [], faces)
    obj = bpy.data.objects.new("Faces", mesh)
    bpy.context.collection.objects.link(obj)
    obj.location = (1, 2, 3)
    found = reading.read_mesh(obj)
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
def test_a_surface_is_read_with_the_triangles_and_weights_of_blender(kind):
    surface = of_kind(kind)
    found = addon_host.part("blender.surface.reading").read(surface, asked_for("Grass", kind))
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix, mesh = np.array(evaluated.matrix_world), evaluated.to_mesh()
    mesh.calc_loop_triangles()
    expected = np.array([one.vertices for one in mesh.loop_triangles])
    if kind == "mirrored":
        expected = expected[:, ::-1]
    places = np.array([vertex.co for vertex in mesh.vertices], dtype=np.float64)
    np.testing.assert_array_equal(found.faces, expected)
    np.testing.assert_allclose(found.vertices, places @ matrix[:3, :3].T + matrix[:3, 3])
    np.testing.assert_array_equal(found.matrix, matrix)
    if kind != "meta":
        weights = [vertex.groups[0].weight for vertex in mesh.vertices]
        np.testing.assert_allclose(found.weights["Grass"], weights, rtol=1e-6)


def asked_for(name, kind=""):
    settings = addon_host.part("core.settings.values")
    density = settings.DensitySettings(attribute="" if kind == "meta" else name)
    return settings.Settings(density=density)


@pytest.mark.parametrize("mode", ["OBJECT", "WEIGHT_PAINT", "EDIT"])
def test_reading_a_group_leaves_nothing_behind(mode):
    surface = of_kind("quads")
    surface.shape_key_add(name="Basis")
    surface.shape_key_add(name="Tall").value = 0.5
    bpy.ops.object.mode_set(mode=mode)
    bpy.context.view_layer.update()
    before = [len(blocks) for blocks in (bpy.data.objects, bpy.data.meshes, bpy.data.shape_keys)]
    found = addon_host.part("blender.surface.reading").read(surface, asked_for("Grass"))
    bpy.ops.object.mode_set(mode="OBJECT")
    weights = [vertex.groups[0].weight for vertex in surface.data.vertices]
    assert found.weights["Grass"].tolist() == weights
    after = [len(blocks) for blocks in (bpy.data.objects, bpy.data.meshes, bpy.data.shape_keys)]
    assert after == before


def test_reading_a_group_is_no_change_of_the_artist(live):
    surface = of_kind("quads")
    heard = []
    quiet = addon_host.part("blender.base.quiet")
    bpy.app.handlers.depsgraph_update_post.append(lambda *_: heard.append(quiet.is_quiet()))
    try:
        addon_host.part("blender.surface.reading").read(surface, asked_for("Grass"))
        bpy.context.view_layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.pop()
    assert all(heard)


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
def test_values_are_those_of_the_attribute(domain, kind):
    surface = of_kind("quads")
    attribute = surface.data.attributes.new("Moss", kind, domain)
    random = np.random.Generator(np.random.PCG64(5))
    width = 4 if kind == "BYTE_COLOR" else 1
    values = random.random(width * len(attribute.data)).astype(np.float32)
    attribute.data.foreach_set("color" if width == 4 else "value", values)
    found = addon_host.part("blender.surface.reading").read(surface, asked_for("Moss"))
    stored = np.array(
        [one.color if width == 4 else (one.value,) * 3 for one in attribute.data], dtype=np.float64
    )
    numbers = stored[:, :3].mean(axis=1)
    if domain == "FACE":
        mesh = surface.data
        mesh.calc_loop_triangles()
        numbers = numbers[[one.polygon_index for one in mesh.loop_triangles]][:, None]
    elif domain == "CORNER":
        numbers = numbers[found.loops]
    np.testing.assert_allclose(found.weights["Moss"], numbers, rtol=1e-6)
