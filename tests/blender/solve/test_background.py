# SPDX-License-Identifier: GPL-3.0-or-later
"""Optimize in the background: edits during the work are not lost, undo is a single step."""

from types import SimpleNamespace

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import reason
from following import long, short


@pytest.fixture
def obj():
    made = scenes.scattered(scenes.sphere(), count=60)
    made.dapple.auto_update_mode = "OFF"
    return made


def test_it_is_what_a_script_gets(live, obj):
    obj.dapple.count = 90
    bpy.ops.dapple.optimize()
    wanted = scenes.positions(obj)
    obj.dapple.count = 60
    bpy.ops.dapple.optimize()
    live.settle()
    obj.dapple.count = 90
    live.watcher.request(obj)
    assert live.watcher.is_requested(obj)
    assert live.watcher.progress(obj) == 0.0
    assert live.settle() == 1
    assert np.array_equal(scenes.positions(obj), wanted)
    assert reason(obj) == ""
    assert not live.watcher.is_requested(obj)


def test_it_looks_again_whether_renders_have_other_faces(live):
    surface = scenes.tail()
    obj = scenes.scattered(surface)
    obj.dapple.auto_update_mode = "OFF"
    assert obj.dapple.attached_to == "FACES"
    surface.modifiers["Subdivision"].render_levels = 2
    live.watcher.request(obj)
    assert live.settle() == 1
    assert obj.dapple.attached_to == "REST"


def test_it_does_not_wait_for_a_pause_and_the_old_points_stay(live, obj):
    live.settle()
    before = scenes.positions(obj)
    long(obj)
    live.watcher.request(obj)
    live.look()
    assert live.watcher.is_requested(obj)
    assert np.array_equal(scenes.positions(obj), before)


def test_the_next_one_takes_the_place_of_the_one_before(live, obj):
    live.settle()
    long(obj)
    live.watcher.request(obj)
    assert live.begin()
    short(obj)
    live.watcher.request(obj)
    assert live.settle() == 1
    assert len(scenes.positions(obj)) == 80


def test_a_change_meanwhile_begins_again_and_nothing_else_does(live, obj):
    live.settle()
    long(obj)
    live.watcher.request(obj)
    assert live.begin()
    obj.location.x = 1.0
    obj.dapple.scale = 2.0
    assert live.begin()
    assert live.watcher.is_solving()
    short(obj)
    assert not live.watcher.is_solving()
    assert live.watcher.is_requested(obj)
    assert live.settle() == 1
    assert len(scenes.positions(obj)) == 80
    assert reason(obj) == ""


def test_cancel_writes_nothing(live, obj):
    live.settle()
    before = scenes.snapshot()
    long(obj)
    live.watcher.request(obj)
    assert live.begin()
    assert bpy.ops.dapple.cancel_update() == {"FINISHED"}
    assert live.settle() == 0
    assert scenes.snapshot() == before
    assert not live.watcher.is_requested(obj)
    assert not live.watcher.trouble(obj)


def moved(obj):
    obj.data.vertices[3].co.z += 0.1
    obj.data.update()


def in_edit_mode(obj):
    scenes.activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")


def baked(obj):
    obj.dapple.baked_keys = 2


def hidden(obj):
    for collection in obj.users_collection:
        collection.objects.unlink(obj)


@pytest.mark.parametrize("meanwhile", [moved, in_edit_mode, baked, hidden])
def test_what_is_done_to_the_points_meanwhile_is_not_lost(live, obj, meanwhile):
    live.settle()
    short(obj, 20_000)
    live.watcher.request(obj)
    assert live.begin()
    meanwhile(obj)
    assert live.settle() == 0
    assert len(obj.data.vertices) == 60
    assert f"'{obj.name}'" in live.watcher.trouble(obj)
    assert not live.watcher.is_requested(obj)


def test_points_that_are_locked_meanwhile_stay(live, obj):
    live.settle()
    before = scenes.positions(obj)
    short(obj, 20_000)
    live.watcher.request(obj)
    assert live.begin()
    scenes.activate(obj)
    assert bpy.ops.dapple.lock_points(every=True) == {"FINISHED"}
    assert live.settle() == 1
    assert obj.dapple.locked_count == 60
    assert np.allclose(scenes.positions(obj)[:60], before, atol=1e-6)


def test_an_error_is_said_and_the_scene_stays(live, obj):
    live.settle()
    obj.dapple.density.attribute = "Missing"
    before = scenes.snapshot()
    live.watcher.request(obj)
    assert live.settle() == 0
    assert "no attribute or vertex group 'Missing'" in live.watcher.trouble(obj)
    assert scenes.snapshot() == before
    obj.dapple.density.attribute = ""
    live.watcher.request(obj)
    assert not live.watcher.trouble(obj)
    assert live.settle() == 1


@pytest.mark.parametrize("begun", [True, False])
def test_a_scatter_or_file_that_is_gone_is_forgotten(live, obj, begun):
    live.settle()
    long(obj)
    live.watcher.request(obj)
    if begun:
        assert live.begin()
    bpy.data.objects.remove(obj)
    assert live.settle() == 0
    assert not live.watcher.is_active()


def test_another_file_is_left_alone(live, obj):
    long(obj)
    live.watcher.request(obj)
    assert live.begin()
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    assert not live.watcher.is_active()
    assert not live.watcher.is_active()


def test_it_waits_while_an_object_is_moved(live, obj, monkeypatch):
    live.settle()
    short(obj)
    live.watcher.request(obj)
    monkeypatch.setattr(live.watcher, "is_operated", lambda: True)
    for _ in range(20):
        live.look()
    assert len(obj.data.vertices) == 60
    monkeypatch.undo()
    assert live.settle() == 1


def test_a_script_takes_its_place(live, obj):
    live.settle()
    long(obj)
    live.watcher.request(obj)
    assert live.begin()
    short(obj)
    scenes.activate(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert live.settle() == 0
    assert not live.watcher.is_requested(obj)


def test_an_undo_is_one_step_that_holds_the_points(live, obj):
    name = obj.name
    live.settle()
    obj.dapple.count = 90
    bpy.ops.ed.undo_push(message="Count")
    live.watcher.request(obj)
    assert live.settle() == 1
    for undo, points in ((bpy.ops.ed.undo, 60), (bpy.ops.ed.redo, 90), (bpy.ops.ed.undo, 60)):
        undo()
        obj = bpy.data.objects[name]
        assert live.settle() == 0
        assert obj.dapple.count == 90
        assert len(scenes.positions(obj)) == points
        assert bool(reason(obj)) == (points != 90)


def test_an_undo_meanwhile_begins_again_with_what_it_brings_back(live, obj):
    name = obj.name
    live.settle()
    bpy.ops.ed.undo_push(message="Before")
    long(obj)
    bpy.ops.ed.undo_push(message="Count")
    live.watcher.request(obj)
    assert live.begin()
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    assert live.settle() == 1
    assert obj.dapple.count == len(scenes.positions(obj)) == 60
    assert reason(obj) == ""


def test_in_edit_mode_of_another_mesh_there_is_no_step(live, obj, monkeypatch):
    pushed = []
    undo = addon_host.part("blender.base.jobs")
    live.settle()
    short(obj)
    live.watcher.request(obj)
    scenes.activate(scenes.sphere(location=(9.0, 0.0, 0.0)))
    bpy.ops.object.mode_set(mode="EDIT")
    pushing = SimpleNamespace(undo_push=lambda message: pushed.append(message))
    ops = SimpleNamespace(ed=pushing)  # bpy.ops creates its submodules anew each time
    monkeypatch.setattr(undo, "bpy", SimpleNamespace(context=bpy.context, ops=ops))
    assert live.settle() == 1
    assert pushed == []
    assert reason(obj) == ""
    bpy.ops.object.mode_set(mode="OBJECT")
    undo.push_undo("Optimize")
    assert pushed == ["Optimize"]
