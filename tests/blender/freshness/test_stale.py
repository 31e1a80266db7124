# SPDX-License-Identifier: GPL-3.0-or-later
"""A result that does not fit any more is said, with the reason: panel and modifier."""

from dataclasses import replace

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def reason(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


@pytest.fixture
def baked():
    scenes.tail(frames=4)
    obj = scenes.scattered(bpy.context.object)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


def test_a_fresh_bake_is_not_stale_on_any_frame(baked):
    for frame in (-3, 1, 2, 4, 9):
        bpy.context.scene.frame_set(frame)
        assert reason(baked) == ""
    bpy.context.scene.frame_set(2, subframe=0.5)
    assert reason(baked) == ""
    assert scenes.node_warnings(baked) == []


def test_changed_settings_are_named_in_panel_and_modifier(baked):
    before = baked.dapple.repulsion_weight, baked.dapple.seed
    baked.dapple.repulsion_weight, baked.dapple.seed = 1.5, 4
    said = "Settings were changed (Seed, Separation): bake again"
    assert reason(baked) == said
    assert scenes.node_warnings(baked) == [said]
    assert len(scenes.positions(baked)) == 60  # reported as stale, but still played
    baked.dapple.repulsion_weight, baked.dapple.seed = before
    assert reason(baked) == ""
    assert scenes.node_warnings(baked) == []


def test_changed_settings_of_a_scatter_without_a_bake_ask_to_optimize():
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.count = 70
    assert reason(obj) == "Settings were changed (Count): optimize again"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == ""


def test_another_motion_is_said_where_it_differs(baked):
    rig = bpy.data.objects["Rig"]
    curve = next(c for c in scenes.curves(rig) if c.data_path.endswith("euler"))
    curve.keyframe_points[-1].co.y += 0.05
    curve.update()
    bpy.context.scene.frame_set(1)
    assert reason(baked) == ""
    bpy.context.scene.frame_set(3)
    assert reason(baked) == (
        "Surface 'Tail' moves differently than when it was baked (frame 3): bake again"
    )
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(baked) == ""


def test_moving_the_object_as_a_whole_keeps_the_bake(baked):
    surface = baked.dapple.surface
    surface.location, surface.rotation_euler = (5, 6, 7), (1, 2, 3)
    bpy.context.view_layer.update()
    # The armature moves with the object that it deforms only if it is its parent.
    surface.modifiers["Armature"].object.matrix_world = surface.matrix_world
    bpy.context.view_layer.update()
    assert reason(baked) == ""


def test_faces_that_changed_with_the_same_number_of_vertices_are_said(baked):
    surface = baked.dapple.surface
    mesh = surface.data
    mesh.loops[0].vertex_index, mesh.loops[1].vertex_index = (
        mesh.loops[1].vertex_index,
        mesh.loops[0].vertex_index,
    )
    mesh.update()
    bpy.context.view_layer.update()
    assert reason(baked).startswith(
        "The faces of 'Tail' are not those that the points are attached to"
    )


def test_frames_beyond_the_bake_are_said(baked):
    bpy.context.scene.frame_end = 7
    assert reason(baked) == "Frames 1 to 4 are baked, the scene has 1 to 7: bake again"


def test_a_removed_surface_is_said(baked):
    bpy.data.objects.remove(baked.dapple.surface)
    assert reason(baked) == "The surface is gone"


def arrays(vertices, matrix=None):
    surface = addon_host.part("core.surface.arrays")
    faces = np.array([(0, 1, 2)], dtype=np.int32)
    return surface.SurfaceArrays(
        "Any", vertices, faces, "t", np.eye(4) if matrix is None else matrix
    )


def test_a_sketch_sees_one_vertex_and_not_the_place_of_the_object():
    stale = addon_host.part("core.solve.stale")
    random = np.random.Generator(np.random.PCG64(1))
    vertices = random.normal(size=(1000, 3))
    stored = stale.sketch(arrays(vertices))
    assert not stale.moved(stored.astype(np.float32), arrays(vertices))
    for vertex in (0, 500, 999):
        other = vertices.copy()
        other[vertex, 1] += 0.01
        assert stale.moved(stored, arrays(other))
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, (5, -6, 7)
    assert not stale.moved(stored, arrays(vertices @ turn.T + matrix[:3, 3], matrix))
    matrix[:3, :3] = 1.1 * turn
    assert stale.moved(stored, arrays(1.1 * vertices @ turn.T + matrix[:3, 3], matrix))


@pytest.mark.parametrize("stored", ["", "no json", "[1]", '{"seed": 0}'])
def test_settings_that_cannot_be_read_are_all_changed(stored):
    stale, settings = (
        addon_host.part("core.solve.stale"),
        addon_host.part("core.settings.values").Settings(),
    )
    changed = stale.changed_settings(stored, settings)
    assert "count" in changed
    assert ("seed" in changed) == ("seed" not in stored)
    text = stale.settings_text(settings)
    assert stale.changed_settings(text, settings) == []
    assert stale.changed_settings(text, replace(settings, repulsion_weight=0.5)) == [
        "repulsion_weight"
    ]
