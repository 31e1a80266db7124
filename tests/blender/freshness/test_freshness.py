# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing a panel computes nothing: a timer checks what has changed, once per change."""

import types
from collections import Counter

import addon_host
import bpy
import numpy as np
import pytest
import scenes
import test_panels

UNKNOWN, FITS = "not compared with the scene yet", "up to date"


def part():
    return addon_host.part("blender.freshness.findings")


@pytest.fixture
def waiting(monkeypatch):
    """As in a window: the panel shows what a timer has found. Yields how often things were read."""
    freshness, reads = part(), Counter()
    monkeypatch.setattr(freshness, "at_once", False)
    monkeypatch.setattr(freshness, "is_shown", lambda obj: obj == bpy.context.object)
    for name in ("PAUSE", "PATIENCE", "IMAGE_PATIENCE", "IMAGE_PAUSE"):
        monkeypatch.setattr(freshness, name, 0.0)
    counted = {
        "blender.freshness.scene_snapshot": (
            "read_outline",
            "value_digests",
            "read_around",
            "points_digest",
        ),
        "blender.freshness.findings": (
            "verdict",
            "all_work_files",
            "unfinished",
            "picture_digest",
        ),
        "blender.surface.mesh": ("evaluated_mesh", "topology"),
        "blender.bake.operators": ("all_work_files",),
    }
    for module, names in counted.items():
        for name in names:
            counting(monkeypatch, addon_host.part(module), name, reads)
    yield reads
    addon_host.part("blender.base.handlers").publish("before_load")


def counting(monkeypatch, module, name, reads):
    called = getattr(module, name)

    def counted(*arguments, **named):
        reads[name] += 1
        return called(*arguments, **named)

    monkeypatch.setattr(module, name, counted)


def drawn():
    """What the panels show, drawn without a way to evaluate anything."""
    names = ("object", "selected_objects", "scene", "mode", "screen", "view_layer", "workspace")
    context = types.SimpleNamespace(**{name: getattr(bpy.context, name) for name in names})
    shown = []
    for kind in addon_host.part("blender.main_panel").CLASSES:
        if issubclass(kind, bpy.types.Panel) and getattr(kind, "poll", lambda _: True)(context):
            panel = types.SimpleNamespace(layout=test_panels.Layout(shown))
            kind.draw(panel, context)
    assert bpy.ops.dapple.discard_unfinished_bake.poll() in (True, False)
    return " ".join(shown)


def looked(reads):
    """What a tick of the timer reads."""
    bpy.context.view_layer.update()
    reads.clear()
    part().tick()
    return Counter(reads)


@pytest.mark.parametrize("baked", [False, True])
def test_drawing_computes_nothing(waiting, baked):
    obj = scenes.scattered(scenes.tail(frames=3))
    bpy.context.scene.frame_end = 3
    if baked:
        assert bpy.ops.dapple.bake() == {"FINISHED"}
    waiting.clear()
    assert UNKNOWN in drawn()
    assert not waiting
    assert looked(waiting)["verdict"] == 1
    for frame in (1, 2):
        bpy.context.scene.frame_set(frame)
        obj.dapple.surface.data.vertices[0].co.x += 0.01
        bpy.context.view_layer.update()
        waiting.clear()
        assert FITS not in drawn()
        assert not waiting


def test_reading_a_vertex_group_is_no_change(waiting, monkeypatch):
    """A copy of the mesh is made for it and removed again. Two scatters that are checked in turn
    must not cause checks of each other forever.
    """
    monkeypatch.setattr(part(), "is_shown", lambda _: True)
    for _ in range(2):
        obj = scenes.scattered(scenes.tail())
        obj.dapple.density.attribute = "tip"
        assert bpy.ops.dapple.optimize() == {"FINISHED"}
        drawn()
    assert looked(waiting)["value_digests"] == 2
    for _ in range(3):
        assert not looked(waiting)
        assert FITS in drawn()


def test_a_change_is_looked_at_once(waiting):
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    drawn()
    first = looked(waiting)
    assert first["verdict"] == first["read_outline"] == first["points_digest"] == 1
    assert FITS in drawn()
    assert not looked(waiting)
    surface.data.vertices[3].co *= 1.5
    assert looked(waiting)["read_outline"] == 1
    assert "has another shape or scale" in drawn()
    assert not looked(waiting)
    surface.data.vertices[3].co /= 1.5
    obj.dapple.seed = 9
    assert looked(waiting)["read_outline"] == 1
    assert "Settings were changed (Seed)" in drawn()


def test_settings_are_compared_without_reading_the_surface(waiting):
    obj = scenes.scattered(scenes.sphere())
    drawn()
    looked(waiting)
    obj.dapple.repulsion_weight = 1.0
    assert FITS not in drawn()
    seen = looked(waiting)
    assert seen["verdict"] == 1
    assert seen["read_outline"] == seen["evaluated_mesh"] == 0


def test_what_has_no_part_in_a_result_is_not_looked_at(waiting):
    surface = scenes.sphere()
    other = scenes.sphere(location=(9.0, 0.0, 0.0))
    obj = scenes.scattered(surface)
    drawn()
    looked(waiting)
    other.location.y, other.data.vertices[0].co.x = 3.0, 4.0
    assert not looked(waiting)
    assert FITS in drawn()
    surface.name = obj.name = "Renamed"
    assert looked(waiting)["read_outline"] == 0
    assert FITS in drawn()


def test_obstacles_and_the_camera_are_watched(waiting):
    surface = scenes.sphere()
    stone, camera = scenes.sphere(location=(0.0, 0.0, 3.0)), bpy.data.cameras.new("Camera")
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    stones.objects.link(stone)
    bpy.context.scene.camera = bpy.data.objects.new("Camera", camera)
    bpy.context.scene.camera.location.z = 9.0
    bpy.context.scene.collection.objects.link(bpy.context.scene.camera)
    obj = scenes.scattered(surface)
    obj.dapple.density.avoid_collection, obj.dapple.density.use_camera_view = stones, True
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    drawn()
    looked(waiting)
    assert FITS in drawn()
    for owner, name, value in (
        (stone, "location", (0.0, 0.5, 3.0)),
        (bpy.context.scene.camera, "location", (0.0, 1.0, 9.0)),
        (camera, "lens", 70.0),
        (bpy.context.scene.render, "resolution_x", 500),
    ):
        before = np.copy(getattr(owner, name)) if name == "location" else getattr(owner, name)
        setattr(owner, name, value)
        assert looked(waiting)["read_around"] == 1
        assert "Out of date: " in drawn(), (owner, name)
        setattr(owner, name, before)
        assert looked(waiting)["read_outline"] == 0
        assert FITS in drawn()


def test_painted_pixels_are_noticed(waiting):
    obj = scenes.scattered(scenes.sphere())
    image = bpy.data.images.new("Picture", 4, 4)
    image.pixels.foreach_set(np.full(64, 0.5, dtype=np.float32))
    obj.dapple.density.image = image
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    drawn()
    looked(waiting)
    looked(waiting)
    assert FITS in drawn()
    assert looked(waiting)["read_around"] == 0
    image.pixels[9] = 0.9
    looked(waiting)
    assert FITS not in drawn()
    assert looked(waiting)["read_around"] == 1
    assert "Image 'Picture' was changed" in drawn()


def test_undo_and_opening_a_file_are_looked_at_anew(waiting, tmp_path):
    obj = scenes.scattered(scenes.sphere())
    bpy.ops.ed.undo_push(message="Before")
    obj.dapple.count = 70
    bpy.ops.ed.undo_push(message="After")
    drawn()
    looked(waiting)
    assert "Settings were changed (Count)" in drawn()
    bpy.ops.ed.undo()
    assert UNKNOWN in drawn()
    looked(waiting)
    assert FITS in drawn()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    assert UNKNOWN in drawn()
    looked(waiting)
    assert FITS in drawn()


@pytest.mark.parametrize("busy", ["rendering", "under_way", "playing"])
def test_nothing_is_looked_at_meanwhile(waiting, busy, monkeypatch):
    freshness, handlers = part(), addon_host.part("blender.base.handlers")
    scenes.scattered(scenes.sphere())
    drawn()
    if busy == "rendering":
        handlers.publish("render_began")
    elif busy == "under_way":
        monkeypatch.setattr(freshness.step_operators, "is_under_way", lambda: True)
    else:
        monkeypatch.setattr(freshness.activity, "is_playing", lambda: True)
    assert not looked(waiting)
    assert UNKNOWN in drawn()
    handlers.publish("render_ended")
    monkeypatch.undo()


def test_a_scatter_that_is_gone_or_not_shown_is_forgotten(waiting):
    obj = scenes.scattered(scenes.sphere())
    drawn()
    bpy.data.objects.remove(obj)
    looked(waiting)
    assert not part().is_watching()
    other = scenes.scattered(scenes.sphere())
    drawn()
    looked(waiting)
    scenes.activate(other.dapple.surface)
    other.dapple.seed = 3
    assert not looked(waiting)
    assert not part().is_watching()


def test_without_a_panel_nothing_is_noted(waiting):
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.seed = 3
    obj.dapple.surface.location.x = 3.0
    assert not looked(waiting)
    assert not part().is_watching()


def test_a_look_that_fails_leaves_no_answer(waiting, monkeypatch):
    obj = scenes.scattered(scenes.sphere())
    drawn()
    looked(waiting)
    assert FITS in drawn()
    obj.dapple.surface.data.vertices[0].co *= 2.0
    bpy.context.view_layer.update()
    with monkeypatch.context() as patch:
        patch.setattr(part(), "verdict", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            part().tick()
    assert FITS not in drawn()
    looked(waiting)
    assert "has another shape or scale" in drawn()


def test_what_work_has_changed_is_compared_at_once(waiting, monkeypatch):
    """Edits may go on, so a check that takes long waits for their end; work has ended."""
    obj = scenes.scattered(scenes.sphere())
    drawn()
    looked(waiting)
    monkeypatch.setattr(part(), "PATIENCE", 1e9)
    obj.dapple.surface.data.vertices[0].co *= 1.001
    assert not looked(waiting)
    with monkeypatch.context() as patch:
        patch.setattr(part().step_operators, "is_under_way", lambda: True)
        obj.dapple.surface.data.vertices[0].co *= 1.001
        assert not looked(waiting)
    assert looked(waiting)["verdict"] == 1
    obj.dapple.surface.data.vertices[0].co *= 1.001
    assert not looked(waiting)


def test_nothing_is_compared_while_a_job_runs(waiting):
    obj = scenes.scattered(scenes.sphere())
    drawn()
    jobs, steps = addon_host.part("blender.base.jobs"), addon_host.part("core.base.steps")

    def work():
        yield steps.PAUSE
        yield steps.PAUSE

    job = jobs.Job("Optimize", work(), str, print, whole=False)
    job.begin()
    obj.dapple.surface.data.vertices[0].co *= 1.001
    assert not looked(waiting)
    job.close()
    assert looked(waiting)["verdict"] == 1
