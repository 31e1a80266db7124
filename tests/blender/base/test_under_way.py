# SPDX-License-Identifier: GPL-3.0-or-later
"""Add, Bake, Reattach and Make Tiles in the background: the interface stays usable, undo is a
single step, and edits during the work are neither lost nor baked in part.
"""

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def scatter():
    return bpy.data.objects["Tail Scatter"]


def places_of(obj, frame):
    bpy.context.scene.frame_set(frame)
    return scenes.positions(obj)


@pytest.fixture
def obj():
    made = scenes.scattered(scenes.tail())
    made.dapple.auto_update_mode = "OFF"
    return made


def at_frame(artist, frame):
    """Bake until that frame is solved, and the one after is being solved."""
    assert artist.press("bake") == {"CANCELLED"}
    artist.until(lambda: bpy.context.scene.frame_current > frame)
    assert artist.work is not None


def test_a_bake_is_what_a_script_gets(artist, obj):
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    wanted = [places_of(obj, frame) for frame in range(1, 7)]
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    bpy.context.scene.frame_set(3)
    assert artist.press("bake") == {"CANCELLED"}
    assert artist.work.line().startswith("Bake: ")
    assert obj.dapple.baked_keys == 0
    artist.finish()
    assert obj.dapple.baked_keys == 6
    assert bpy.context.scene.frame_current == 3
    assert artist.said(obj) == []
    for frame in range(1, 7):
        assert np.array_equal(places_of(obj, frame), wanted[frame - 1])


def test_all_of_them_are_undone_in_one_step(artist):
    surface = scenes.tail(frames=3)
    bpy.ops.ed.undo_push(message="Before")
    for name, made in (
        ("add_scatter", lambda: len(scatter().data.vertices) == 40),
        ("bake", lambda: scatter().dapple.baked_keys == 3),
        ("reattach", lambda: scatter().dapple.baked_keys == 0),
        ("make_tiles", lambda: scatter().dapple.tiles.object is not None),
    ):
        before = "Tail Scatter" in bpy.data.objects and made()
        assert not before
        options = {"add_scatter": {"count": 40}, "reattach": {"delete_keyframes": True}}.get(
            name, {}
        )
        assert artist.press(name, **options) == {"CANCELLED"}
        artist.finish()
        assert made()
        bpy.ops.ed.undo()
        assert not ("Tail Scatter" in bpy.data.objects and made())
        bpy.ops.ed.redo()
        assert made()
        scenes.activate(scatter())
    assert surface is not None


def test_a_new_scatter_becomes_active_unless_the_artist_does_something_else(artist):
    surface = scenes.sphere()
    artist.press("add_scatter", count=30)
    artist.finish()
    assert bpy.context.object.name == "Sphere Scatter"
    scenes.activate(surface)
    artist.press("add_scatter", count=30)
    other = scenes.sphere(location=(4.0, 0.0, 0.0))
    artist.finish()
    assert bpy.context.object == other
    assert len(bpy.data.objects["Sphere Scatter.001"].data.vertices) == 30


def test_nothing_else_begins_meanwhile_and_that_is_said(artist, obj):
    at_frame(artist, 1)
    for name in (
        "optimize",
        "bake",
        "reattach",
        "make_tiles",
        "paint_density",
        "discard_unfinished_bake",
    ):
        assert not getattr(bpy.ops.dapple, name).poll()
    with pytest.raises(RuntimeError, match="'Bake' is still running: cancel it or wait"):
        bpy.ops.dapple.optimize()
    assert bpy.ops.dapple.cancel_update.poll()
    artist.finish()
    assert bpy.ops.dapple.optimize.poll()
    assert not bpy.ops.dapple.cancel_update.poll()


def test_cancel_writes_nothing_and_the_next_bake_goes_on(artist, obj):
    bpy.context.scene.frame_set(2)
    before = scenes.snapshot()
    at_frame(artist, 3)
    assert bpy.ops.dapple.cancel_update() == {"FINISHED"}
    artist.finish()
    assert scenes.snapshot() == before
    assert not obj.dapple.baked_keys
    ((kind, text),) = artist.said(obj)
    assert kind == "INFO"
    assert "frames are kept" in text
    bpy.ops.dapple.hide_message()
    assert artist.said(obj) == []
    artist.press("bake")
    artist.finish()
    assert "were already solved by a stopped bake" in artist.said(obj)[0][1]
    assert obj.dapple.baked_keys == 6


def surface_edited(obj):
    obj.dapple.surface.data.vertices[5].co.x += 0.1
    obj.dapple.surface.data.update()


def surface_posed(_obj):
    bpy.data.objects["Rig"].pose.bones["tip"].rotation_euler.x += 0.4


def surface_deleted(obj):
    bpy.data.objects.remove(obj.dapple.surface)


def points_moved(obj):
    obj.data.vertices[3].co.z += 0.1
    obj.data.update()


def points_edited(obj):
    scenes.activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")


def points_locked(obj):
    obj.dapple.locked_count = 4


def settings_changed(obj):
    obj.dapple.keyframe_step = 2


def scatter_deleted(obj):
    bpy.data.objects.remove(obj)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (surface_edited, "'Tail' was changed"),
        (surface_posed, "'Tail' was changed"),
        (surface_deleted, "Settings of scatter 'Tail Scatter' changed while it was baked"),
        (points_moved, "changed while it was baked: nothing was written"),
        (points_edited, "is not in Object Mode: nothing was written"),
        (points_locked, "changed while it was baked: nothing was written"),
        (settings_changed, "Settings of scatter 'Tail Scatter' changed while it was baked"),
        (scatter_deleted, "'Tail"),
    ],
)
def test_what_the_bake_takes_may_not_change_meanwhile(artist, obj, change, said):
    bpy.context.scene.frame_set(2)
    about = artist.jobs.ObjectHandle(obj)
    at_frame(artist, 3)
    change(obj)
    artist.finish()
    notes = artist.jobs.notes_of(about.uid)
    assert said in notes[0][1]
    assert notes[0][0] in ("ERROR", "WARNING")
    assert bpy.context.scene.frame_current == 2
    if change is not scatter_deleted:
        assert not obj.dapple.baked_keys


def test_what_the_bake_does_not_take_may_change(artist, obj):
    scenes.sphere(location=(5.0, 0.0, 0.0)).name = "Other"
    scenes.activate(obj)
    at_frame(artist, 2)
    bpy.data.objects["Other"].location.x = 7.0
    obj.dapple.scale = 0.5
    scenes.activate(bpy.data.objects["Other"])
    artist.finish()
    assert obj.dapple.baked_keys == 6
    assert artist.said(obj) == []


def test_an_undo_ends_a_bake(artist, obj):
    bpy.ops.ed.undo_push(message="Before")
    bpy.context.scene.cursor.location.x = 1.0
    bpy.data.objects["Rig"].name = "Bones"
    bpy.ops.ed.undo_push(message="Rename")
    at_frame(artist, 3)
    bpy.ops.ed.undo()
    artist.finish()
    assert bpy.context.scene.frame_current == 1
    assert scatter().dapple.baked_keys == 0
    assert artist.said(scatter())[0] == ("WARNING", "A step was undone or redone")


def test_it_pauses_while_the_artist_looks_for_a_frame(artist, obj, monkeypatch):
    at_frame(artist, 2)
    monkeypatch.setattr(artist.jobs, "REST", 1e9)
    bpy.context.scene.frame_set(5)
    for _ in range(50):
        assert artist.jobs.tick() == artist.jobs.PAUSED
    assert bpy.context.scene.frame_current == 5
    assert artist.work.line() == "Bake pauses: the frame was changed"
    monkeypatch.undo()
    monkeypatch.setattr(artist.jobs, "REST", 0.0)
    artist.finish()
    assert obj.dapple.baked_keys == 6
    assert bpy.context.scene.frame_current == 1


@pytest.mark.parametrize("what", ["is_playing", "is_operated", "is_painting", "is_rendering"])
def test_it_pauses_while_something_else_has_the_file(artist, obj, monkeypatch, what):
    at_frame(artist, 2)
    under_way = artist.jobs
    owner = under_way.activity
    monkeypatch.setattr(owner, what, lambda: True)
    frame = bpy.context.scene.frame_current
    for _ in range(50):
        assert under_way.tick() == under_way.PAUSED
    assert bpy.context.scene.frame_current == frame
    assert "pauses" in artist.work.line()
    under_way.cancel()
    if what == "is_rendering":  # a render is never interrupted
        for _ in range(50):
            assert under_way.tick() == under_way.PAUSED
        monkeypatch.undo()
    artist.finish()
    assert not obj.dapple.baked_keys


def test_another_frame_does_not_hinder_the_others(artist, obj, monkeypatch):
    """What was read in one frame is compared there."""
    for name, options in (("reattach", {"delete_keyframes": False}), ("make_tiles", {})):
        bpy.context.scene.frame_set(1)
        artist.press(name, **options)
        bpy.context.scene.frame_set(4)
        monkeypatch.setattr(artist.jobs, "REST", 0.0)
        artist.finish()
        assert bpy.context.scene.frame_current == 4
        assert [kind for kind, _ in artist.said(obj)] == (["INFO"] if name == "make_tiles" else [])
    assert obj.dapple.tiles.object is not None


def test_what_is_wrong_at_once_is_reported_by_the_button(artist, obj):
    obj.dapple.surface = None
    assert artist.press("bake") == {"CANCELLED"}
    assert artist.work is None
    assert artist.reported == [
        ("ERROR", "Scatter 'Tail Scatter' has no surface: choose a mesh object")
    ]


def test_what_is_wrong_later_is_said_in_the_panel(artist, obj):
    modifier = obj.dapple.surface.modifiers["Subdivision"]
    for level, frame in ((1, 3), (2, 4)):
        modifier.levels = modifier.render_levels = level
        modifier.keyframe_insert("levels", frame=frame)
        modifier.keyframe_insert("render_levels", frame=frame)
    bpy.context.scene.frame_set(2)
    before = scenes.snapshot()
    artist.press("bake")
    artist.finish()
    ((kind, text),) = artist.said(obj)
    assert kind == "ERROR"
    assert "changes its topology at frame 4" in text
    assert scenes.snapshot() == before
    artist.press("make_tiles")
    assert artist.said(obj) == []


def test_another_file_ends_it(artist, obj):
    at_frame(artist, 2)
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    assert artist.work is None
    assert artist.jobs.tick() is None


def test_auto_update_waits_for_it(artist, obj, live):
    live.settle()
    obj.dapple.auto_update_mode = "ON"
    other = scenes.scattered(scenes.sphere(), count=30)
    other.dapple.auto_update_mode = "ON"
    live.settle()
    scenes.activate(obj)
    at_frame(artist, 2)
    other.dapple.count = 50
    for _ in range(20):
        live.clock.rest()
        live.look()
    assert len(other.data.vertices) == 30
    artist.finish()
    assert live.settle() == 1
    assert len(other.data.vertices) == 50


def test_scripts_and_background_mode_are_served_at_once(obj):
    assert addon_host.part("blender.base.jobs").at_once
    assert bpy.ops.dapple.bake("INVOKE_DEFAULT") == {"FINISHED"}
    assert obj.dapple.baked_keys == 6


def test_the_status_bar_is_left_alone_if_nothing_is_in_it(monkeypatch):
    """Blender crashed when it was written while the file of the command line was opened."""
    written = []
    monkeypatch.setattr(
        bpy.types.WorkSpace, "status_text_set", lambda _, text: written.append(text)
    )
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    assert not written
