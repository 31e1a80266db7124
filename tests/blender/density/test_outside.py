# SPDX-License-Identifier: GPL-3.0-or-later
"""Outside Only: no points on parts of the surface that are inside others."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes

SHIFT = np.array([1.1, 0.1, 0.05])


def two_balls():
    """Two objects that are stuck into each other, both selected."""
    balls = [scenes.sphere(), scenes.sphere(location=SHIFT)]
    for ball in balls:
        ball.select_set(True)
    return balls


def hidden(positions, slack=0.02):
    distances = [np.linalg.norm(positions - center, axis=1) for center in (np.zeros(3), SHIFT)]
    return np.min(distances, axis=0) < 1.0 - slack


def added(count=200):
    assert bpy.ops.dapple.add_scatter(count=count) == {"FINISHED"}
    return bpy.context.object


def test_several_objects_are_scattered_on_their_outside():
    two_balls()
    obj = added()
    assert obj.dapple.density.use_outside
    found = scenes.positions(obj)
    assert len(found) == 200
    assert not hidden(found).any()
    apart = np.linalg.norm(found[:, None] - found, axis=2)[np.triu_indices(200, 1)]
    assert apart.min() > 0.5 * np.sqrt(2 * 4 * np.pi * 1.55 / (np.sqrt(3) * 200))


def test_it_is_said_why_it_is_on():
    note = addon_host.part("blender.add.operators").outside_note
    assert note(0.214) == "Outside Only is on, because 21 % of the surface is inside other parts"
    assert note(0.0) == ""


def test_one_closed_body_stays_as_it_is():
    scenes.sphere().select_set(True)
    assert not added(60).dapple.density.use_outside


def test_parts_of_one_object_are_parts_if_they_cross():
    two_balls()
    bpy.ops.object.join()
    assert added(60).dapple.density.use_outside


def two_planks():
    """Planks without bottom and ends whose touching sides share corners but not the diagonal."""
    vertices = [(x, y, z) for z in (-1, 0) for y in (0, 4) for x in (-4, 0, 4)]
    tops = [(6, 7, 10, 9), (7, 8, 11, 10)]
    sides = [(3, 0, 6, 9), (2, 5, 11, 8), (1, 4, 10, 7), (4, 10, 7, 1)]
    triangles = [t for a, b, c, d in (*tops, *sides) for t in ((a, b, c), (a, c, d))]
    mesh = bpy.data.meshes.new("Planks")
    mesh.from_pydata(vertices, [], triangles)
    planks = bpy.data.objects.new("Planks", mesh)
    bpy.context.collection.objects.link(planks)
    bpy.context.view_layer.objects.active = planks


def test_points_are_even_on_kit_pieces_that_touch():
    two_planks()
    obj = added(300)
    obj.dapple.density.use_outside = True
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.report.capacity_variation < 0.02


def test_the_inner_shell_of_a_solidified_body_is_no_part():
    ball = scenes.sphere()
    ball.modifiers.new("Shell", "SOLIDIFY").thickness = 0.1
    ball.select_set(True)
    assert not added(60).dapple.density.use_outside


def test_points_inside_come_back_without_it():
    two_balls()
    obj = added()
    obj.dapple.density.use_outside = False
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert hidden(scenes.positions(obj)).any()


def test_a_painted_stroke_leaves_points_outside():
    two_balls()
    bpy.ops.object.join()
    ball = bpy.context.object
    obj = added()
    group = ball.vertex_groups.new(name="Grass")
    high = [v.index for v in ball.data.vertices if v.co.z > 0.0]
    group.add(range(len(ball.data.vertices)), 0.3, "REPLACE")
    group.add(high, 1.0, "REPLACE")
    obj.dapple.density.attribute = "Grass"
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    found = scenes.positions(obj)
    assert not hidden(found).any()
    assert (found[:, 2] > 0.0).mean() > 0.6


def test_openness_leaves_out_crevices():
    two_balls()
    obj = added()
    groove = np.linalg.norm(scenes.positions(obj) - SHIFT / 2, axis=1).min()
    obj.dapple.density.openness = 0.9
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert np.linalg.norm(scenes.positions(obj) - SHIFT / 2, axis=1).min() > groove


def test_a_bake_decides_on_its_first_frame():
    balls = two_balls()
    obj = added(100)
    for frame, x in ((1, SHIFT[0]), (4, SHIFT[0] + 0.3)):
        balls[1].location.x = x
        balls[1].keyframe_insert("location", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 4
    scene.frame_set(1)
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    scene.frame_set(1)
    before = scenes.positions(obj)
    assert not hidden(before).any()
    scene.frame_set(4)
    after = scenes.positions(obj)
    assert len(after) == len(before) == 100


@pytest.mark.parametrize("openness", [0.0, 0.05])
def test_nothing_left_is_refused_and_changes_nothing(openness):
    scenes.sphere(scale=(2.0, 2.0, 2.0)).name = "Shell"
    inner = scenes.sphere()
    for one in bpy.context.selected_objects:
        one.select_set(False)
    inner.select_set(True)
    bpy.context.view_layer.objects.active = inner
    obj = added(60)
    before = scenes.positions(obj)
    obj.dapple.density.use_outside, obj.dapple.density.openness = True, openness
    assert bpy.ops.dapple.optimize() == {"FINISHED"}  # what hides it is no part of the surface
    assert len(scenes.positions(obj)) == len(before)
