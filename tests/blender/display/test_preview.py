# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: follows in the viewport, never in a render, and goes without a trace."""

from contextlib import contextmanager

import addon_host
import bpy
import child
import numpy as np
import probe
import pytest
import scenes
import windowed


@pytest.fixture
def preview():
    return addon_host.part("blender.display.preview")


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
    assert bpy.ops.dapple.live_preview() == {"FINISHED"}


def test_points_follow_while_scrubbing_and_ride_again_when_it_is_off(preview, patient):
    expected = riding(patient, 8)
    bpy.context.scene.frame_set(1)
    before = scenes.snapshot()
    toggled()
    assert preview.is_on(patient)
    assert addon_host.part("blender.base.timers").is_due(preview.tick)
    for frame in (3, 5, 8):
        bpy.context.scene.frame_set(frame)
        assert preview.tick() > 0
    assert np.abs(scenes.positions(patient) - expected).max() > 0.01
    assert preview.note(patient) == "Points are kept even"
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
    seen, follower = [], addon_host.part("core.preview").Follower
    follow = follower.advanced
    monkeypatch.setattr(
        follower, "advanced", lambda self, *rest: seen.append(1) or follow(self, *rest)
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
    assert preview.note(obj) == "Over budget: points stick to the surface"
    assert np.abs(scenes.positions(obj) - expected).max() < 1e-5


def test_a_render_shows_the_bake_and_solves_nothing(preview, patient, monkeypatch):
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    with probe.registered():
        expected = probe.render(patient, 6)["positions"]
        bpy.context.scene.frame_set(1)
        toggled()
        bpy.context.scene.frame_set(6)
        preview.tick()
        ticked, follow = [], preview.follow_steps
        monkeypatch.setattr(
            preview, "follow_steps", lambda each: ticked.append(each) or follow(each)
        )
        monkeypatch.setattr(
            probe.ProbeEngine, "empty_picture", _ticking(preview, probe.ProbeEngine)
        )
        assert (probe.render(patient, 6)["positions"] == expected).all()
        assert not ticked
    preview.tick()
    assert ticked  # the render has finished


def _ticking(preview, engine):
    draw = engine.empty_picture

    def tick(self, scene):
        bpy.context.view_layer.update()
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
    bpy.context.view_layer.update()
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
    assert bpy.ops.dapple.live_preview() == {"FINISHED"}
    assert not preview.is_on(obj)
    bpy.ops.ed.redo()  # a step at which a preview was shown
    assert preview.tick() is None
    assert not [item for item in bpy.data.objects if item.name.endswith("Preview")]


def test_a_stale_scatter_is_not_previewed(patient):
    patient.dapple.surface.modifiers["Subdivision"].levels = 2
    bpy.context.view_layer.update()
    with pytest.raises(
        RuntimeError, match="is out of date: attached to 410 vertices, surface 'Tail' has 1634"
    ):
        bpy.ops.dapple.live_preview()


def test_points_are_found_by_a_worker_and_ride_until_then(preview, patient, monkeypatch):
    expected = riding(patient, 8)
    bpy.context.scene.frame_set(1)
    monkeypatch.setattr(addon_host.part("blender.base.jobs"), "at_once", False)
    follower = addon_host.part("core.preview").Follower
    steps = addon_host.part("blender.display.preview_steps")
    made, makers = windowed.held_back(monkeypatch, steps, "Follower")
    toggled()
    windowed.until(lambda: makers, preview.tick)
    assert preview.note(patient) == "The preview is being prepared"
    made.set()
    held, finders = windowed.held_back(monkeypatch, follower, "advanced")
    bpy.context.scene.frame_set(8)
    windowed.until(lambda: finders, preview.tick)
    assert np.abs(scenes.positions(patient) - expected).max() < 1e-5
    held.set()
    windowed.until(lambda: idle(preview), preview.tick)
    assert np.abs(scenes.positions(patient) - expected).max() > 0.01
    assert not {thread.name for thread in makers + finders} & {"MainThread"}


def idle(preview):
    return preview.is_settled()


def test_a_render_stops_the_worker_and_the_points_are_found_afterward(
    preview, patient, monkeypatch
):
    toggled()
    expected = riding(patient, 8)
    monkeypatch.setattr(addon_host.part("blender.base.jobs"), "at_once", False)
    follower = addon_host.part("core.preview").Follower
    held, finders = windowed.held_back(monkeypatch, follower, "advanced")
    windowed.until(lambda: finders, preview.tick)
    with probe.registered():
        probe.render(patient, 8)
    held.set()
    windowed.until(lambda: len(finders) > 1, preview.tick)
    windowed.until(lambda: idle(preview), preview.tick)
    assert np.abs(scenes.positions(patient) - expected).max() > 0.01
    assert preview.note(patient) == "Points are kept even"


def test_a_preview_that_ends_forgets_what_its_worker_still_finds(preview, patient, monkeypatch):
    toggled()
    expected = riding(patient, 8)
    monkeypatch.setattr(addon_host.part("blender.base.jobs"), "at_once", False)
    follower = addon_host.part("core.preview").Follower
    held, finders = windowed.held_back(monkeypatch, follower, "advanced")
    windowed.until(lambda: finders, preview.tick)
    toggled()
    held.set()
    assert preview.tick() is None
    assert (scenes.positions(patient) == expected).all()


def test_the_surface_that_is_chosen_later_is_followed(preview, patient):
    first = patient.dapple.surface
    second = first.copy()
    second.data = first.data.copy()
    second.animation_data_clear()
    bpy.context.collection.objects.link(second)
    second.location.x = 5.0
    bpy.context.view_layer.update()
    scenes.activate(patient)
    toggled()
    patient.dapple.surface = second
    preview.tick()
    bpy.context.view_layer.update()
    assert preview.is_on(patient)
    second.scale.z = 2.0
    bpy.context.view_layer.update()
    riding_now = scenes.positions(patient)
    assert riding_now[:, 0].min() > 4.0
    preview.tick()
    assert np.abs(scenes.positions(patient) - riding_now).max() > 0.01


@pytest.mark.parametrize("other", ["sphere", "none"])
def test_a_surface_that_does_not_fit_ends_the_preview_and_says_so(preview, patient, other):
    toggled()
    patient.dapple.surface = scenes.sphere() if other == "sphere" else None
    preview.tick()
    assert not preview.is_on(patient)
    said = "is out of date: attached to 410 vertices, surface 'Sphere' has 266"
    assert ("has no surface" if other == "none" else said) in preview.note(patient)


@contextmanager
def unannounced():
    """Save without the add-on being called before."""
    called = list(bpy.app.handlers.save_pre)
    bpy.app.handlers.save_pre.clear()
    try:
        yield
    finally:
        bpy.app.handlers.save_pre.extend(called)


def test_an_auto_saved_file_has_no_trace_of_the_preview(preview, patient, tmp_path):
    """Auto-saving tells no add-on that it begins."""
    expected = riding(patient, 8)
    toggled()
    bpy.context.scene.frame_set(8)
    preview.tick()
    bpy.ops.ed.undo_push(message="Before")
    path = tmp_path / "saved.blend"
    with unannounced():
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    label = f"{patient.name} Preview".encode()
    assert label not in path.read_bytes()
    shown = child.run(RECOVERED, path)
    np.testing.assert_allclose(np.array(eval(shown.splitlines()[-1])), expected, atol=1e-5)


RECOVERED = """
bpy.ops.wm.open_mainfile(filepath=arguments[0])
import scenes
obj = next(one for one in bpy.data.objects if one.name.endswith("Scatter"))
print([one.name for one in bpy.data.objects if one.name.endswith("Preview")])
print(scenes.positions(obj).tolist())
"""


def test_a_file_of_an_older_version_that_was_saved_with_a_preview_opens_without(
    preview, patient, tmp_path
):
    toggled()
    store = next(one for one in bpy.data.objects if one.name.endswith("Preview"))
    store.is_runtime_data = store.data.is_runtime_data = False
    with unannounced():
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "old.blend"), copy=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "old.blend"))
    assert not [one for one in bpy.data.objects if one.name.endswith("Preview")]
