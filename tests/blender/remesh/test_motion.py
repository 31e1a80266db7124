# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple, Bake to Shape Keys: one mesh that follows an animation."""

import addon_host
import bakes
import bpy
import dapple3d as dapple
import numpy as np
import pytest
import scenes
from bakes import blocks, cancel, expect_end_by_purge, press_until, stepped

BAKE = {"animation": "SHAPE_KEYS", "count": 300}


def frames_of(obj, frames):
    found = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found[frame] = scenes.shown(obj)
    bpy.context.scene.frame_set(1)
    return found


def test_the_new_mesh_follows_the_old_one_on_all_frames(capfd):
    obj = scenes.tail(levels=1, frames=6)
    obj.location.x = 3.0
    obj.scale = (1.0, 2.0, 1.0)
    before = frames_of(obj, range(1, 7))
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    assert "6 frames as shape keys" in capfd.readouterr().out
    assert bpy.context.scene.frame_current == 1
    keys = obj.data.shape_keys.key_blocks
    assert [key.name for key in keys] == ["Basis", *(f"Frame {k}" for k in range(2, 7))]
    after = frames_of(obj, range(1, 7))
    for frame, (places, faces) in after.items():
        np.testing.assert_array_equal(faces, after[1][1])
        found = dapple.project(dapple.Surface(*before[frame]), places)
        assert found.distances.max() < 1e-4
    assert len(after[1][0]) == 300


def test_vertices_are_even_on_each_frame():
    """Keep lets them move with the surface alone, which is stretched."""
    spreads = {}
    for animation in ("KEEP", "SHAPE_KEYS"):
        obj = scenes.tail(levels=0, frames=6)
        assert bpy.ops.dapple.remesh(**{**BAKE, "animation": animation}) == {"FINISHED"}
        spreads[animation] = areas_vary(*frames_of(obj, [6])[6])
        bpy.data.objects.remove(obj)
    assert spreads["SHAPE_KEYS"] < 0.8 * spreads["KEEP"]


def areas_vary(places, faces):
    corners = places[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.zeros(len(places))
    np.add.at(areas, faces.ravel(), np.repeat(np.linalg.norm(across, axis=1), 3))
    return areas.std() / areas.mean()


def test_between_frames_keys_are_mixed_linearly():
    obj = scenes.tail(levels=0, frames=4)
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    whole = frames_of(obj, range(1, 5))
    bpy.context.scene.frame_set(2, subframe=0.25)
    middle = 0.75 * whole[2][0] + 0.25 * whole[3][0]
    np.testing.assert_allclose(scenes.shown(obj)[0], middle, atol=1e-4)
    bpy.context.scene.frame_set(40)
    np.testing.assert_allclose(scenes.shown(obj)[0], whole[4][0], atol=1e-5)
    bpy.context.scene.frame_set(-3)
    np.testing.assert_allclose(scenes.shown(obj)[0], whole[1][0], atol=1e-5)


def test_groups_materials_and_hidden_modifiers_stay():
    obj = scenes.tail(levels=1, frames=3)
    obj.data.materials.append(bpy.data.materials.new("Skin"))
    obj.data.uv_layers.new(name="UVMap")
    name = obj.data.name
    obj.modifiers.new("Later", "BEVEL").show_viewport = False
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    assert [modifier.name for modifier in obj.modifiers] == ["Later"]
    assert [group.name for group in obj.vertex_groups] == ["root", "tip"]
    assert all(len(vertex.groups) for vertex in obj.data.vertices)
    assert [one.name for one in obj.data.materials] == ["Skin"]
    assert [layer.name for layer in obj.data.uv_layers] == ["UVMap"]
    assert obj.data.name == name
    assert [one.name for one in bpy.data.actions if one.name != "RigAction"] == ["Tail Keys"]
    assert not obj.data.validate()


def test_shape_keys_of_its_own_are_baked_too(tmp_path):
    """The old keys and their motion are gone; the file holds the new ones."""
    obj = scenes.sphere()
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Long")
    for point in key.data:
        point.co.z *= 3
    for frame, value in ((1, 0.0), (5, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    given = {**BAKE, "frame_start": 1, "frame_end": 5}
    assert bpy.ops.dapple.remesh(**given) == {"FINISHED"}
    names = ["Basis", *(f"Frame {k}" for k in range(2, 6))]
    assert [one.name for one in obj.data.shape_keys.key_blocks] == names
    tall = np.ptp(frames_of(obj, [5])[5][0][:, 2])
    assert tall == pytest.approx(6, abs=0.05)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "keys.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "keys.blend"))
    obj = bpy.context.object
    assert [one.name for one in obj.data.shape_keys.key_blocks] == names
    assert np.ptp(frames_of(obj, [5])[5][0][:, 2]) == pytest.approx(tall, abs=1e-5)
    assert len(bpy.data.meshes) == 1


def test_a_parent_that_deforms_does_so_once():
    """An object whose parent is the armature itself, without a modifier."""
    obj = scenes.tail(levels=0, frames=4)
    rig = obj.modifiers["Armature"].object
    obj.modifiers.clear()
    obj.parent, obj.parent_type = rig, "ARMATURE"
    still, before = frames_of(obj, [1, 4]).values()
    assert np.abs(before[0] - still[0]).max() > 0.5  # it bends
    assert bpy.ops.dapple.remesh(**BAKE, frame_start=1, frame_end=4) == {"FINISHED"}
    places = frames_of(obj, [4])[4][0]
    assert dapple.project(dapple.Surface(*before), places).distances.max() < 1e-4
    assert obj.parent == rig


def test_an_object_whose_parent_deforms_stays_in_its_place():
    """Its place relative to the parent was lost."""
    obj = scenes.tail(levels=0, frames=3)
    rig = obj.modifiers["Armature"].object
    rig.location.x = 5.0
    bpy.context.view_layer.update()
    obj.modifiers.clear()
    obj.parent, obj.parent_type = rig, "ARMATURE"
    obj.matrix_parent_inverse = rig.matrix_world.inverted()
    before = frames_of(obj, [1, 3])
    assert bpy.ops.dapple.remesh(**BAKE, frame_start=1, frame_end=3) == {"FINISHED"}
    for frame, (places, _) in frames_of(obj, [1, 3]).items():
        found = dapple.project(dapple.Surface(*before[frame]), places)
        assert found.distances.max() < 1e-4


def test_a_range_of_frames():
    obj = scenes.tail(levels=0, frames=6)
    before = frames_of(obj, range(1, 7))
    assert bpy.ops.dapple.remesh(**BAKE, frame_start=3, frame_end=4) == {"FINISHED"}
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis", "Frame 4"]
    after = frames_of(obj, [3, 4])
    for frame, (places, _) in after.items():
        found = dapple.project(dapple.Surface(*before[frame]), places)
        assert found.distances.max() < 1e-4


def test_one_frame_is_a_basis_alone():
    obj = scenes.tail(levels=0, frames=6)
    assert bpy.ops.dapple.remesh(**BAKE, frame_start=3, frame_end=3) == {"FINISHED"}
    assert [key.name for key in obj.data.shape_keys.key_blocks] == ["Basis"]


def test_an_object_whose_faces_change_is_left_alone():
    obj = scenes.tail(levels=0, frames=4)
    modifier = obj.modifiers.new("Build", "BUILD")
    modifier.frame_start, modifier.frame_duration = -5, 20
    bpy.context.scene.frame_set(2)
    vertices = len(obj.data.vertices)
    with pytest.raises(RuntimeError, match=r"'Tail' has other faces in frame 2 than in frame 1"):
        bpy.ops.dapple.remesh(**BAKE)
    assert len(obj.data.vertices) == vertices
    assert obj.data.shape_keys is None
    assert len(obj.modifiers) == 3
    assert bpy.context.scene.frame_current == 2


def test_an_empty_range_is_refused():
    obj = scenes.tail(levels=0, frames=4)
    with pytest.raises(RuntimeError, match="The frame range is empty: 3 to 2"):
        bpy.ops.dapple.remesh(**BAKE, frame_start=3, frame_end=2)
    assert obj.data.shape_keys is None


def test_a_scale_of_0_on_a_frame_is_named():
    obj = scenes.tail(levels=0, frames=4)
    for frame, size in ((1, 1.0), (3, 0.0)):
        obj.scale = (size, size, size)
        obj.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_set(1)
    with pytest.raises(RuntimeError, match="Frame 3: Surface 'Tail': faces have no area"):
        bpy.ops.dapple.remesh(**BAKE)
    assert obj.data.shape_keys is None


def test_undo_brings_the_old_mesh_and_its_modifiers_back():
    scenes.tail(levels=0, frames=3)
    vertices = len(bpy.context.object.data.vertices)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="remesh")
    bpy.ops.ed.undo()
    obj = bpy.context.object
    assert len(obj.data.vertices) == vertices
    assert [one.type for one in obj.modifiers] == ["ARMATURE", "SUBSURF"]
    assert obj.data.shape_keys is None


def test_a_canceled_bake_leaves_nothing():
    obj = scenes.tail(levels=0, frames=6)
    bpy.context.scene.frame_set(4)
    before, stepper = blocks(), stepped("motion", 200, (1, 6))
    assert cancel(stepper, 0.5) != before
    with pytest.raises(addon_host.part("core.base.errors").StoppedError, match="Canceled"):
        stepper.poll(wait=60.0)
    assert blocks() == before
    assert bpy.context.scene.frame_current == 4
    assert bpy.data.objects["Tail"] == obj
    assert obj.data.shape_keys is None
    assert len(obj.modifiers) == 2


def test_keys_are_written_one_after_another():
    """All of them were written in one block at the end, for which the window froze."""
    obj = scenes.tail(levels=0, frames=6)
    stepper = stepped("motion", 200, (1, 6))
    counts = []
    while not stepper.poll(wait=0.01):
        counts.append(max((len(one.key_blocks) for one in bpy.data.shape_keys), default=0))
        assert obj.data.shape_keys is None
    assert sorted(set(counts)) == [0, 2, 3, 4, 5]
    assert counts == sorted(counts)
    assert keys_of(obj) == 6


PRESSED = {
    **bakes.PRESSED,
    "count": 200,
    "animation": "SHAPE_KEYS",
    "frame_start": 1,
    "frame_end": 6,
}


def keys_of(obj):
    return len(obj.data.shape_keys.key_blocks) if obj.data.shape_keys else 0


def test_in_the_background_it_is_one_step_of_undo(artist):
    scenes.tail(levels=0, frames=6)
    bpy.context.scene.frame_set(3)
    bpy.ops.ed.undo_push(message="Before")
    assert artist.press("remesh", **PRESSED) == {"CANCELLED"}
    artist.until(lambda: bpy.context.scene.frame_current > 4)
    assert artist.work.line().startswith("Remesh with Dapple: ")
    assert artist.work.job.progress > 0.2
    assert keys_of(bpy.context.object) == 0
    artist.finish()
    obj = bpy.context.object
    assert keys_of(obj) == 6
    assert len(obj.modifiers) == 0
    assert bpy.context.scene.frame_current == 3
    assert "6 frames as shape keys" in artist.said(obj)[-1][1]
    bpy.ops.ed.undo()
    assert keys_of(bpy.context.object) == 0
    assert len(bpy.context.object.modifiers) == 2
    bpy.ops.ed.redo()
    assert keys_of(bpy.context.object) == 6


def test_in_the_background_it_ends_if_the_mesh_is_changed(artist):
    obj = scenes.tail(levels=0, frames=6)
    vertices = len(obj.data.vertices)
    artist.press("remesh", **PRESSED)
    artist.until(lambda: bpy.context.scene.frame_current > 2)
    obj.data.vertices[0].co.x += 1.0
    obj.data.update_tag()
    artist.finish()
    assert "'Tail' was changed" in artist.said(obj)[0][1]
    assert len(obj.data.vertices) == vertices
    assert keys_of(obj) == 0
    assert bpy.context.scene.frame_current == 1


def test_in_the_background_changing_faces_are_told(artist):
    obj = scenes.tail(levels=0, frames=6)
    modifier = obj.modifiers.new("Build", "BUILD")
    modifier.frame_start, modifier.frame_duration = -5, 20
    artist.press("remesh", **PRESSED)
    artist.finish()
    assert "'Tail' has other faces in frame 2 than in frame 1" in artist.said(obj)[-1][1]
    assert keys_of(obj) == 0
    assert len(obj.modifiers) == 3


def test_in_the_background_an_undo_ends_it(artist):
    scenes.tail(levels=0, frames=6)
    bpy.ops.ed.undo_push(message="Before")
    bpy.data.objects["Rig"].location.y = 0.1
    bpy.ops.ed.undo_push(message="Moved")
    before = blocks()
    press_until(artist, 0.6, PRESSED)
    assert blocks() != before
    bpy.ops.ed.undo()
    artist.finish()
    assert blocks() == before
    assert keys_of(bpy.data.objects["Tail"]) == 0
    assert len(bpy.data.objects["Tail"].modifiers) == 2


def test_a_mesh_that_is_removed_meanwhile_ends_it(artist):
    obj = scenes.tail(levels=0, frames=6)
    expect_end_by_purge(artist, obj, 0.6, PRESSED)
    assert keys_of(obj) == 0


def test_files_saved_meanwhile_contain_no_keys(artist, tmp_path):
    obj = scenes.tail(levels=0, frames=6)
    press_until(artist, 0.6, PRESSED)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "meanwhile.blend"), copy=True)
    artist.finish()
    assert keys_of(obj) == 6
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "meanwhile.blend"))
    assert [one.name for one in bpy.data.meshes] == ["Tail"]
    assert len(bpy.data.shape_keys) == 0
    assert len(bpy.data.objects["Tail"].modifiers) == 2


def test_steps_of_undo_that_are_made_meanwhile_show_no_keys(artist, tmp_path):
    """The artist moves a lamp while the bake goes on, and takes back both later."""
    scenes.tail(levels=0, frames=6)
    lamp = bpy.data.objects.new("Lamp", None)
    bpy.context.collection.objects.link(lamp)
    bpy.ops.ed.undo_push(message="Before")
    before = blocks()
    press_until(artist, 0.6, PRESSED)
    lamp.location.x = 1.0
    bpy.ops.ed.undo_push(message="Moved")
    artist.finish()
    assert keys_of(bpy.context.object) == 6
    bpy.ops.ed.undo()
    assert bpy.data.objects["Lamp"].location.x == 1.0
    assert keys_of(bpy.data.objects["Tail"]) == 0
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "undone.blend"), copy=True)
    bpy.ops.ed.redo()
    assert keys_of(bpy.data.objects["Tail"]) == 6
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "undone.blend"))
    assert blocks() <= before  # Blender saves no unused node groups either
