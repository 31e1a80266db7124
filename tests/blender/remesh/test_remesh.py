# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple: the new mesh, and data taken over from the old one."""

import math

import bmesh
import bpy
import dapple3d as dapple
import numpy as np
import pytest
import scenes


def cube(size=2.0):
    bpy.ops.mesh.primitive_cube_add(size=size)
    return bpy.context.object


def remeshed(obj, **given):
    assert bpy.ops.dapple.remesh(**given) == {"FINISHED"}
    assert not obj.data.validate()
    return obj.data


def positions(mesh):
    found = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def volume(mesh):
    total = 0.0
    for polygon in mesh.polygons:
        a, b, c = (mesh.vertices[k].co for k in polygon.vertices)
        total += a.dot(b.cross(c)) / 6
    return total


def test_a_cube_keeps_its_corners_and_volume():
    obj = cube()
    mesh = remeshed(obj, count=300)
    assert len(mesh.vertices) == 300
    assert {len(p.vertices) for p in mesh.polygons} == {3}
    assert volume(mesh) == pytest.approx(8, rel=1e-5)
    corners = np.abs(positions(mesh)).min(axis=1) > 1 - 1e-6
    assert corners.sum() == 8


def test_name_and_modifiers_and_parent_stay():
    obj, parent = cube(), bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    obj.parent = parent
    obj.modifiers.new("Bevel", "BEVEL").width = 0.03
    name = obj.data.name
    remeshed(obj, count=100)
    assert obj.data.name == name
    assert obj.modifiers["Bevel"].width == pytest.approx(0.03)
    assert obj.parent == parent
    assert [mesh.name for mesh in bpy.data.meshes] == [name]


def test_an_object_that_shares_its_mesh_leaves_the_other_alone():
    obj = cube()
    other = obj.copy()
    bpy.context.collection.objects.link(other)
    remeshed(obj, count=100)
    assert len(other.data.vertices) == 8


def test_texture_coordinates_are_where_they_were():
    """Each side of the cube has its own part of the image; seams stay seams."""
    obj = cube()
    corners = {tuple(np.round(obj.data.vertices[k].co, 3)) for k in range(8)}
    mesh = remeshed(obj, count=300)
    assert len(corners) == 8
    layer = mesh.uv_layers.active.uv
    places = positions(mesh)
    area = 0.0
    for polygon in mesh.polygons:
        a, b, c = (np.array(layer[k].vector) for k in polygon.loop_indices)
        twice = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]
        u, v, w = places[list(polygon.vertices)]
        real = np.linalg.norm(np.cross(v - u, w - u))
        assert abs(twice) / real == pytest.approx(0.25**2 / 4, rel=1e-3)
        area += abs(twice) / 2
    assert area == pytest.approx(6 / 16, rel=1e-4)


def test_vertex_groups_and_shape_keys_are_mixed():
    obj = cube()
    top = obj.vertex_groups.new(name="Top")
    top.add([v.index for v in obj.data.vertices if v.co.z > 0], 1.0, "REPLACE")
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Taller")
    key.value, key.slider_max = 0.5, 2.0
    for vertex, point in zip(obj.data.vertices, key.data, strict=True):
        point.co.z = 3 * vertex.co.z
    mesh = remeshed(obj, count=200)
    heights = positions(mesh)[:, 2]
    weights = [
        next((g.weight for g in vertex.groups if g.group == 0), 0.0) for vertex in mesh.vertices
    ]
    np.testing.assert_allclose(weights, (heights + 1) / 2, atol=1e-5)
    taller = mesh.shape_keys.key_blocks["Taller"]
    assert (taller.value, taller.slider_max) == (0.5, 2.0)
    np.testing.assert_allclose([p.co.z for p in taller.data], 3 * heights, atol=1e-5)


def test_materials_and_attributes_and_seams_stay():
    obj = cube()
    for name in ("Red", "Blue"):
        obj.data.materials.append(bpy.data.materials.new(name))
    for polygon in obj.data.polygons:
        polygon.material_index = int(polygon.normal.z > 0.5)
    number = obj.data.attributes.new("number", "INT", "FACE")
    number.data.foreach_set("value", np.arange(6, dtype=np.int32))
    height = obj.data.attributes.new("height", "FLOAT", "POINT")
    height.data.foreach_set("value", positions(obj.data)[:, 2].copy())
    for edge in obj.data.edges:
        edge.use_seam = all(obj.data.vertices[k].co.z > 0 for k in edge.vertices)
    mesh = remeshed(obj, count=200)
    assert [one.name for one in mesh.materials] == ["Red", "Blue"]
    for polygon in mesh.polygons:
        assert polygon.material_index == int(polygon.normal.z > 0.5)
    sides = {}
    for polygon, value in zip(mesh.polygons, mesh.attributes["number"].data, strict=True):
        sides.setdefault(tuple(np.round(polygon.normal)), set()).add(value.value)
    assert sorted(value for values in sides.values() for value in values) == list(range(6))
    found = np.empty(len(mesh.vertices), np.float32)
    mesh.attributes["height"].data.foreach_get("value", found)
    np.testing.assert_allclose(found, positions(mesh)[:, 2], atol=1e-5)
    length = sum(
        (mesh.vertices[e.vertices[0]].co - mesh.vertices[e.vertices[1]].co).length
        for e in mesh.edges
        if e.use_seam
    )
    assert length == pytest.approx(8, rel=1e-5)


def test_the_mask_and_the_face_sets_of_a_sculpt_stay():
    """The mask was gone, and all faces were in one set."""
    mesh = scenes.sphere().data
    mask = mesh.attributes.new(".sculpt_mask", "FLOAT", "POINT")
    mask.data.foreach_set("value", [float(v.co.z > 0.0) for v in mesh.vertices])
    sets = mesh.attributes.new(".sculpt_face_set", "INT", "FACE")
    sets.data.foreach_set("value", [3 if p.center.x > 0.0 else 8 for p in mesh.polygons])
    mesh = remeshed(bpy.context.object, count=400)
    for vertex, value in zip(mesh.vertices, mesh.attributes[".sculpt_mask"].data, strict=True):
        if abs(vertex.co.z) > 0.3:
            assert value.value == pytest.approx(float(vertex.co.z > 0.0), abs=1e-5)
    for polygon, value in zip(mesh.polygons, mesh.attributes[".sculpt_face_set"].data, strict=True):
        if abs(polygon.center.x) > 0.3:
            assert value.value == (3 if polygon.center.x > 0.0 else 8)


def test_it_deforms_with_its_armature_as_before():
    obj = scenes.tail(levels=0, render_levels=0)
    bpy.context.scene.frame_set(6)
    before = evaluated_bounds(obj)
    remeshed(obj, count=400)
    after = evaluated_bounds(obj)
    np.testing.assert_allclose(after, before, atol=0.05)


def evaluated_bounds(obj):
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    found = positions(mesh)
    return np.array([found.min(axis=0), found.max(axis=0)])


def test_a_scaled_object_gets_even_triangles_in_the_world():
    obj = scenes.sphere(scale=(3.0, 1.0, 1.0))
    mesh = remeshed(obj, count=500)
    matrix = np.array(obj.matrix_world)[:3, :3]
    places = positions(mesh) @ matrix.T
    lengths = [np.linalg.norm(places[a] - places[b]) for a, b in (e.vertices for e in mesh.edges)]
    assert np.std(lengths) < 0.2 * np.mean(lengths)


def test_fewer_vertices_than_the_topology_needs_are_said(capfd):
    obj = cube()
    mesh = remeshed(obj, count=4)
    assert "need 4 more vertices" in capfd.readouterr().out
    assert len(mesh.vertices) == 8


def test_vertices_are_added_until_the_mesh_is_near(capfd):
    obj = scenes.sphere()
    before = positions(obj.data)
    mesh = remeshed(obj, count=40, max_distance=0.02)
    added = len(mesh.vertices) - 40
    assert f"Max Distance needs {added} more vertices" in capfd.readouterr().out
    faces = np.array([polygon.vertices[:] for polygon in mesh.polygons])
    surface = dapple.Surface(positions(mesh).astype(float), faces)
    assert dapple.project(surface, before.astype(float)).distances.max() < 0.0201


def test_an_angle_of_180_degrees_keeps_no_creases():
    obj = cube()
    obj.data.uv_layers.remove(obj.data.uv_layers[0])  # its seams would stay
    mesh = remeshed(obj, count=200, feature_angle=math.pi)
    assert len(mesh.vertices) == 200
    corner = np.abs(positions(mesh)).min(axis=1).max()
    assert corner < 0.999


def test_adaptive_vertices_keep_the_shape_better():
    def farthest(**options):
        bpy.ops.mesh.primitive_torus_add(major_segments=120, minor_segments=60)
        obj = bpy.context.object
        obj.scale.z = 0.2
        bpy.ops.object.transform_apply()
        before = positions(obj.data).astype(float)
        mesh = remeshed(obj, count=1200, feature_angle=math.pi, **options)
        assert len(mesh.vertices) == 1200
        faces = np.array([polygon.vertices[:] for polygon in mesh.polygons])
        surface = dapple.Surface(positions(mesh).astype(float), faces)
        return dapple.project(surface, before).distances.max()

    assert farthest(adaptive=True) < 0.75 * farthest()


def upper_share(mesh):
    return (positions(mesh)[:, 2] > 0.0).mean()


def test_a_vertex_group_is_the_density():
    obj = scenes.sphere()
    upper = [v.index for v in obj.data.vertices if v.co.z > 0.0]
    obj.vertex_groups.new(name="Fine").add(range(len(obj.data.vertices)), 0.2, "REPLACE")
    obj.vertex_groups["Fine"].add(upper, 1.0, "REPLACE")
    mesh = remeshed(obj, count=400, density="Fine")
    assert len(mesh.vertices) == 400
    assert upper_share(mesh) > 0.7


def test_the_density_is_that_before_modifiers_and_keys():
    obj = scenes.sphere()
    upper = [v.index for v in obj.data.vertices if v.co.z > 0.0]
    obj.vertex_groups.new(name="Fine").add(upper, 1.0, "REPLACE")
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Large").data[0].co.z = 3.0
    obj.modifiers.new("Subdivision", "SUBSURF")
    assert upper_share(remeshed(obj, count=400, density="Fine")) > 0.9


@pytest.mark.parametrize("domain", ["POINT", "FACE", "CORNER"])
def test_an_attribute_is_the_density(domain):
    obj = scenes.sphere()
    heights = {
        "POINT": [v.co.z for v in obj.data.vertices],
        "FACE": [p.center.z for p in obj.data.polygons],
        "CORNER": [obj.data.vertices[one.vertex_index].co.z for one in obj.data.loops],
    }[domain]
    attribute = obj.data.attributes.new("Fine", "FLOAT", domain)
    attribute.data.foreach_set("value", [1.0 if z > 0.0 else 0.0 for z in heights])
    mesh = remeshed(obj, count=400, density="Fine")
    assert upper_share(mesh) > 0.9
    assert positions(mesh)[:, 2].min() < -0.9  # there is something everywhere


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Gone", "Surface 'Sphere' has no attribute or vertex group 'Gone'"),
        ("Empty", "'Sphere': the density is 0 everywhere"),
        ("Low", "Surface 'Sphere': 'Low' is -1 at vertex 0"),
    ],
)
def test_a_density_that_is_none_is_told(name, message):
    obj = scenes.sphere()
    obj.vertex_groups.new(name="Empty")
    low = obj.data.attributes.new("Low", "FLOAT", "POINT")
    low.data.foreach_set("value", [-1.0] * len(obj.data.vertices))
    before = len(obj.data.vertices)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.dapple.remesh(count=100, density=name)
    assert len(obj.data.vertices) == before


def test_a_mesh_with_keys_follows_the_density():
    obj = scenes.tail(levels=0, frames=3)
    middle = np.median(positions(obj.data)[:, 2])
    upper = [v.index for v in obj.data.vertices if v.co.z > middle]
    obj.vertex_groups.new(name="Fine").add(upper, 1.0, "REPLACE")
    given = {"animation": "SHAPE_KEYS", "frame_start": 1, "frame_end": 3}
    mesh = remeshed(obj, count=300, density="Fine", **given)
    assert (positions(mesh)[:, 2] > middle).mean() > 0.8


def test_a_distance_that_is_out_of_reach_is_told(capfd):
    obj = scenes.sphere()
    remeshed(obj, count=8, max_distance=1e-7)
    assert "away from the old one, more than Max Distance" in capfd.readouterr().out


def test_a_mesh_without_faces_is_left_alone():
    obj = cube()
    obj.data.clear_geometry()
    obj.data.vertices.add(3)
    with pytest.raises(RuntimeError, match="'Cube' has no faces"):
        bpy.ops.dapple.remesh(count=50)
    assert len(obj.data.vertices) == 3


def test_loose_edges_that_are_lost_are_told(capfd):
    mesh = cube().data
    mesh.vertices.add(3)
    mesh.vertices[8].co.x = 3.0
    mesh.edges.add(1)
    mesh.edges[-1].vertices = (8, 9)
    mesh.update()
    mesh = remeshed(bpy.context.object, count=100)
    assert len(mesh.vertices) == 100
    assert "3 vertices without faces were left out" in capfd.readouterr().out
    remeshed(bpy.context.object, count=100)
    assert "left out" not in capfd.readouterr().out


def test_faces_that_only_modifiers_make_are_told_from_none():
    """As those of geometry nodes, and of a baked sequence: the artist sees some."""
    obj = cube()
    obj.data.clear_geometry()
    obj.data.vertices.add(2)
    obj.data.vertices[1].co.x = 1.0
    obj.data.edges.add(1)
    obj.data.edges[0].vertices = (0, 1)
    screw = obj.modifiers.new("Screw", "SCREW")
    screw.screw_offset = 1.0
    message = "'Cube' has no faces of its own, its modifiers make them: apply them first"
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.dapple.remesh(count=50)
    assert len(obj.data.vertices) == 2
    bpy.ops.object.convert(target="MESH")
    assert len(remeshed(obj, count=200).vertices) >= 200


def test_needs_object_mode():
    cube()
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.dapple.remesh.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.dapple.remesh.poll()


def test_undo_brings_the_old_mesh_back():
    cube()
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.dapple.remesh(count=100)
    bpy.ops.ed.undo_push(message="remesh")
    bpy.ops.ed.undo()
    assert len(bpy.context.object.data.vertices) == 8


def corner_normals(mesh):
    found = np.empty(3 * len(mesh.loops), np.float32)
    mesh.corner_normals.foreach_get("vector", found)
    return found.reshape(-1, 3)


def split(mesh, edges):
    """Repeat the vertices along edges, as files of other programs do."""
    work = bmesh.new()
    work.from_mesh(mesh)
    work.edges.ensure_lookup_table()
    bmesh.ops.split_edges(work, edges=[work.edges[k] for k in edges])
    work.to_mesh(mesh)
    work.free()


def test_hard_edges_of_an_imported_mesh_stay_hard():
    """Its vertices are repeated along them: a house of a game looked like a wet cushion."""
    obj = cube()
    obj.data.polygons.foreach_set("use_smooth", [True] * 6)
    split(obj.data, range(12))
    assert len(obj.data.vertices) == 24
    mesh = remeshed(obj, count=300)
    assert np.abs(corner_normals(mesh)).max(axis=1).min() > 0.999
    assert 12 <= sum(edge.use_edge_sharp for edge in mesh.edges) < len(mesh.edges) / 2


def test_a_sharp_rim_is_sharp_all_around():
    """It had a gap wherever a new edge cuts a corner of the old rim."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=16)
    mesh = bpy.context.object.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    for edge in mesh.edges:
        low, high = (mesh.vertices[k].co.z for k in edge.vertices)
        edge.use_edge_sharp = low == high
    mesh = remeshed(bpy.context.object, count=400)
    heights = np.abs(positions(mesh)[:, 2])
    rims = [e for e in mesh.edges if e.use_edge_sharp]
    assert heights[[k for e in rims for k in e.vertices]].min() > 0.99
    used = np.bincount([k for e in rims for k in e.vertices])
    assert set(used[used > 0]) == {2}


def test_a_smooth_seam_of_an_imported_mesh_stays_smooth():
    """Textures end there, but normals are the same on both sides."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)
    mesh = bpy.context.object.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    around = [
        one.index
        for one in mesh.edges
        if all(abs(mesh.vertices[k].co.z) < 1e-5 for k in one.vertices)
    ]
    normals = corner_normals(mesh).copy()
    split(mesh, around)
    mesh.normals_split_custom_set(normals.tolist())
    mesh = remeshed(bpy.context.object, count=300)
    assert not any(edge.use_edge_sharp for edge in mesh.edges)


def test_a_body_that_is_smooth_all_over_stays_smooth():
    """It became flat: Blender stores nothing about faces where all of them are smooth."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)
    mesh = bpy.context.object.data
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    split(mesh, [])
    assert "sharp_face" not in mesh.attributes
    mesh = remeshed(bpy.context.object, count=300)
    assert all(one.use_smooth for one in mesh.polygons)


def test_faces_that_are_flat_get_no_marks():
    mesh = remeshed(cube(), count=300)
    assert not any(one.use_smooth for one in mesh.polygons)
    assert not any(edge.use_edge_sharp for edge in mesh.edges)
