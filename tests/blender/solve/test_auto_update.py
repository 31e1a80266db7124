# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update follows changes, and does nothing without one."""

import time

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
    made.dapple.auto_update_mode = "ON"  # on any machine, however slow
    return made


def followed(live, obj):
    assert reason(obj) != ""
    assert live.settle() == 1
    assert reason(obj) == ""
    assert live.settle() == 0


def grown(surface, name="Grass"):
    """A vertex group with the upper half of a surface."""
    group = surface.vertex_groups.get(name) or surface.vertex_groups.new(name=name)
    upper = [vertex.index for vertex in surface.data.vertices if vertex.co.z > 0.0]
    group.add(range(len(surface.data.vertices)), 0.2, "REPLACE")
    group.add(upper, 1.0, "REPLACE")
    return group


def viewed():
    """The scene's camera, above all else."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location.z = 9.0
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return camera


def test_a_setting_is_followed(live, obj):
    live.settle()
    obj.dapple.count = 90
    followed(live, obj)
    assert len(scenes.positions(obj)) == 90


def test_nothing_is_solved_while_nothing_changes(live, obj):
    assert live.settle() == 0
    obj.dapple.scale = 2.0  # changes instances only
    obj.location.x = 1.0
    assert live.settle() == 0
    obj.dapple.count = 70
    obj.dapple.count = 60
    assert live.settle() == 0


def test_a_background_blender_is_given_no_timer(live, obj):
    """It neither runs one nor frees one that is taken back, so that each change would keep some."""
    obj.dapple.count = 70
    bpy.context.view_layer.update()
    assert bpy.app.background
    assert not bpy.app.timers.is_registered(addon_host.part("blender.base.timers").run_due)


def test_nothing_is_read_before_the_changes_rest(live, obj):
    live.settle()
    for count in range(61, 70):
        obj.dapple.count = count
        live.clock.now += 0.5 * addon_host.part("core.base.schedule").PAUSE
        live.look()
        assert not live.watcher.is_solving()
        assert live.watcher.progress(obj) == 0.0
    followed(live, obj)
    assert obj.dapple.report.count == 69


def grown_and_followed(live, obj):
    """A vertex group that a stroke can change."""
    group = grown(obj.dapple.surface)
    obj.dapple.density.attribute = "Grass"
    live.settle()
    return group


@pytest.mark.parametrize("held", [True, False])
def test_no_pause_follows_a_stroke_or_a_move_that_has_ended(live, obj, held, monkeypatch):
    group = grown_and_followed(live, obj)
    monkeypatch.setattr(addon_host.part("blender.solve.changes"), "is_using_tool", lambda: True)
    if held:  # like a brush stroke
        monkeypatch.setattr(live.watcher, "is_blocked", lambda: True)
    for first in range(0, 60, 20):
        group.add(range(first, first + 20), 0.0, "REPLACE")
        obj.dapple.surface.data.update()
        assert live.look() < 0.05
        assert not live.watcher.is_solving()
    monkeypatch.undo()
    live.look()
    assert live.watcher.is_solving()
    followed(live, obj)


def test_no_pause_follows_an_operator_that_has_ended(live, obj, monkeypatch):
    group = grown_and_followed(live, obj)
    group.add(range(30), 0.0, "REPLACE")
    obj.dapple.surface.data.update()
    monkeypatch.setattr(addon_host.part("blender.solve.changes"), "last_operator", lambda: 7)
    live.look()
    assert live.watcher.is_solving()
    followed(live, obj)
    for count in (61, 62):  # a dragged value comes without an operator
        obj.dapple.count = count
        live.look()
        assert not live.watcher.is_solving()
    followed(live, obj)


def test_a_stroke_and_an_edited_or_scaled_surface_are_followed(live, obj):
    surface = obj.dapple.surface
    grown(surface)
    obj.dapple.density.attribute = "Grass"
    followed(live, obj)
    surface.vertex_groups["Grass"].add(range(40), 0.0, "REPLACE")
    surface.data.update()
    followed(live, obj)
    surface.data.vertices[5].co *= 1.5
    surface.data.update()
    followed(live, obj)
    surface.scale.x = 2.0
    followed(live, obj)
    surface.modifiers.new("Subdivision", "SUBSURF").levels = 1
    surface.modifiers["Subdivision"].render_levels = 1
    followed(live, obj)


def test_what_is_avoided_and_the_camera_are_followed(live, obj):
    surface = obj.dapple.surface
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    stone = scenes.sphere(location=(0.0, 0.0, 1.0))
    stones.objects.link(stone)
    obj.dapple.density.avoid_collection = stones
    followed(live, obj)
    stone.location.y = 0.5
    followed(live, obj)
    other = scenes.sphere(location=(1.0, 0.0, 0.0), scale=(0.3, 0.3, 0.3))
    stones.objects.link(other)
    followed(live, obj)
    camera = viewed()
    obj.dapple.density.use_camera_view = True
    followed(live, obj)
    camera.location.x = 0.5
    followed(live, obj)
    camera.data.lens = 80.0
    followed(live, obj)
    surface.location.x = 0.1
    followed(live, obj)


def test_what_it_writes_itself_does_not_begin_it_anew_under_a_camera(live, obj, monkeypatch):
    """A look while the figures are measured finds the points written, and the scene with them."""
    keep = addon_host.part("core.solve.incremental")
    measured = keep.measured
    monkeypatch.setattr(keep, "measured", lambda *now: (time.sleep(0.05), measured(*now))[1])
    camera = viewed()
    obj.dapple.density.use_camera_view = True
    live.settle()
    for x in (0.5, 0.2, -0.3):
        camera.location.x = x
        assert live.settle() == 1
        assert obj.dapple.report.spacing > 0.0


def test_the_width_of_a_render_is_followed_under_a_camera_alone(live, obj):
    viewed()
    scene = bpy.context.scene
    live.settle()
    scene.render.resolution_x = 900
    assert live.settle() == 0
    obj.dapple.density.use_camera_view = True
    live.settle()
    scene.render.resolution_x = 400
    followed(live, obj)


def test_a_painted_picture_is_followed(live, obj):
    image = bpy.data.images.new("Picture", 8, 8)
    image.pixels.foreach_set(np.full(256, 0.5, dtype=np.float32))
    obj.dapple.density.image = image
    followed(live, obj)
    assert live.settle() == 0
    image.pixels.foreach_set(np.linspace(0.1, 1.0, 256, dtype=np.float32))
    followed(live, obj)
    assert live.look() is not None  # the next check
    obj.dapple.density.image = None
    followed(live, obj)
    assert live.look() is None


def test_a_change_meanwhile_begins_again_and_the_old_points_stay(live, obj):
    live.settle()
    before = scenes.positions(obj)
    long(obj)
    assert live.begin()
    assert live.watcher.progress(obj) is not None
    assert np.array_equal(scenes.positions(obj), before)
    short(obj)
    assert not live.watcher.is_solving()
    followed(live, obj)
    assert len(scenes.positions(obj)) == 80


def test_cancel_leaves_the_points_and_says_that_they_are_out_of_date(live, obj):
    live.settle()
    assert not bpy.ops.dapple.cancel_update.poll()
    long(obj)
    assert live.begin()
    assert bpy.ops.dapple.cancel_update() == {"FINISHED"}
    assert live.settle() == 0
    assert len(scenes.positions(obj)) == 60
    assert "Settings were changed" in reason(obj)


def test_on_by_itself_while_it_is_quick_and_as_the_artist_says(live, obj):
    settings = obj.dapple
    settings.auto_update_mode = "AUTOMATIC"
    settings.report.milliseconds = 999.0
    assert settings.auto_update
    settings.report.milliseconds = 1001.0
    assert not settings.auto_update
    live.settle()
    settings.count = 70
    assert live.settle() == 0
    settings.auto_update = True
    followed(live, obj)
    settings.report.milliseconds = 1001.0
    assert settings.auto_update
    settings.auto_update = False
    settings.report.milliseconds = 1.0
    assert not settings.auto_update
    settings.count = 80
    assert live.settle() == 0


def baked(obj):
    bpy.context.scene.frame_end = 2
    assert bpy.ops.dapple.bake() == {"FINISHED"}


def excluded(obj):
    for collection in obj.users_collection:
        collection.objects.unlink(obj)


def edited(obj):
    obj.data.vertices[3].co.z += 0.1
    obj.data.update()


def in_edit_mode(obj):
    scenes.activate(obj)
    bpy.ops.object.mode_set(mode="EDIT")


@pytest.mark.parametrize("keep", [baked, excluded, edited, in_edit_mode])
def test_what_would_be_lost_or_is_not_there_is_left_alone(live, obj, keep):
    keep(obj)
    live.settle()
    obj.dapple.count = 70
    assert live.settle() == 0
    assert len(obj.data.vertices) == 60


def test_what_was_not_there_is_followed_once_it_is(live, obj):
    excluded(obj)
    live.settle()
    obj.dapple.count = 70
    assert live.settle() == 0
    bpy.context.collection.objects.link(obj)
    followed(live, obj)


def test_a_shape_that_is_edited_at_another_frame_is_followed_where_the_points_were_solved(
    live, obj
):
    live.settle()
    scene, mesh = bpy.context.scene, obj.dapple.surface.data
    scene.frame_set(scene.frame_current + 1)
    mesh.vertices[3].co *= 1.2
    mesh.update()
    assert live.settle() == 0  # the surface may move again
    assert reason(obj) == ""
    scene.frame_set(scene.frame_current - 1)
    followed(live, obj)
    scene.frame_set(scene.frame_current + 1)
    scene.frame_set(scene.frame_current - 1)
    assert live.settle() == 0


def test_playing_a_frame_is_no_change(live):
    obj = scenes.scattered(scenes.tail(frames=6))
    obj.dapple.auto_update_mode = "ON"
    live.settle()
    for frame in (2, 4, 6):
        bpy.context.scene.frame_set(frame)
        assert live.settle() == 0


def test_nothing_is_done_while_something_else_has_the_file(live, obj, monkeypatch):
    live.settle()
    obj.dapple.count = 70
    monkeypatch.setattr(live.watcher, "is_blocked", lambda: True)
    for _ in range(5):
        live.clock.rest()
        assert live.look() > 0.0
    assert len(obj.data.vertices) == 60
    monkeypatch.undo()
    followed(live, obj)


@pytest.mark.parametrize("interruption", ["render", "operator"])
def test_a_render_and_an_operator_take_its_place_and_it_goes_on_afterward(
    live, obj, interruption, monkeypatch
):
    live.settle()
    short(obj, 20_000)
    assert live.begin()
    if interruption == "render":
        for event in ("render_began", "render_ended"):
            addon_host.part("blender.base.handlers").publish(event)
    else:
        for name in ("is_under_way", "is_blocked"):
            monkeypatch.setattr(live.watcher, name, lambda: True)
        live.look()
        monkeypatch.undo()
    assert not live.watcher.is_solving()
    assert len(obj.data.vertices) == 60
    followed(live, obj)


def test_figures_that_an_interruption_prevented_are_measured_afterward(live, obj):
    live.settle()
    obj.dapple.count = 5000
    live.begin()
    while obj.dapple.report.measured:
        live.look()
    assert len(obj.data.vertices) == 5000
    for event in ("render_began", "render_ended"):
        addon_host.part("blender.base.handlers").publish(event)
    assert not live.watcher.is_solving()
    live.settle()
    assert obj.dapple.report.measured
    assert live.settle() == 0


@pytest.mark.parametrize("action", ["ADD", "REMOVE", "DOWN"])
def test_the_list_of_object_types_is_followed(live, obj, action):
    for _ in range(2):
        bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[0].weight, obj.dapple.object_type_index = 3.0, 0
    live.settle()
    assert reason(obj) == ""
    bpy.ops.dapple.edit_object_types(action=action)
    assert reason(obj)
    assert live.settle() == 1
    assert reason(obj) == ""


def test_in_background_mode_nothing_follows(obj):
    obj.dapple.count = 70
    bpy.context.view_layer.update()
    watcher = addon_host.part("blender.solve.auto_update")
    assert not watcher.is_active()
    assert watcher.tick() is None
    assert not watcher.has_noted()


def test_scatters_that_avoid_each_other_come_to_rest(live):
    surface = scenes.sphere()
    both = [scenes.scattered(surface, count=30) for _ in range(2)]
    for one, other in (both, both[::-1]):
        collection = bpy.data.collections.new(f"Around {one.name}")
        collection.objects.link(other)
        bpy.context.scene.collection.children.link(collection)
        one.dapple.density.avoid_collection = collection
        one.dapple.density.avoid_margin = 0.05
        one.dapple.auto_update_mode = "ON"
    assert 2 <= live.settle() <= 4
    both[0].dapple.seed = 5
    assert live.settle() == 2


@pytest.mark.parametrize("hidden", [False, True])
@pytest.mark.parametrize("display", ["INSTANCES", "POINTS"])
def test_shapes_that_are_avoided_are_followed_and_come_to_rest(live, display, hidden):
    surface = scenes.sphere()
    other = scenes.scattered(surface, count=10)
    obj = scenes.scattered(surface, count=60)
    density = obj.dapple.density
    density.avoid_collection, density.avoid_shape = scenes.collection_of(other), "HULL"
    obj.dapple.auto_update_mode, other.dapple.auto_update_mode = "ON", "OFF"
    other.dapple.display_as = display
    other.hide_set(hidden)
    live.settle()
    assert live.settle() == 0
    other.dapple.scale *= 1.5
    assert live.settle() == 1
    assert reason(obj) == ""
    assert other.dapple.display_as == display
    assert other.hide_get() == hidden


def test_a_trouble_is_said_until_it_is_gone(live, obj):
    live.settle()
    obj.dapple.density.attribute = "Missing"
    assert live.settle() == 0
    assert "no attribute or vertex group 'Missing'" in live.watcher.trouble(obj)
    grown(obj.dapple.surface, "Missing")
    obj.dapple.surface.data.update()
    followed(live, obj)
    assert not live.watcher.trouble(obj)


@pytest.mark.parametrize("reloaded", [False, True])
def test_unlocking_is_followed_where_more_points_were_locked_than_there_shall_be(
    live, obj, reloaded, tmp_path
):
    live.settle()
    scenes.activate(obj)
    assert bpy.ops.dapple.lock_points(every=True) == {"FINISHED"}
    assert live.settle() == 0
    obj.dapple.count = 40
    assert live.settle() == 0
    assert "60 points are locked, the count is 40" in live.watcher.trouble(obj)
    if reloaded:
        path = str(tmp_path / "locked.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
        obj = bpy.data.objects["Sphere Scatter"]
        scenes.activate(obj)
    assert bpy.ops.dapple.lock_points(lock=False, every=True) == {"FINISHED"}
    followed(live, obj)
    assert not live.watcher.trouble(obj)
    assert len(obj.data.vertices) == 40


def test_a_scatter_that_is_removed_meanwhile_is_forgotten(live, obj):
    live.settle()
    long(obj)
    assert live.begin()
    bpy.data.objects.remove(obj)
    live.look()
    assert not live.watcher.is_solving()
    assert live.settle() == 0


def test_an_undo_is_one_step_for_the_change_and_the_points_fit_again(live, obj):
    name = obj.name
    live.settle()
    bpy.ops.ed.undo_push(message="Before")
    obj.dapple.count = 90
    bpy.ops.ed.undo_push(message="Count")  # like the interface, before the points are computed
    assert live.settle() == 1
    for undo, count in ((bpy.ops.ed.undo, 60), (bpy.ops.ed.redo, 90), (bpy.ops.ed.undo, 60)):
        undo()
        obj = bpy.data.objects[name]
        assert obj.dapple.count == count
        live.settle()
        assert reason(obj) == ""
        assert len(obj.data.vertices) == len(scenes.positions(obj)) == count


def test_an_undo_of_something_else_keeps_what_was_updated(live, obj):
    name = obj.name
    live.settle()
    bpy.ops.ed.undo_push(message="Before")
    obj.dapple.count = 90
    bpy.ops.ed.undo_push(message="Count")
    live.settle()
    bpy.context.scene.cursor.location.x = 1.0
    bpy.data.objects[name].dapple.surface.name = "Renamed"
    bpy.ops.ed.undo_push(message="Rename")
    bpy.ops.ed.undo()
    live.settle()
    obj = bpy.data.objects[name]
    assert obj.dapple.count == len(scenes.positions(obj)) == 90
    assert reason(obj) == ""


def test_no_update_is_announced_where_none_will_come(live, obj):
    """The bar stood at 0 % over a character that takes too long for Auto Update, until the mouse
    was moved over the sidebar.
    """
    obj.dapple.auto_update_mode = "OFF"
    obj.dapple.seed = 1
    assert live.watcher.progress(obj) is None
    live.watcher.request(obj)
    assert live.watcher.progress(obj) == 0.0
