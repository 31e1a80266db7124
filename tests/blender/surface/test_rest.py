# SPDX-License-Identifier: GPL-3.0-or-later
"""Points attached to the rest position stick to whatever faces the modifiers make."""

import addon_host
import bpy
import dapple3d as dapple
import mathutils
import numpy as np
import pytest
import scenes


def nearest(surface, points):
    """Distances of points from the evaluated surface."""
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    inverse = evaluated.matrix_world.inverted()
    found = []
    for point in points:
        hit, where, _, _ = evaluated.closest_point_on_mesh(inverse @ _vector(point))
        assert hit
        found.append((evaluated.matrix_world @ where - _vector(point)).length)
    return np.array(found)


def reason(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def _vector(point):
    return mathutils.Vector(point)


def bound(surface, count=60):
    bpy.context.view_layer.objects.active = surface
    assert bpy.ops.dapple.add_scatter(count=count, attach_to="REST") == {"FINISHED"}
    return bpy.context.object


def test_it_rides_like_a_binding_to_faces():
    surface = scenes.tail(frames=6)
    by_faces = scenes.scattered(surface)
    by_rest = bound(surface)
    for frame, part in ((1, 0.0), (3, 0.0), (4, 0.5), (6, 0.0)):
        bpy.context.scene.frame_set(frame, subframe=part)
        size = scenes.size(scenes.world_vertices(surface))
        apart = np.linalg.norm(scenes.positions(by_rest) - scenes.positions(by_faces), axis=1)
        assert apart.max() < 2e-3 * size


def test_it_stays_on_a_surface_whose_faces_change():
    surface = scenes.tail(frames=6)
    obj = bound(surface)
    before = scenes.positions(obj)
    for levels in (0, 2, 1):
        surface.modifiers["Subdivision"].levels = levels
        bpy.context.view_layer.update()
        now = scenes.positions(obj)
        assert len(now) == 60
        size = scenes.size(scenes.world_vertices(surface))
        assert nearest(surface, now).max() < 1e-5 * size
        assert np.linalg.norm(now - before, axis=1).max() < 0.05 * size
        assert not scenes.node_warnings(obj)


@pytest.mark.parametrize("align", [1.0, 1.0 - 1e-6])
def test_things_are_turned_each_by_its_own_angle(align):
    obj = bound(scenes.tail(frames=6))
    obj.dapple.align_to_normal = align
    own = np.empty(len(obj.data.vertices), dtype=np.float32)
    obj.data.attributes["dapple_turn"].data.foreach_get("value", own)
    obj.dapple.random_turn = 0.0
    straight = scenes.rotations(obj)
    obj.dapple.random_turn = 0.5
    found = scenes.rotations(obj)[:, :, 0]
    expected = (
        np.cos(0.5 * own)[:, None] * straight[:, :, 0]
        + np.sin(0.5 * own)[:, None] * straight[:, :, 1]
    )
    assert np.allclose(found, expected, atol=2e-5)


def test_viewport_and_render_may_have_other_faces():
    surface = scenes.tail(levels=1, render_levels=2, frames=6)
    with pytest.raises(RuntimeError, match="set Attach To to Automatic or Rest Position"):
        bpy.ops.dapple.add_scatter(count=60, attach_to="FACES")
    assert len(scenes.positions(bound(surface))) == 60


@pytest.mark.parametrize("smoothing", ["FORWARD", "BOTH_WAYS", "LOOP"])
@pytest.mark.parametrize("kinds", [0, 2])
def test_every_way_of_baking_plays_by_the_rest_position(smoothing, kinds):
    surface = scenes.tail(frames=6)
    played = []
    for bind in (scenes.scattered, bound):
        obj = bind(surface)
        for _ in range(kinds):
            assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        if kinds:
            assert bpy.ops.dapple.optimize() == {"FINISHED"}
        obj.dapple.smoothing = smoothing
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert obj.dapple.attached_to == ("REST" if bind is bound else "FACES")
        places = []
        for frame in (1, 3, 6):
            bpy.context.scene.frame_set(frame)
            places.append(scenes.positions(obj))
        played.append(places)
        bpy.context.scene.frame_set(1)
    size = scenes.size(scenes.world_vertices(surface))
    for by_faces, by_rest in zip(*played, strict=True):
        assert np.linalg.norm(by_rest - by_faces, axis=1).max() < 2e-3 * size


def test_smoothing_on_faces_that_change_in_every_frame():
    surface = scenes.tail(frames=4)
    decimate = surface.modifiers.new("Decimate", "DECIMATE")
    for frame, ratio in ((1, 1.0), (4, 0.7)):
        decimate.ratio = ratio
        decimate.keyframe_insert("ratio", frame=frame)
    bpy.context.scene.frame_set(1)
    obj = bound(surface)
    obj.dapple.smoothing = "BOTH_WAYS"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 2, 4):
        bpy.context.scene.frame_set(frame)
        points = scenes.positions(obj)
        assert len(points) == 60
        assert nearest(surface, points).max() < 1e-4 * scenes.size(scenes.world_vertices(surface))


def test_other_levels_after_a_bake_are_no_other_motion():
    surface = scenes.tail(frames=3)
    obj = bound(surface)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for levels in (0, 2, 1):
        surface.modifiers["Subdivision"].levels = levels
        bpy.context.view_layer.update()
        assert len(scenes.positions(obj)) == 60
        assert reason(obj) == ""
    surface.scale.x = 2.0
    bpy.context.view_layer.update()
    assert "another shape or scale" in reason(obj)


def test_a_rest_position_that_was_turned_off_is_said():
    surface = scenes.tail(frames=3)
    obj = bound(surface)
    assert reason(obj) == ""
    surface.add_rest_position_attribute = False
    assert reason(obj) == "Rest Position of 'Tail' is off: optimize again"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == ""


def test_modifiers_that_lose_the_rest_position_are_said():
    surface = scenes.sphere()
    tree = bpy.data.node_groups.new("Anew", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    cube, out = (tree.nodes.new(kind) for kind in ("GeometryNodeMeshCube", "NodeGroupOutput"))
    tree.links.new(cube.outputs[0], out.inputs[0])
    surface.modifiers.new("Nodes", "NODES").node_group = tree
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match="'Sphere': its modifiers make a mesh without rest pos"):
        bpy.ops.dapple.add_scatter(count=60, attach_to="REST")
    assert scenes.snapshot() == before
    assert not surface.add_rest_position_attribute


def test_things_turn_with_the_surface():
    surface = scenes.sphere()
    obj = bound(surface)
    obj.dapple.random_turn = 0.0
    before = scenes.rotations(obj)
    surface.rotation_euler = (0.3, 0.5, -0.4)
    bpy.context.view_layer.update()
    turn = np.array(surface.matrix_world.to_3x3())
    assert np.abs(scenes.rotations(obj) - turn @ before).max() < 1e-3


def test_copies_of_the_rest_shape_are_reported_apart():
    surface = scenes.sphere()
    array = surface.modifiers.new("Array", "ARRAY")
    array.count, array.relative_offset_displace = 3, (2.0, 0.0, 0.0)
    shown = scenes.positions(bound(surface))
    assert nearest(surface, shown).max() < 1e-5
    assert [(np.abs(shown[:, 0] - x) < 1.01).sum() for x in (0, 4, 8)] == [20, 20, 20]


def test_a_thickness_without_width_at_rest_is_refused_and_nothing_is_written():
    bpy.ops.mesh.primitive_grid_add()
    bpy.context.object.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.5
    before = sorted(bpy.data.objects.keys())
    with pytest.raises(RuntimeError, match=r"point \d+ has the rest position of another place"):
        bpy.ops.dapple.add_scatter(count=60, attach_to="REST")
    assert sorted(bpy.data.objects.keys()) == before


def split_sheet():
    """A square and a pentagon that meet at rest without sharing vertices; rounding parts them."""
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    pentagon = [(1, 0, 0), (2, 0, 0), (3, 0.5, 0), (2, 1, 0), (1, 1, 0)]
    mesh = bpy.data.meshes.new("Sheet")
    mesh.from_pydata(square + pentagon, [], [(0, 1, 2, 3), (4, 5, 6, 7, 8)])
    surface = bpy.data.objects.new("Sheet", mesh)
    bpy.context.collection.objects.link(surface)
    bpy.context.view_layer.objects.active = surface
    subdivision = surface.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels, subdivision.render_levels = 1, 2
    return surface


def test_points_on_split_edges_stay_on_their_side_where_a_modifier_parts_it():
    surface = split_sheet()
    bpy.ops.dapple.add_scatter(count=60)
    obj = bpy.context.object
    assert obj.dapple.attached_to == "REST"
    for x in (0.95, 1.0, 1.05):
        for y in (0.05, 0.1, 0.2, 0.35, 0.4, 0.6, 0.65, 0.8, 0.9, 0.95):
            place = np.array([x, y, 0.0])
            assert bpy.ops.dapple.add_point(location=place) == {"FINISHED"}
            vertices, faces = scenes.shown(surface)
            beside = dapple.project(dapple.Surface(vertices, faces), place[None]).positions[0]
            assert np.linalg.norm(scenes.positions(obj) - beside, axis=1).min() < 1e-3
    before = scenes.positions(obj)
    bpy.context.scene.frame_end = 2
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert np.abs(scenes.positions(obj) - before)[60:].max() < 1e-3  # those are locked


def test_back_to_faces():
    surface = scenes.tail(frames=6)
    obj = bound(surface)
    obj.dapple.attach_to = "FACES"
    assert any("Attach To" in warning for warning in scenes.node_warnings(obj))
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert not scenes.node_warnings(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
