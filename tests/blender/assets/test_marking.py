# SPDX-License-Identifier: GPL-3.0-or-later
"""A scatter as an asset: marked, saved, appended into another file, placed there and solved."""

import addon_host
import bpy
import child
import numpy as np
import pytest
import scenes
import test_panels

APPENDED = """
with bpy.data.libraries.load(arguments[0], assets_only=True) as (found, wanted):
    wanted.objects = list(found.objects)
assert not hasattr(bpy.types.Object, "dapple")
(obj,) = wanted.objects
bpy.context.scene.collection.objects.link(obj)
bpy.context.view_layer.update()
depsgraph = bpy.context.evaluated_depsgraph_get()
parents = [one.parent for one in depsgraph.object_instances if one.is_instance]
print("instances", len(parents), "others", len(bpy.context.scene.objects) - 4)
bpy.ops.wm.save_as_mainfile(filepath=arguments[1])
"""


def thing(name, size):
    bpy.ops.mesh.primitive_cube_add(size=size)
    bpy.context.object.name = name
    return bpy.context.object


@pytest.fixture
def made():
    """A baked scatter with two object types, one of them a collection, and a painted density."""
    bpy.context.scene.frame_end = 2
    tuft, pebble = thing("Tuft", 0.1), thing("Pebble", 0.05)
    rocks = bpy.data.collections.new("Rocks")
    rocks.objects.link(pebble)
    surface = scenes.tail(frames=2)
    surface.vertex_groups.new(name="Grass").add(range(40), 1.0, "REPLACE")
    obj = scenes.scattered(surface, count=50)
    for name in ("Tufts", "Rocks"):
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].name = name
    obj.dapple.object_types[0].instance = tuft
    obj.dapple.object_types[1].collection = rocks
    obj.dapple.object_types[1].weight = 0.5
    obj.dapple.object_types[1].density = "Grass"
    obj.dapple.density.attribute = "Grass"
    obj.dapple.density.avoid_collection = bpy.data.collections.new("Avoided")
    obj.dapple.seed, obj.dapple.forward = 3, "Y"
    bpy.ops.dapple.optimize()
    bpy.ops.dapple.bake()
    return obj


@pytest.fixture
def saved(made, tmp_path):
    """A library with the asset; the settings that it was made of."""
    assert bpy.ops.dapple.mark_asset() == {"FINISHED"}
    path = tmp_path / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    kept = settings_of(made)
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    return path, kept


def settings_of(obj):
    return addon_host.part("blender.presets.stored").values_of(obj)


def asset_of(obj):
    return bpy.data.objects[f"{obj.name} Asset"]


def appended(path, name="Tail Scatter Asset"):
    before = set(bpy.data.objects)
    bpy.ops.wm.append(directory=f"{path}/Object/", filename=name, do_reuse_local_id=True)
    obj = next(one for one in bpy.context.scene.collection.objects if one not in before)
    bpy.context.view_layer.objects.active = obj
    return obj


def test_marking_leaves_the_scatter_as_it_is(made):
    before, points = scenes.positions(made), made.data
    assert bpy.ops.dapple.mark_asset() == {"FINISHED"}
    assert bpy.context.object == made
    assert made.data == points
    assert made.asset_data is None
    assert made.dapple.baked_keys == 2
    np.testing.assert_array_equal(scenes.positions(made), before)
    assert asset_of(made).name not in bpy.context.view_layer.objects


def test_an_asset_brings_no_surface_no_points_and_no_bake(made, tmp_path):
    bpy.ops.dapple.mark_asset()
    asset = asset_of(made)
    assert set(asset.asset_data.tags.keys()) == {"blue noise", "scatter"}
    assert "Pebble, Tuft" in asset.asset_data.description
    assert len(asset.data.vertices) == 0
    assert asset.dapple.baked_keys == asset.dapple.report.count == 0
    bpy.data.libraries.write(str(tmp_path / "alone.blend"), {asset}, fake_user=True)
    with bpy.data.libraries.load(str(tmp_path / "alone.blend")) as (found, _):
        assert set(found.objects) == {asset.name, "Tuft", "Pebble"}
        assert "Avoided" not in found.collections


def test_how_often_each_object_is_picked_comes_along(tmp_path):
    rocks = bpy.data.collections.new("Rocks")
    for name in ("Big", "Small"):
        rocks.objects.link(thing(name, 0.1))
    obj = scenes.scattered(scenes.sphere(), count=50)
    obj.dapple.collection, obj.dapple.use_weights = rocks, True
    obj.dapple.weights[0].weight = 0.0
    bpy.ops.dapple.mark_asset()
    listed = asset_of(obj).dapple.weights
    assert [(one.object.name, one.weight) for one in listed] == [("Big", 0.0), ("Small", 1.0)]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    placed = appended(tmp_path / "library.blend", "Sphere Scatter Asset")
    surface = scenes.sphere()
    bpy.context.view_layer.objects.active = placed
    bpy.ops.dapple.place_scatter(surface=surface.name)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = [one.object.name for one in depsgraph.object_instances if one.is_instance]
    assert shown == ["Small"] * 50


def test_appended_it_is_placed_on_another_surface_with_its_settings(saved):
    path, kept = saved
    sphere = scenes.sphere(location=(5.0, 0.0, 0.0))
    sphere.vertex_groups.new(name="Grass").add(range(100), 1.0, "REPLACE")
    obj = appended(path)
    obj.location = (1.0, 2.0, 3.0)
    assert bpy.ops.dapple.place_scatter(surface=sphere.name) == {"FINISHED"}
    assert obj.dapple.surface == sphere
    assert obj.asset_data is None
    assert settings_of(obj) == kept
    tufts, rocks = obj.dapple.object_types
    assert (tufts.instance.name, rocks.collection.name) == ("Tuft", "Rocks")
    assert (tufts.name, rocks.weight, rocks.density) == ("Tufts", 0.5, "Grass")
    assert tuple(obj.matrix_world.translation) == (0.0, 0.0, 0.0)
    places = scenes.positions(obj)
    assert len(places) == 50
    assert np.linalg.norm(places - [5.0, 0.0, 0.0], axis=1).max() < 1.01
    again = addon_host.part("blender.freshness.staleness").stale_reason
    assert again(obj, bpy.context) == ""


def test_what_the_surface_lacks_is_left_out_with_a_word(saved, capfd):
    sphere = scenes.sphere()
    obj = appended(saved[0])
    bpy.ops.dapple.place_scatter(surface=sphere.name)
    said = capfd.readouterr().out
    assert "skipped: Surface 'Sphere' has no attribute or vertex group 'Grass'" in said
    assert obj.dapple.density.attribute == obj.dapple.object_types[1].density == ""
    assert len(scenes.positions(obj)) == 50


def test_a_collection_does_not_lie_about(made, tmp_path):
    """Alone it was shown: Blender did not find the hidden collection around it."""
    made.dapple.object_type_index = 0
    bpy.ops.dapple.edit_object_types(action="REMOVE")
    bpy.ops.dapple.mark_asset()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    obj = appended(tmp_path / "library.blend")
    bpy.context.view_layer.update()
    assert [one for one in bpy.context.view_layer.objects if one.visible_get()] == [obj]


def test_what_is_instanced_does_not_lie_about(saved):
    obj = appended(saved[0])
    bpy.context.view_layer.update()
    assert [one for one in bpy.context.view_layer.objects if one.visible_get()] == [obj]
    assert [one.hide_render for one in bpy.context.scene.collection.children] == [True]


def test_the_same_asset_twice_has_points_of_its_own_each_time(saved):
    first_surface, second_surface = scenes.sphere(), scenes.sphere(location=(4.0, 0.0, 0.0))
    first = appended(saved[0])
    bpy.ops.dapple.place_scatter(surface=first_surface.name)
    before = scenes.positions(first)
    second = appended(saved[0])
    assert len(second.data.vertices) == 0
    bpy.ops.dapple.place_scatter(surface=second_surface.name)
    assert first.data != second.data
    np.testing.assert_array_equal(scenes.positions(first), before)
    assert scenes.positions(second)[:, 0].min() > 2.9


def test_without_a_surface_nothing_happens_and_a_message_says_so(saved):
    obj = appended(saved[0])
    with pytest.raises(RuntimeError, match="There is no surface at 'Tail Scatter Asset'"):
        bpy.ops.dapple.place_scatter()
    assert obj.dapple.surface is None
    shown = test_panels.drawn()
    assert "surface" in shown
    assert any(line.startswith("Choose a surface") for line in shown)
    assert "dapple.optimize" not in shown


def test_a_failure_leaves_the_scatter_waiting(saved):
    path, kept = saved
    obj, flat = appended(path), scenes.sphere()
    flat.data.clear_geometry()
    bpy.context.view_layer.objects.active = obj
    obj.location.x = 2.0
    with pytest.raises(RuntimeError):
        bpy.ops.dapple.place_scatter(surface=flat.name)
    assert obj.dapple.surface is None
    assert obj.location.x == 2.0
    assert settings_of(obj) == kept


def test_a_scatter_that_has_points_is_not_placed(made):
    with pytest.raises(RuntimeError, match="This scatter has points"):
        bpy.ops.dapple.place_scatter(surface=made.dapple.surface.name)


def test_dropped_on_a_surface_it_is_solved_there(live, saved):
    sphere, ground = scenes.sphere(location=(0.0, 0.0, 2.0)), scenes.sphere(scale=(9.0, 9.0, 0.1))
    obj = appended(saved[0])
    obj.location = (1.0, 0.0, 2.0)
    placed(live)
    assert obj.dapple.surface == sphere
    assert len(scenes.positions(obj)) == 50
    below = appended(saved[0])
    below.location = (3.0, 0.0, 2.0)
    placed(live)
    assert below.dapple.surface == ground


def placed(live):
    bpy.context.view_layer.update()
    placing = addon_host.part("blender.assets.dropped")
    assert placing.check() is None
    live.settle()


def test_dropped_beside_it_takes_the_object_that_was_active(live, saved):
    sphere, other = scenes.sphere(location=(0.0, 0.0, 5.0)), scenes.sphere(location=(9.0, 0.0, 5.0))
    bpy.context.view_layer.objects.active = sphere
    bpy.context.view_layer.update()
    obj = appended(saved[0])
    placed(live)
    assert obj.dapple.surface == sphere != other


def test_where_nothing_is_found_the_choice_solves(live, saved):
    obj = appended(saved[0])
    placed(live)
    assert obj.dapple.surface is None
    sphere = scenes.sphere(location=(0.0, 0.0, -3.0))
    placed(live)
    assert obj.dapple.surface is None, "it was asked for the surface already"
    obj.dapple.surface = sphere
    placed(live)
    assert len(scenes.positions(obj)) == 50
    assert "skipped" in addon_host.part("blender.assets.dropped").note(obj)


def test_an_opened_file_stays_as_it_is(live, saved, tmp_path):
    appended(saved[0])
    scenes.sphere()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "waits.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "waits.blend"))
    placed(live)
    assert bpy.data.objects["Tail Scatter Asset"].dapple.surface is None


def test_a_scatter_with_its_surface_is_appended_as_ever(live, made, tmp_path):
    name, count = made.name, len(scenes.positions(made))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    bpy.ops.wm.append(directory=f"{tmp_path}/scene.blend/Object/", filename=name)
    obj = bpy.data.objects[name]
    placed(live)
    assert obj.dapple.surface.name == "Tail"
    assert obj.dapple.baked_keys == 2
    assert len(scenes.positions(obj)) == count


def test_without_the_add_on_it_does_no_harm(saved, tmp_path):
    path = tmp_path / "used.blend"
    assert "instances 0 others 0" in child.bare(APPENDED, saved[0], path)
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects["Tail Scatter Asset"]
    sphere = scenes.sphere()
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.place_scatter(surface=sphere.name) == {"FINISHED"}
    assert len(scenes.positions(obj)) == 50


def test_marking_and_placing_are_undone(saved):
    bpy.context.preferences.edit.use_global_undo = True
    sphere = scenes.sphere()
    obj = appended(saved[0])
    bpy.ops.ed.undo_push(message="appended")
    bpy.ops.dapple.place_scatter(surface=sphere.name)
    bpy.ops.ed.undo_push(message="placed")
    bpy.ops.ed.undo()
    obj = bpy.data.objects["Tail Scatter Asset"]
    assert obj.dapple.surface is None
    assert len(obj.data.vertices) == 0
    bpy.ops.ed.redo()
    assert len(scenes.positions(bpy.data.objects["Tail Scatter Asset"])) == 50
