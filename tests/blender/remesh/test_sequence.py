# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple, Bake to Sequence: a mesh for each frame of a body whose faces change."""

import addon_host
import bakes
import bpy
import dapple3d as dapple
import numpy as np
import pytest
import scenes
from bakes import blocks, cancel, expect_end_by_purge, press_until, stepped

BAKE = {"animation": "SEQUENCE", "count": 400, "frame_start": 1, "frame_end": 4}


def carved():
    """A block from which a ball that comes nearer takes more on each frame."""
    scenes.sphere()
    ball = bpy.context.object
    ball.name = "Ball"
    for frame, place in ((1, 3.0), (2, 1.6), (4, 1.0)):
        ball.location.x = place
        ball.keyframe_insert("location", frame=frame)
    ball.hide_render = True
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    block = bpy.context.object
    block.name = "Block"
    modifier = block.modifiers.new("Boolean", "BOOLEAN")
    modifier.operation, modifier.object, modifier.solver = "DIFFERENCE", ball, "EXACT"
    return block


def shown_on(obj, frames):
    found = {}
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found[frame] = (*scenes.shown(obj), ids_of(obj))
    bpy.context.scene.frame_set(1)
    return found


def ids_of(obj):
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    ids = np.empty(len(mesh.vertices), np.int32)
    if "id" in mesh.attributes:
        mesh.attributes["id"].data.foreach_get("value", ids)
    return ids


def materials_of(obj):
    """Names of the shown materials, None for empty slots."""
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return [one and one.name for one in shown.materials]


def test_a_new_object_shows_a_mesh_on_each_frame(capfd):
    block = carved()
    block.location.y = 2.0
    block.data.materials.append(bpy.data.materials.new("Stone"))
    old = {}
    for frame in range(1, 5):
        bpy.context.scene.frame_set(frame)
        old[frame] = dapple.Surface(*scenes.shown(block))
    bpy.context.scene.frame_set(1)
    stones = materials_of(block)  # in Blender 5 the modifier adds an empty slot
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    assert "4 frames with" in capfd.readouterr().out
    made = bpy.context.object
    assert made.name == "Block Remeshed"
    assert block.hide_get()
    assert block.hide_render
    assert [one.type for one in block.modifiers] == ["BOOLEAN"]
    found = shown_on(made, range(1, 5))
    for frame, (places, faces, _) in found.items():
        assert dapple.project(old[frame], places).distances.max() < 1e-4
        assert dapple.Surface(places, faces).area == pytest.approx(old[frame].area, rel=0.02)
    assert len(found[1][0]) == 400
    assert materials_of(made) == stones
    assert stones[0] == "Stone"


def test_vertices_stay_where_the_body_does():
    carved()
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    found = shown_on(bpy.context.object, range(1, 5))
    for frame in range(2, 5):
        before, after = found[frame - 1], found[frame]
        _, here, there = np.intersect1d(before[2], after[2], return_indices=True)
        moved = np.linalg.norm(before[0][here] - after[0][there], axis=1)
        left = before[0][here][:, 0] < -0.5
        assert left.sum() > 50
        assert moved[left].max() < 1e-6


def test_frames_outside_the_range_show_the_ends():
    carved()
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    found = shown_on(bpy.context.object, (-5, 1, 4, 30))
    np.testing.assert_array_equal(found[-5][0], found[1][0])
    np.testing.assert_array_equal(found[30][0], found[4][0])
    assert len(found[4][0]) != len(found[1][0]) or not np.array_equal(found[4][0], found[1][0])


def test_a_moving_object_keeps_its_motion():
    block = carved()
    for frame, place in ((1, 0.0), (4, 3.0)):
        block.location.z = place
        block.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(4)
    old = dapple.Surface(*scenes.shown(block))
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    places = shown_on(bpy.context.object, [4])[4][0]
    assert dapple.project(old, places).distances.max() < 1e-4


def test_frames_without_faces_are_empty():
    carved()
    block = bpy.context.object
    block.modifiers.clear()
    build = block.modifiers.new("Build", "BUILD")
    build.frame_start, build.frame_duration = 2, 3
    assert bpy.ops.dapple.remesh(**{**BAKE, "count": 60}) == {"FINISHED"}
    found = shown_on(bpy.context.object, range(1, 5))
    assert len(found[1][0]) == 0
    assert len(found[4][0]) > 0


def test_what_it_cannot_do_is_told(capfd):
    block = carved()
    with pytest.raises(RuntimeError, match="The frame range is empty"):
        bpy.ops.dapple.remesh(**{**BAKE, "frame_end": 0})
    with pytest.raises(RuntimeError, match="Adaptive is for one mesh"):
        bpy.ops.dapple.remesh(**BAKE, adaptive=True)
    block.data.clear_geometry()
    with pytest.raises(RuntimeError, match="'Block' has no faces"):
        bpy.ops.dapple.remesh(**BAKE)
    assert not block.hide_get()
    assert "Block Remeshed" not in bpy.data.objects
    assert "Block Frames" not in bpy.data.collections


def test_the_file_shows_them_again(tmp_path):
    carved()
    assert bpy.ops.dapple.remesh(**BAKE) == {"FINISHED"}
    before = shown_on(bpy.context.object, [3])[3][0]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "carved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "carved.blend"))
    np.testing.assert_array_equal(shown_on(bpy.data.objects["Block Remeshed"], [3])[3][0], before)


def test_frames_are_written_one_after_another():
    carved()
    before, stepper = set(bpy.data.meshes), stepped("sequence", 300, (1, 4))
    counts = []
    while not stepper.poll(wait=0.01):
        counts.append(len(set(bpy.data.meshes) - before))
    assert sorted(set(counts)) == [0, 1, 2, 3]
    assert counts == sorted(counts)
    assert len(set(bpy.data.meshes) - before) == 5  # one of them is that of the new object
    assert stepper.result.figures.frame_count == 4


def test_a_canceled_bake_leaves_nothing():
    block = carved()
    bpy.context.scene.frame_set(3)
    before, stepper = blocks(), stepped("sequence", 300, (1, 4))
    assert cancel(stepper, 0.6) != before
    with pytest.raises(addon_host.part("core.base.errors").StoppedError, match="Canceled"):
        stepper.poll(wait=60.0)
    assert blocks() == before
    assert bpy.context.scene.frame_current == 3
    assert not block.hide_get()
    assert bpy.context.object == block


PRESSED = {**bakes.PRESSED, **BAKE}


def test_in_the_background_it_is_one_step_of_undo(artist):
    carved()
    bpy.context.scene.frame_set(3)
    before = blocks()
    bpy.ops.ed.undo_push(message="Before")
    assert artist.press("remesh", **PRESSED) == {"CANCELLED"}
    artist.until(lambda: artist.work.job.progress > 0.5)
    assert artist.work.line().startswith("Remesh with Dapple: ")
    artist.finish()
    assert bpy.context.object.name == "Block Remeshed"
    assert bpy.context.scene.frame_current == 3
    assert "4 frames with" in artist.said(bpy.context.object)[-1][1]
    made = shown_on(bpy.context.object, [3])[3][0]
    bpy.ops.ed.undo()
    assert blocks() == before
    assert not bpy.data.objects["Block"].hide_get()
    bpy.ops.ed.redo()
    np.testing.assert_array_equal(shown_on(bpy.data.objects["Block Remeshed"], [3])[3][0], made)


def test_an_artist_who_edits_another_object_stays_there(artist):
    """The new object became the active one, and the other was left in Edit Mode."""
    block = carved()
    press_until(artist, 0.5, PRESSED)
    bpy.ops.mesh.primitive_cone_add()
    cone = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    artist.finish()
    assert bpy.context.object == cone
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    made = bpy.data.objects["Block Remeshed"]
    assert not made.select_get()
    assert block.hide_get()
    assert "4 frames with" in artist.said(made)[-1][1]


def test_an_artist_who_has_gone_on_keeps_the_active_object(artist):
    carved()
    press_until(artist, 0.5, PRESSED)
    bpy.ops.mesh.primitive_cone_add()
    artist.finish()
    assert bpy.context.object.name == "Cone"
    assert [one.name for one in bpy.context.selected_objects] == ["Cone"]


def test_in_the_background_an_undo_ends_it(artist):
    carved()
    bpy.ops.ed.undo_push(message="Before")
    bpy.data.objects["Ball"].location.y = 0.1
    bpy.ops.ed.undo_push(message="Moved")
    before = blocks()
    press_until(artist, 0.5, PRESSED)
    bpy.ops.ed.undo()
    artist.finish()
    assert blocks() == before
    assert not bpy.data.objects["Block"].hide_get()


def test_a_mesh_that_is_removed_meanwhile_ends_it(artist):
    block = carved()
    expect_end_by_purge(artist, block, 0.5, PRESSED)


def test_files_saved_meanwhile_contain_no_frames(artist, tmp_path):
    carved()
    press_until(artist, 0.5, PRESSED)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "meanwhile.blend"), copy=True)
    artist.finish()
    with bpy.data.libraries.load(str(tmp_path / "meanwhile.blend")) as (stored, _):
        assert sorted(stored.meshes) == sorted([bpy.data.objects["Block"].data.name, "Sphere"])
