# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: follows in the viewport, never in a render, and goes without a trace."""

import addon_host
import bpy
import numpy as np
import probe
import pytest
import scenes


@pytest.fixture
def preview():
    return addon_host.part("blender.preview")


@pytest.fixture
def patient():
    """A scatter on a moving tail whose preview has all the time it wants."""
    obj = scenes.scattered(scenes.tail(frames=8))
    obj.dapple.preview_budget = 60_000
    return obj


def riding(obj, frame):
    bpy.context.scene.frame_set(frame)
    return scenes.positions(obj)


def toggled():
    assert bpy.ops.dapple.preview() == {"FINISHED"}


def test_points_follow_while_scrubbing_and_ride_again_when_it_is_off(preview, patient):
    expected = riding(patient, 8)
    bpy.context.scene.frame_set(1)
    before = scenes.snapshot()
    toggled()
    assert preview.is_on(patient)
    assert bpy.app.timers.is_registered(preview.tick)
    for frame in (3, 5, 8):
        bpy.context.scene.frame_set(frame)
        assert preview.tick() > 0
    assert np.abs(scenes.positions(patient) - expected).max() > 0.01
    assert preview.note(patient) == "Points follow the surface"
    toggled()
    assert not preview.is_on(patient)
    assert (scenes.positions(patient) == expected).all()
    assert preview.tick() is None
    bpy.context.scene.frame_set(1)
    assert scenes.snapshot() == before


def test_posing_is_followed_too(preview, patient):
    bpy.context.scene.frame_set(8)
    surface = patient.dapple.surface
    toggled()
    surface.scale = (1.0, 1.0, 2.0)
    bpy.context.view_layer.update()
    riding_now = scenes.positions(patient)
    preview.tick()
    assert np.abs(scenes.positions(patient) - riding_now).max() > 0.01


def test_nothing_is_solved_while_nothing_changes(preview, patient, monkeypatch):
    toggled()
    preview.tick()
    seen, follower = [], addon_host.part("core.follow").Follower
    follow = follower._advanced
    monkeypatch.setattr(
        follower, "_advanced", lambda self, *rest: seen.append(1) or follow(self, *rest)
    )
    for _ in range(3):
        preview.tick()
    assert not seen
    bpy.context.scene.frame_set(4)
    preview.tick()
    assert len(seen) == 1


def test_over_budget_the_points_ride(preview):
    obj = scenes.scattered(scenes.tail(frames=8), count=4000)
    expected = riding(obj, 8)
    bpy.context.scene.frame_set(1)
    obj.dapple.preview_budget = 1
    toggled()
    bpy.context.scene.frame_set(8)
    preview.tick()
    assert preview.note(obj) == "Over budget: points ride on the surface"
    assert np.abs(scenes.positions(obj) - expected).max() < 1e-5


def test_a_render_shows_the_bake_and_solves_nothing(preview, patient, monkeypatch):
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    with probe.registered():
        expected = probe.render(patient, 6)["positions"]
        bpy.context.scene.frame_set(1)
        toggled()
        bpy.context.scene.frame_set(6)
        preview.tick()
        ticked = []
        monkeypatch.setattr(preview, "_follow", lambda each: ticked.append(each))
        monkeypatch.setattr(
            probe.ProbeEngine, "_empty_picture", _ticking(preview, probe.ProbeEngine)
        )
        assert (probe.render(patient, 6)["positions"] == expected).all()
        assert not ticked
    preview.tick()
    assert ticked  # the render is over


def _ticking(preview, engine):
    draw = engine._empty_picture

    def tick(self, scene):
        preview._touched()
        preview.tick()
        draw(self, scene)

    return tick


def test_a_file_is_saved_and_loaded_without_the_preview(preview, patient, tmp_path):
    path, count = tmp_path / "previewed.blend", len(bpy.data.objects)
    toggled()
    bpy.context.scene.frame_set(5)
    preview.tick()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    assert not preview.is_on(patient)
    assert len(bpy.data.objects) == count
    toggled()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert not preview.is_on(bpy.context.object)
    assert len(bpy.data.objects) == count
    assert preview.tick() is None


@pytest.mark.parametrize("gone", ["scatter", "surface"])
def test_a_removed_object_ends_the_preview(preview, patient, gone):
    toggled()
    surface = patient.dapple.surface
    bpy.data.objects.remove(patient if gone == "scatter" else surface)
    preview._touched()
    preview.tick()
    assert preview.tick() is None
    assert not [item for item in bpy.data.objects if item.name.endswith("Preview")]


def test_another_topology_ends_the_preview_and_says_so(preview, patient):
    toggled()
    patient.dapple.surface.modifiers["Subdivision"].levels = 2
    bpy.context.view_layer.update()
    preview.tick()
    assert not preview.is_on(patient)
    assert preview.note(patient).startswith("Preview ended: Surface 'Tail' changes its topology")


def test_undo_keeps_or_ends_the_preview_as_it_was(preview, patient):
    name = patient.name
    bpy.ops.ed.undo_push(message="Before")
    bpy.context.scene.frame_set(4)
    bpy.ops.ed.undo_push(message="Frame")
    toggled()
    bpy.ops.ed.undo_push(message="Preview")
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    preview.tick()
    assert preview.is_on(obj)
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.preview() == {"FINISHED"}
    assert not preview.is_on(obj)
    bpy.ops.ed.redo()  # to where a preview was shown
    assert preview.tick() is None
    assert not [item for item in bpy.data.objects if item.name.endswith("Preview")]


def test_a_stale_scatter_is_not_previewed(patient):
    patient.dapple.surface.modifiers["Subdivision"].levels = 2
    bpy.context.view_layer.update()
    with pytest.raises(
        RuntimeError, match="is stale: bound to 410 vertices, surface 'Tail' has 1634"
    ):
        bpy.ops.dapple.preview()
