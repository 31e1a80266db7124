# SPDX-License-Identifier: GPL-3.0-or-later
"""Leave Out Hidden: no points where the camera does not see the surface."""

import bpy
import numpy as np
import pytest
import scenes

NOTHING = "nothing can be placed|no density|nothing is left"
FAR = 6.0  # of the camera, on the x axis


def camera(orthographic=False):
    """A camera on the x axis that looks at the origin."""
    made = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(made)
    made.location, made.rotation_euler = (FAR, 0.0, 0.0), (np.pi / 2, 0.0, np.pi / 2)
    if orthographic:
        made.data.type, made.data.ortho_scale = "ORTHO", 5.0
    bpy.context.scene.camera = made
    return made


def board(x, size):
    """A square across the x axis."""
    bpy.ops.mesh.primitive_plane_add(size=size, location=(x, 0.0, 0.0), rotation=(0, np.pi / 2, 0))
    return bpy.context.object


def seen(surface, hiding=None, count=150):
    """A scatter of what the camera sees."""
    obj = scenes.scattered(surface, count=count)
    density = obj.dapple.density
    density.use_camera_view, density.camera_hidden = True, True
    density.hiding_collection = hiding
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


@pytest.mark.parametrize("orthographic", [False, True])
def test_no_points_behind_the_body_itself(orthographic):
    camera(orthographic)
    obj = seen(scenes.sphere())
    places = scenes.positions(obj)
    assert len(places) == 150
    horizon = 0.0 if orthographic else 1.0 / FAR
    assert places[:, 0].min() > horizon - 0.02
    assert places[:, 0].min() < horizon + 0.25, "up to the silhouette"


def test_no_points_behind_other_objects():
    camera()
    wall, shade = board(0.0, 3.0), board(3.0, 0.5)
    hiding = scenes.collection_of(shade)
    obj = seen(wall, hiding)
    shadow = 0.25 * FAR / (FAR - 3.0)  # half its width on the wall
    places = np.abs(scenes.positions(obj)[:, 1:]).max(axis=1)
    assert places.min() > shadow - 1e-4
    assert places.min() < shadow + 0.15
    shade.location.y = 0.6
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    moved = scenes.positions(obj)[:, 1:] - [0.6 * FAR / (FAR - 3.0), 0.0]
    assert np.abs(moved).max(axis=1).min() > shadow - 1e-4


def test_a_bake_leaves_out_what_is_hidden_on_each_frame():
    camera()
    wall, shade = board(0.0, 3.0), board(3.0, 0.5)
    obj = seen(wall, scenes.collection_of(shade))
    for frame, y in ((1, 0.0), (4, 0.3)):
        shade.location.y = y
        shade.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = 4
    bpy.context.scene.frame_set(1)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 4):
        bpy.context.scene.frame_set(frame)
        middle = [2.0 * shade.matrix_world.translation.y, 0.0]
        away = np.abs(scenes.positions(obj)[:, 1:] - middle).max(axis=1)
        assert away.min() > 0.5 - 1e-3


def test_nothing_seen_is_an_error():
    camera()
    wall, shade = board(0.0, 1.0), board(3.0, 4.0)
    obj = scenes.scattered(wall, count=50)
    before = scenes.positions(obj)
    density = obj.dapple.density
    density.use_camera_view = density.camera_hidden = True
    density.hiding_collection = scenes.collection_of(shade)
    with pytest.raises(RuntimeError, match=NOTHING):
        bpy.ops.dapple.optimize()
    np.testing.assert_array_equal(scenes.positions(obj), before)


def test_presets_have_the_switch():
    camera()
    obj = seen(scenes.sphere())
    assert bpy.ops.dapple.save_preset(name="Seen") == {"FINISHED"}
    obj.dapple.density.camera_hidden = False
    assert bpy.ops.dapple.load_preset(name="Seen") == {"FINISHED"}
    assert obj.dapple.density.camera_hidden
