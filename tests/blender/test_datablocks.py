# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies, shared scenes, linked files and overrides: only one scatter is written."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.empty_file  # the node groups are built here


def moving(count=60):
    """A baked scatter on a tail that bends."""
    obj = scenes.scattered(scenes.tail(frames=4), count)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


def duplicated(*objects, linked=False):
    """Copies by the operator behind Shift-D and Alt-D, in the order of the objects."""
    for other in bpy.context.selected_objects:
        other.select_set(False)
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]
    before = set(bpy.data.objects)
    assert bpy.ops.object.duplicate(linked=linked) == {"FINISHED"}
    made = {one.name: one for one in bpy.data.objects if one not in before}
    return [made[f"{obj.name}.001"] for obj in objects]


def stored(obj, name):
    return addon_host.part("nodes").get_input(obj.modifiers[0], name)


def played(obj):
    """World positions over the whole range."""
    found = []
    for frame in range(1, 5):
        bpy.context.scene.frame_set(frame)
        found.append(scenes.positions(obj))
    return np.array(found)


def select(obj):
    scenes.activate(obj)
    return obj.dapple


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize("action", ["clear_bake", "bake", "optimize", "reattach"])
def test_what_is_done_to_a_copy_leaves_the_original_as_it_is(linked, action):
    obj = moving()
    expected = played(obj)
    (copy,) = duplicated(obj, linked=linked)
    assert (played(copy) == expected).all()
    bpy.context.scene.frame_set(3)
    select(copy).repulsion_weight = 1.0
    assert getattr(bpy.ops.dapple, action)() == {"FINISHED"}
    assert np.abs(played(copy) - expected).max() > 1e-4
    assert (played(obj) == expected).all()
    assert scenes.node_warnings(obj) == []


def test_what_is_done_to_the_original_leaves_a_linked_copy_as_it_is():
    obj = moving()
    expected = played(obj)
    (copy,) = duplicated(obj, linked=True)
    select(obj).count = 40
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 40
    assert (played(copy) == expected).all()


def test_points_are_locked_on_one_of_two_linked_copies():
    obj = scenes.scattered(scenes.sphere())
    (copy,) = duplicated(obj, linked=True)
    assert bpy.ops.dapple.lock_points(every=True) == {"FINISHED"}
    assert (copy.dapple.locked_count, obj.dapple.locked_count) == (60, 0)
    assert not any(one.value for one in obj.data.attributes["dapple_locked"].data)


def test_a_mesh_with_one_user_stays_the_same_mesh():
    obj = scenes.scattered(scenes.sphere())
    mesh = obj.data
    mesh.use_fake_user = True
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.data == mesh


def test_points_that_a_bake_added_stay_with_the_original_of_a_linked_copy():
    surface = scenes.sphere()
    for frame, size in ((1, 1.0), (4, 1.5)):
        surface.scale = (size,) * 3
        surface.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_end = 4
    obj = scenes.scattered(surface)
    obj.dapple.population, obj.dapple.fade_duration = "KEEP_DENSITY", 1
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(4)
    expected = scenes.positions(obj)
    assert len(expected) > 80
    (copy,) = duplicated(obj, linked=True)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert len(scenes.positions(copy)) == 60
    assert (scenes.positions(obj) == expected).all()


def test_the_last_scatter_that_plays_stored_keys_takes_them_along():
    obj = moving()
    keys = [stored(obj, name).name for name in ("Keys", "Triangles", "Frames")]
    (copy,) = duplicated(obj)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert all(name in bpy.data.objects for name in keys)
    select(obj)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert not any(name in bpy.data.objects for name in keys)
    assert len(scenes.positions(copy)) == len(scenes.positions(obj)) == 60


def test_a_scatter_copied_with_its_surface_sits_on_the_copy():
    obj = moving()
    expected = played(obj)
    surface, copy = duplicated(obj.dapple.surface, obj)
    assert copy.dapple.surface == stored(copy, "Surface") == surface
    surface.location.x = 7.0  # the bones stay in place, and so do the points on them
    bpy.data.objects["Rig"].location.x = 7.0
    assert (played(copy) - expected)[..., 0].min() > 6.9
    select(copy).count = 30
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert played(copy).shape[1] == 30
    assert played(obj).shape[1] == 60


def test_each_copy_has_tiles_of_its_own():
    obj = scenes.scattered(scenes.sphere())
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    first = obj.dapple.tiles.object
    first.modifiers.new("Bevel", "BEVEL")
    polygons = len(first.data.polygons)
    (copy,) = duplicated(obj)
    select(copy).count = 10
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    second = copy.dapple.tiles.object
    assert (obj.dapple.tiles.object, len(first.data.polygons)) == (first, polygons)
    assert second != first
    assert len(second.data.polygons) < polygons / 2
    assert second.modifiers.keys() == ["Dapple Tiles", "Bevel"]
    assert second.users_collection == copy.users_collection
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    assert copy.dapple.tiles.object == second


def test_tiles_that_were_deleted_are_made_anew_where_they_are_seen():
    obj = scenes.scattered(scenes.sphere())
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    scenes.activate(obj.dapple.tiles.object)
    assert bpy.ops.object.delete() == {"FINISHED"}
    select(obj)
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    assert obj.dapple.tiles.object.name in bpy.context.view_layer.objects


def test_tiles_are_written_over_nothing_else():
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT"))
    twin = bpy.data.objects.new("Twin", surface.data)
    before = scenes.snapshot()
    for wrong in (light, surface, obj, twin):
        obj.dapple.tiles.object = wrong
        with pytest.raises(RuntimeError, match=f"'{wrong.name}' cannot hold the tiles of"):
            bpy.ops.dapple.make_tiles()
        assert scenes.snapshot() == before


def test_a_preview_is_not_shared_with_a_copy():
    preview = addon_host.part("blender.display.preview")
    obj = scenes.scattered(scenes.tail(frames=8))
    obj.dapple.preview_budget = 60_000
    assert bpy.ops.dapple.live_preview() == {"FINISHED"}
    (copy,) = duplicated(obj)
    assert bpy.ops.dapple.live_preview() == {"FINISHED"}
    assert preview.is_on(copy)
    assert stored(copy, "Preview") != stored(obj, "Preview")
    for one in (copy, obj):
        select(one)
        assert bpy.ops.dapple.live_preview() == {"FINISHED"}
    assert stored(copy, "Preview") is stored(obj, "Preview") is None
    assert not [one for one in bpy.data.objects if one.name.endswith("Preview")]


@pytest.mark.parametrize("copied", [False, True])
def test_a_preview_shows_what_was_solved_while_it_is_on(copied):
    obj = scenes.scattered(scenes.tail(frames=8))
    assert bpy.ops.dapple.live_preview() == {"FINISHED"}
    if copied:
        (obj,) = duplicated(obj)
    obj.dapple.seed = 5
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    local = np.array([vertex.co for vertex in obj.data.vertices])
    assert np.allclose(scenes.positions(obj), local, atol=1e-5)


@pytest.mark.parametrize("kind", ["FULL_COPY", "LINK_COPY"])
def test_another_scene_plays_and_solves_by_itself(kind):
    obj = moving()
    expected, first = played(obj), bpy.context.scene
    assert bpy.ops.scene.new(type=kind) == {"FINISHED"}
    scene = bpy.context.scene
    assert scene != first
    own = next(one for one in scene.objects if one.dapple.surface)
    assert (own == obj) == (kind == "LINK_COPY")
    assert own.dapple.surface.name in scene.objects
    assert (played(own) == expected).all()
    scene.frame_end = 3
    select(own).count = 25
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert (own.dapple.baked_frames, len(scenes.positions(own))) == (3, 25)
    bpy.context.window_manager.windows[0].scene = first
    assert bpy.context.scene == first
    assert played(obj).shape[1] == (60 if kind == "FULL_COPY" else 25)
    if kind == "FULL_COPY":
        assert (played(obj) == expected).all()
