# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake notes which inputs move, uses the current settings, and is compared with them."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import camera, linked, note, reason, solved, weighed
from stopped_bakes import stop_after


def moving_camera():
    made = camera()
    for frame, place in ((1, 0.0), (4, 1.0)):
        made.location.x = place
        made.keyframe_insert("location", frame=frame)
    return made


def test_a_bake_knows_what_moves():
    surface = scenes.tail(frames=4)
    group, made = weighed(surface), moving_camera()
    bpy.context.scene.frame_set(1)
    obj = solved(surface, attribute="Grass", use_camera_view=True)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 2, 3, 4):
        bpy.context.scene.frame_set(frame)
        assert reason(obj) == note(obj) == ""
    group.add([100], 0.25, "REPLACE")
    assert reason(obj) == "Values of 'Grass' were changed: bake again"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    made.animation_data_clear()
    made.location = (0.5, 0.0, 9.0)
    bpy.context.scene.frame_set(1)
    assert reason(obj) == "The camera was moved or changed: bake again"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""


@pytest.mark.parametrize(
    ("name", "value"), [("count", 40), ("seed", 3), ("repulsion_weight", 1.0), ("forward", "X")]
)
def test_a_bake_takes_the_settings_that_are_shown(name, value):
    bpy.context.scene.frame_end = 2
    surface = scenes.tail(frames=2)
    obj = scenes.scattered(surface)
    setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    expected = scenes.positions(obj)
    scenes.activate(surface)
    other = scenes.scattered(surface)
    setattr(other.dapple, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(expected) == len(scenes.positions(other)) == (40 if name == "count" else 60)
    assert (scenes.positions(other) == expected).all()
    scenes.activate(obj)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert reason(obj) == ""
    assert len(scenes.positions(obj)) == len(expected)


def test_a_bake_keeps_points_that_were_bound_again():
    surface = scenes.tail(frames=2)
    bpy.context.scene.frame_end = 2
    obj = scenes.scattered(surface)
    obj.data.vertices[3].co.z += 0.3
    assert bpy.ops.dapple.reattach() == {"FINISHED"}
    assert reason(obj) == ""
    before = scenes.positions(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    moved = np.linalg.norm(scenes.positions(obj) - before, axis=1)
    assert moved.max() < 0.5 * obj.dapple.report.spacing


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("keyframe_step", 2, "Keyframe Step"),
        ("smoothing", "LOOP", "Smoothing"),
        ("population", "KEEP_DENSITY", "Population, Fade Duration"),
        ("stickiness", 3.0, "Stickiness"),
    ],
)
def test_settings_of_the_bake_alone_ask_for_another_bake(name, value, words):
    bpy.context.scene.frame_end = 3
    obj = scenes.scattered(scenes.tail(frames=3))
    ids = [one.value for one in obj.data.attributes["id"].data]
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    setattr(obj.dapple, name, value)
    said = f"Settings were changed ({words}): bake again"
    assert reason(obj) == said
    assert scenes.node_warnings(obj) == [said]
    places = [tuple(vertex.co) for vertex in obj.data.vertices]
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    assert [tuple(one.co) for one in obj.data.vertices][: len(ids)] == places
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert reason(obj) == ""


def test_a_bake_on_a_newly_chosen_surface_plays_there():
    surface = scenes.tail(frames=2)
    bpy.context.scene.frame_end = 2
    obj = scenes.scattered(surface)
    other = linked(surface.copy())
    other.location.x = 10.0
    bpy.context.view_layer.update()
    obj.dapple.surface = other
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    assert scenes.positions(obj)[:, 0].min() > 5.0


def damaged(name, store, value):
    def damage(obj):
        read = addon_host.part("nodes").get_input
        data = read(obj.modifiers[0], store).data
        data.attributes[name].data[2].value = value
        data.update_tag()

    return damage


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (damaged("dapple_face", "Keys", 99_999), "dapple_face[2] is 99999, there are "),
        (damaged("dapple_v1", "Triangles", -4), "dapple_v1[2] is -4, there are 410"),
        (damaged("dapple_v1", "Triangles", 410), "dapple_v1[2] is 410, there are 410"),
        (damaged("dapple_key", "Frames", 77), "dapple_key[2] is 77, there are 4"),
    ],
)
def test_keys_with_bad_indices_are_said(damage, said):
    scenes.tail(frames=4)
    obj = scenes.scattered(bpy.context.object)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    damage(obj)
    assert reason(obj).startswith(f"The keyframes are damaged: {said}")
    assert reason(obj).endswith(": bake again")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""


def test_a_stopped_bake_of_changed_settings_goes_on_to_the_same_bytes():
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    surface, found = scenes.tail(frames=4), []
    for stopped in (False, True):
        obj = scenes.scattered(surface)
        obj.dapple.count = 40
        if stopped:
            stop_after(5, 4)  # the points and two frames
            assert (len(obj.data.vertices), obj.dapple.baked_keys) == (60, 0)
            assert reason(obj) == "Settings were changed (Count): optimize again"
            assert addon_host.part("blender.freshness.unfinished_bakes").unfinished(obj) == 2
        baker = steps.run_now(baking.bake_steps(bpy.context, 1, 4))
        assert baker.taken == (2 if stopped else 0)
        assert baker.reoptimized_reason == "Settings were changed (Count)"
        assert reason(obj) == ""
        found.append(addon_host.part("blender.scatter.key_stores").read_baked(obj))
    for name in ("keys", "triangles", "frames"):
        for column, values in getattr(found[0], name).items():
            assert getattr(found[1], name)[column].tobytes() == values.tobytes()
