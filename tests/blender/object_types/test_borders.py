# SPDX-License-Identifier: GPL-3.0-or-later
"""Borders: instances of object types stay inside the border by their radius, or are left out."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes

RADIUS = 0.15


def plate(size=2.0):
    bpy.ops.mesh.primitive_plane_add(size=size)
    return bpy.context.object


def mixed(surface, borders, *, radius=RADIUS, count=100, **more):
    """A scatter of a few large things that stay inside the border, and many small ones."""
    obj = scenes.scattered(surface, count=count)
    for _ in range(2):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    large = obj.dapple.object_types[0]
    large.use_count, large.count, large.radius, large.borders = True, 20, radius, borders
    for name, value in more.items():
        setattr(large, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def kinds_of(obj):
    meshio = addon_host.part("blender.base.mesh_arrays")
    return meshio.read_columns(obj.data, {"dapple_object_type": "INT"})["dapple_object_type"]


def large_places(obj):
    """Places (n, 3) of the large ones, as they are shown."""
    matrices = scenes.instance_matrices(obj)
    kinds = np.sort(kinds_of(obj))  # instances of one type come after another
    assert len(matrices) == len(kinds)
    return matrices[kinds == 0][:, :3, 3]


def inset(places, half=1.0):
    """The least distance of places from the border of a square."""
    return (half - np.abs(places[:, :2]).max(axis=1)).min()


def test_instances_move_in_from_the_border():
    obj = mixed(plate(), "MOVE_IN")
    assert np.bincount(kinds_of(obj)).tolist() == [20, 80]
    moved = inset(large_places(obj))
    assert moved >= RADIUS - 1e-6
    assert inset(scenes.positions(obj)) < RADIUS, "the small ones are up to the border"
    kept = mixed(plate(), "KEEP")
    assert inset(large_places(kept)) < moved


def test_instances_over_the_border_are_removed():
    obj = mixed(plate(), "REMOVE")
    assert inset(large_places(obj)) >= RADIUS - 1e-6
    large, small = np.bincount(kinds_of(obj))
    assert small == 80
    assert large == 14, "a share of (1.7 / 2)^2 is left of 20"
    assert obj.dapple.report.worst_overlap < 0.05


def test_blocked_areas_have_a_border_too():
    surface = plate()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=9)
    bpy.ops.object.mode_set(mode="OBJECT")
    group = surface.vertex_groups.new(name="Path")
    for vertex in surface.data.vertices:
        if abs(vertex.co.x) < 0.15:
            group.add([vertex.index], 1.0, "REPLACE")
    obj = mixed(surface, "MOVE_IN", radius=0.1)
    obj.dapple.density.blocked_areas = "Path"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert np.abs(large_places(obj)[:, 0]).min() >= 0.2 - 1e-3, "a row of faces has no density"


def test_a_bake_keeps_them_inside():
    surface = plate()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=9)
    bpy.ops.object.mode_set(mode="OBJECT")
    bend = surface.modifiers.new("Bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.deform_axis = "BEND", "Y"
    for frame, angle in ((1, 0.0), (4, 1.0)):
        bend.angle = angle
        bend.keyframe_insert("angle", frame=frame)
    bpy.context.scene.frame_end = 4
    obj = mixed(surface, "MOVE_IN")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 3, 4):
        bpy.context.scene.frame_set(frame)
        corners = scenes.world_vertices(surface)
        places = large_places(obj)
        ends = corners[np.isclose(np.abs(surface_x(surface)), 1.0)]
        nearest = np.linalg.norm(places[:, None] - ends[None], axis=2).min(axis=1)
        assert nearest.min() >= 0.9 * RADIUS


def surface_x(surface):
    return np.array([vertex.co.x for vertex in surface.data.vertices])


def test_an_update_keeps_them_inside(live):
    obj = mixed(plate(), "MOVE_IN", count=150)
    obj.dapple.count = 160
    assert live.settle() == 1
    assert len(kinds_of(obj)) == 160
    assert inset(large_places(obj)) >= RADIUS - 1e-6


def test_a_change_is_out_of_date_and_presets_keep_it():
    obj = mixed(plate(), "KEEP")
    stale = addon_host.part("blender.scatter.object").settings_reason
    assert stale(obj) == ""
    obj.dapple.object_types[0].borders = "REMOVE"
    assert "Object Types" in stale(obj)
    assert bpy.ops.dapple.save_preset(name="Inside") == {"FINISHED"}
    obj.dapple.object_types[0].borders = "KEEP"
    assert bpy.ops.dapple.load_preset(name="Inside") == {"FINISHED"}
    assert obj.dapple.object_types[0].borders == "REMOVE"


def test_files_of_earlier_versions_are_not_out_of_date():
    obj = mixed(plate(), "KEEP")
    stored = obj.dapple.solved_settings
    assert '"borders": "KEEP", ' in stored
    obj.dapple.solved_settings = stored.replace('"borders": "KEEP", ', "")
    assert addon_host.part("blender.scatter.object").settings_reason(obj) == ""


def test_no_room_is_an_error_that_changes_nothing():
    obj = mixed(plate(), "KEEP", radius=0.05)
    before = scenes.positions(obj)
    large = obj.dapple.object_types[0]
    large.count, large.radius, large.borders = 1, 1.2, "MOVE_IN"
    with pytest.raises(RuntimeError, match=r"Object type 1 has no room: no place is 1.2 away"):
        bpy.ops.dapple.optimize()
    np.testing.assert_array_equal(scenes.positions(obj), before)


def test_a_closed_surface_and_a_radius_of_0_change_nothing():
    ball = scenes.sphere()
    kept, moved = mixed(ball, "KEEP"), mixed(ball, "MOVE_IN")
    np.testing.assert_array_equal(scenes.positions(kept), scenes.positions(moved))
    ground = plate()
    kept, moved = mixed(ground, "KEEP", radius=0.0), mixed(ground, "MOVE_IN", radius=0.0)
    np.testing.assert_array_equal(scenes.positions(kept), scenes.positions(moved))


def test_show_density_shows_the_border(overlay):
    obj = mixed(plate(), "MOVE_IN")
    obj.dapple.object_type_index = 0
    request = addon_host.part("blender.density.shown_term").request_of(obj)
    assert request.density == "object type 1, away from borders"


def test_a_filled_curve_is_a_boundary():
    surface = plate(4.0)
    bpy.ops.curve.primitive_bezier_circle_add(radius=1.0, location=(0.3, 0.0, 0.5))
    curve = bpy.context.object
    curve.data.dimensions, curve.data.fill_mode = "2D", "BOTH"
    obj = mixed(surface, "MOVE_IN")
    density = obj.dapple.density
    density.use_distance, density.distance_object, density.ignore_height = True, curve, True
    density.distance_max, density.distance_falloff = 0.001, 0.0
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    reach = np.linalg.norm(scenes.positions(obj)[:, :2] - [0.3, 0.0], axis=1).max()
    spacing = obj.dapple.report.spacing
    assert 0.9 < reach < 1.0 + 0.3 * spacing
    far = np.linalg.norm(large_places(obj)[:, :2] - [0.3, 0.0], axis=1).max()
    assert far <= 1.0 - RADIUS + 0.3 * spacing
