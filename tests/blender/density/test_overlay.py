# SPDX-License-Identifier: GPL-3.0-or-later
"""The density as colors: what is drawn, and when it is computed again."""

import addon_host
import bpy
import drawn
import numpy as np
import probe
import pytest
import scenes
import windowed


def sloped(**density):
    obj = scenes.scattered(scenes.sphere(), count=40)
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    return obj


def wait(overlay):
    """The timer, after nothing has changed for a while."""
    return overlay.tick()


def test_colors_tell_where_points_will_be(overlay):
    obj = sloped(use_height=True, height_min=0.0, height_max=2.0, height_falloff=0.0)
    assert bpy.ops.dapple.show_density() == {"FINISHED"}
    assert overlay.is_on(obj)
    positions, colors = overlay.triangles()
    above, below = positions[:, 2] > 0.1, positions[:, 2] < -0.1
    most, none = addon_host.part("core.density.colors").colored(np.array([1.0, 0.0]))
    np.testing.assert_allclose(colors[above], np.tile(most, (above.sum(), 1)))
    np.testing.assert_allclose(colors[below], np.tile(none, (below.sum(), 1)))
    assert bpy.ops.dapple.show_density() == {"FINISHED"}
    assert not overlay.is_on(obj)


def test_colors_follow_settings_and_the_surface(overlay):
    obj = sloped(use_height=True)
    bpy.ops.dapple.show_density()
    before = overlay.triangles()
    obj.dapple.density.height_min = 0.5
    wait(overlay)
    settled = overlay.triangles()
    assert settled[1].shape != before[1].shape or not np.array_equal(settled[1], before[1])
    obj.dapple.surface.location.x = 3.0
    bpy.context.view_layer.update()
    wait(overlay)
    assert overlay.triangles()[0][:, 0].min() > 1.9


def test_the_shown_class_counts(overlay):
    obj = sloped()
    group = obj.dapple.surface.vertex_groups.new(name="Half")
    group.add([v.index for v in obj.dapple.surface.data.vertices if v.co.z > 0], 1.0, "REPLACE")
    bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[0].density = "Half"
    bpy.ops.dapple.show_density()
    positions, colors = overlay.triangles()
    assert len(np.unique(colors[positions[:, 2] < -0.2], axis=0)) == 1
    assert len(np.unique(colors, axis=0)) > 1


def test_what_cannot_be_shown_is_reported_and_ends(overlay):
    obj = sloped(attribute="Nowhere")
    with pytest.raises(RuntimeError, match="no attribute or vertex group 'Nowhere'"):
        bpy.ops.dapple.show_density()
    assert not overlay.is_on(obj)
    obj.dapple.density.attribute = ""
    bpy.ops.dapple.show_density()
    obj.dapple.density.attribute = "Nowhere"
    assert wait(overlay) is None
    assert not overlay.is_on(obj)
    assert "Nowhere" in overlay.note()


def test_a_scatter_that_is_deleted_and_a_new_file_end_it(overlay):
    obj = sloped()
    bpy.ops.dapple.show_density()
    overlay.touch(obj)
    bpy.data.objects.remove(obj)
    assert wait(overlay) is None
    obj = sloped()
    bpy.ops.dapple.show_density()
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    assert not overlay.is_on(obj)


def looked(overlay):
    """The timer, often enough for what changed without a word to be noticed."""
    wait(overlay)
    wait(overlay)
    return overlay.triangles()


def test_the_class_that_is_chosen_later_is_shown(overlay):
    obj = sloped()
    surface = obj.dapple.surface
    for name, sign in (("Upper", 1), ("Lower", -1)):
        group = surface.vertex_groups.new(name=name)
        chosen = [v.index for v in surface.data.vertices if sign * v.co.z > 0]
        group.add(chosen, 1.0, "REPLACE")
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].density = name
    obj.dapple.object_type_index = 0
    bpy.ops.dapple.show_density()
    positions, first = overlay.triangles()
    obj.dapple.object_type_index = 1
    _, second = looked(overlay)
    most = addon_host.part("core.density.colors").colored(np.array([1.0]))
    assert (first[positions[:, 2] > 0.3] == most).all()
    assert (second[positions[:, 2] < -0.3] == most).all()


def seen_by_a_camera():
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    camera.location = (0.5, 0.0, 4.0)
    bpy.context.view_layer.update()
    return camera


def moved(camera):
    camera.location.x = -0.5


def zoomed(camera):
    camera.data.lens = 100.0


def made_narrow(camera):
    bpy.context.scene.render.resolution_x = 500


def replaced(camera):
    other = bpy.data.objects.new("Other", bpy.data.cameras.new("Other"))
    bpy.context.collection.objects.link(other)
    other.location = (-0.5, 0.0, 4.0)
    bpy.context.scene.camera = other


def gone_on(camera):
    camera.keyframe_insert("location", frame=1)
    camera.location.x = -0.5
    camera.keyframe_insert("location", frame=5)
    bpy.context.scene.frame_set(1)
    bpy.context.scene.frame_set(5)


@pytest.mark.parametrize("change", [moved, zoomed, made_narrow, replaced, gone_on])
def test_colors_follow_the_camera(overlay, change):
    camera = seen_by_a_camera()
    camera.data.lens = 80.0
    obj = sloped(use_camera_view=True, camera_margin=0.0)
    scenes.activate(obj)
    bpy.ops.dapple.show_density()
    before = overlay.triangles()
    change(camera)
    bpy.context.view_layer.update()
    after = looked(overlay)
    assert len(before[0]) != len(after[0]) or not np.array_equal(before[1], after[1])


def test_colors_follow_a_frame_of_a_moving_surface_and_another_surface(overlay):
    obj = scenes.scattered(scenes.tail(), count=40)
    other = scenes.sphere(location=(5.0, 0.0, 0.0))
    scenes.activate(obj)
    bpy.ops.dapple.show_density()
    before, _ = overlay.triangles()
    bpy.context.scene.frame_set(6)
    after, _ = looked(overlay)
    assert not np.allclose(before, after, atol=0.1)
    obj.dapple.surface = other
    assert looked(overlay)[0][:, 0].min() > 3.9


def test_nothing_is_computed_while_nothing_changes(overlay, monkeypatch):
    seen_by_a_camera()
    obj = sloped(use_camera_view=True)
    scenes.activate(obj)
    bpy.ops.dapple.show_density()
    looked(overlay)
    monkeypatch.setattr(overlay, "computed", lambda *_: pytest.fail("it was computed"))
    for _ in range(3):
        wait(overlay)


def test_colors_of_a_vertex_group_are_computed_once(overlay, monkeypatch):
    """Reading it makes a copy of the mesh, which is no change."""
    obj, calls = scenes.scattered(scenes.tail(), count=40), []
    obj.dapple.density.attribute = "tip"
    compute = overlay.computed
    monkeypatch.setattr(overlay, "computed", lambda *given: calls.append(1) or compute(*given))
    bpy.ops.dapple.show_density()
    looked(overlay)
    calls.clear()
    for _ in range(3):
        obj.dapple.surface.update_tag()
        bpy.context.view_layer.update()
        looked(overlay)
    assert len(calls) == 3


def test_colors_are_computed_by_a_worker_and_the_last_ones_are_shown_until_then(
    overlay, monkeypatch
):
    obj = sloped(use_height=True)
    bpy.ops.dapple.show_density()
    before, colors = overlay.triangles()
    monkeypatch.setattr(addon_host.part("blender.base.jobs"), "at_once", False)
    event, threads = windowed.held_back(monkeypatch, overlay, "computed")
    obj.dapple.density.height_min = 0.5
    windowed.until(lambda: threads, lambda: wait(overlay))
    for _ in range(3):
        wait(overlay)
        assert overlay.triangles()[0] is before
    event.set()
    windowed.until(lambda: not overlay.is_computing(), lambda: wait(overlay))
    assert not np.array_equal(overlay.triangles()[1], colors)
    assert not {thread.name for thread in threads} & {"MainThread"}


def test_what_cannot_be_shown_is_reported_by_the_panel_of_a_window(overlay, monkeypatch):
    obj = sloped(attribute="Nowhere")
    monkeypatch.setattr(addon_host.part("blender.base.jobs"), "at_once", False)
    overlay.start(obj)
    assert overlay.note() == "The density is being computed"
    windowed.until(lambda: not overlay.is_on(obj), lambda: wait(overlay))
    assert overlay.note().startswith("Density is not shown: Surface 'Sphere' has no attribute")


def test_nothing_is_computed_while_blender_renders(overlay, monkeypatch):
    obj = sloped(use_height=True)
    bpy.ops.dapple.show_density()
    ticked, draw, asked = [], probe.ProbeEngine.empty_picture, overlay.request_of

    def drawn(self, scene):
        overlay.touch(obj)
        wait(overlay)
        draw(self, scene)

    monkeypatch.setattr(overlay, "request_of", lambda obj: ticked.append(1) or asked(obj))
    monkeypatch.setattr(probe.ProbeEngine, "empty_picture", drawn)
    with probe.registered():
        probe.render(obj, 1)
    assert not ticked
    wait(overlay)
    assert ticked


def test_a_render_stops_the_worker_and_colors_come_afterward(overlay, monkeypatch):
    obj = sloped(use_height=True)
    bpy.ops.dapple.show_density()
    before, _ = overlay.triangles()
    monkeypatch.setattr(addon_host.part("blender.base.jobs"), "at_once", False)
    event, threads = windowed.held_back(monkeypatch, overlay, "computed")
    obj.dapple.density.height_min = 0.5
    windowed.until(lambda: threads, lambda: wait(overlay))
    with probe.registered():
        probe.render(obj, 1)
    event.set()
    windowed.until(lambda: len(threads) == 2, lambda: wait(overlay))
    windowed.until(lambda: not overlay.is_computing(), lambda: wait(overlay))
    assert overlay.triangles()[0] is not before


def test_colors_are_drawn_where_the_surface_is(overlay):
    bpy.ops.mesh.primitive_grid_add(size=2.0)
    for vertex in bpy.context.object.data.vertices:
        vertex.co.z = 0.1 * (vertex.co.x > 0.0)
    density = scenes.scattered(bpy.context.object, count=40).dapple.density
    density.use_height, density.height_falloff = True, 0.0
    density.height_min, density.height_max = 0.05, 1.0
    bpy.ops.dapple.show_density()
    most, none = addon_host.part("core.density.colors").colored(np.array([1.0, 0.0]))
    found = drawn.picture(overlay.draw, (-2.0, -2.0), (2.0, 2.0), (64, 64))[..., :3]
    np.testing.assert_allclose(found[32, 44], most[:3] * most[3], atol=0.01)
    np.testing.assert_allclose(found[32, 20], none[:3] * none[3], atol=0.01)
    assert not found[:, 50:].any()
