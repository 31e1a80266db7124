# SPDX-License-Identifier: GPL-3.0-or-later
"""Several objects as one surface: terrain in tiles, characters of several meshes, instances."""

from contextlib import contextmanager

import addon_host
import bpy
import following
import numpy as np
import pytest
import scenes
import test_panels
from joined_scenes import cloth, collection_of, over, reason, select, tiles
from test_undo import state


def test_selected_objects_are_one_surface():
    obj = over(*tiles(), count=300)
    surface = obj.dapple.surface
    assert (obj.name, surface.name) == ("Left Scatter", "Left Surface")
    found = scenes.positions(obj)
    assert len(found) == 300
    # The tiles are connected, and a cell may lie on two of them.
    np.testing.assert_allclose(np.histogram(found[:, 0], [-1, 1, 3, 5])[0], 100, atol=2)
    assert (scenes.rotations(obj)[:, 2, 2] > 0.99).all()
    assert obj.dapple.report.whole_count_variation == 0.0  # the tiles are connected


def arrays_of(surface):
    reading = addon_host.part("blender.surface.mesh")
    return reading.read_mesh(surface)


def over_collection(collection, **options):
    found = bpy.ops.dapple.add_over_collection(collection=collection.name, **options)
    assert found == {"FINISHED"}
    return bpy.context.object


def test_one_selected_object_is_its_own_surface():
    left, middle, _ = tiles()
    select(left)
    assert over(left).dapple.surface == left
    select(left, middle)
    bpy.context.view_layer.objects.active = scenes.sphere()
    bpy.context.object.select_set(False)
    bpy.ops.dapple.add_scatter(count=20)
    assert bpy.context.object.dapple.surface.name == "Sphere"


def test_the_same_objects_are_joined_once():
    made = tiles()
    first = over(*made, count=30)
    second = over(*reversed(made), count=30)
    assert second.dapple.surface == first.dapple.surface
    assert over(*made[:2], count=30).dapple.surface != first.dapple.surface


def test_an_armature_that_is_selected_too_does_not_matter():
    left, middle, _ = tiles()
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(rig)
    obj = over(rig, left, middle, count=20)
    assert obj.dapple.surface.name == "Left Surface"


def test_nothing_is_drawn_twice_and_it_goes_with_its_last_scatter(tmp_path):
    obj = over(*tiles(), count=20)
    surface = obj.dapple.surface
    assert not surface.users_collection
    drawn = [one.object.name for one in bpy.context.evaluated_depsgraph_get().object_instances]
    assert surface.name not in drawn
    bpy.ops.dapple.remove_scatter()
    path = str(tmp_path / "gone.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert sorted(one.name for one in bpy.data.objects) == ["Left", "Middle", "Right"]


def test_a_failing_add_leaves_nothing_behind():
    select(*tiles())
    before = scenes.snapshot()
    with pytest.raises(RuntimeError):
        bpy.ops.dapple.add_scatter(count=10**9)
    assert scenes.snapshot() == before
    collection_of(name="Empty")
    before = scenes.snapshot()
    for name in ("Empty", "None"):
        with pytest.raises(RuntimeError, match=name):
            bpy.ops.dapple.add_over_collection(collection=name)
    assert scenes.snapshot() == before


def test_one_undo_takes_all_of_it_back():
    select(*tiles())
    bpy.ops.ed.undo_push(message="Before")
    before = state()
    bpy.ops.dapple.add_scatter("EXEC_DEFAULT", True, count=20)
    bpy.ops.ed.undo()
    assert state() == before
    bpy.ops.ed.redo()
    assert len(scenes.positions(bpy.context.object)) == 20


def test_a_collection_is_one_surface_and_new_objects_of_it_are_asked_for():
    left, middle, right = tiles()
    terrain = collection_of(left, middle)
    obj = over_collection(terrain, count=60)
    assert obj.dapple.surface.name == "Terrain Surface"
    assert list(obj.users_collection) == [terrain]  # the object is not part of its own surface
    assert reason(obj) == ""
    before = scenes.positions(obj)
    terrain.objects.link(right)
    assert reason(obj) == "'Right' was added to 'Terrain Surface': optimize again"
    assert (scenes.positions(obj) == before).all()
    assert bpy.ops.dapple.reattach() == {"FINISHED"}
    assert reason(obj) == ""
    assert np.allclose(scenes.positions(obj), before, atol=1e-5)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == ""
    assert np.ptp(scenes.positions(obj)[:, 0]) > 5.0
    terrain.objects.unlink(left)
    assert "'Left' of 'Terrain Surface' was deleted or left" in reason(obj)
    bpy.data.objects.remove(middle)
    assert "A part of 'Terrain Surface' was deleted" in reason(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == ""
    assert scenes.positions(obj)[:, 0].min() > 3.0
    terrain.objects.unlink(right)
    with pytest.raises(RuntimeError, match="No part of surface 'Terrain Surface' is left"):
        bpy.ops.dapple.optimize()


def test_values_come_by_name_and_are_0_where_a_part_has_none():
    left, middle, right = tiles()
    for obj, weight in ((left, 0.5), (middle, 1.0)):
        group = obj.vertex_groups.new(name="Grass")
        group.add(range(len(obj.data.vertices)), weight, "REPLACE")
    left.vertex_groups.new(name="Nothing")
    color = right.data.color_attributes.new("Tint", "BYTE_COLOR", "CORNER")
    color.data.foreach_set("color", [1.0] * 4 * len(color.data))
    obj = over(left, middle, right, count=300)
    obj.dapple.density.attribute = "Grass"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    share = np.histogram(scenes.positions(obj)[:, 0], [-1, 1, 3, 5])[0]
    assert np.allclose(share, [100, 200, 0], atol=10)
    obj.dapple.density.blocked_areas = "Tint"
    obj.dapple.density.attribute = ""
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    share = np.histogram(scenes.positions(obj)[:, 0], [-1, 1, 3, 5])[0]
    assert np.allclose(share, [150, 150, 0], atol=12)
    obj.dapple.density.attribute = "Nothing"
    with pytest.raises(RuntimeError):
        bpy.ops.dapple.optimize()
    obj.dapple.density.attribute = "Else"
    with pytest.raises(RuntimeError, match="no attribute or vertex group 'Else'"):
        bpy.ops.dapple.optimize()


def subdivided(obj, levels, render_levels):
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = levels, render_levels


def test_parts_with_other_faces_in_renders_are_attached_at_rest():
    made = tiles()
    subdivided(made[1], 1, 2)
    obj = over(*made, count=90)
    assert obj.dapple.attached_to == "REST"
    assert all(one.add_rest_position_attribute for one in made)
    before = scenes.positions(obj)
    made[1].modifiers[0].levels = 2
    made[0].modifiers.new("Subdivision", "SUBSURF")
    bpy.context.view_layer.update()
    assert np.abs(scenes.positions(obj) - before).max() < 1e-3
    assert reason(obj) == ""
    made[0].add_rest_position_attribute = False
    assert reason(obj) == "Rest Position of 'Left' is off: optimize again"


def test_subdivision_of_the_parts_is_matched():
    made = tiles()
    subdivided(made[1], 1, 2)
    obj = over(*made, count=30)
    topology = addon_host.part("blender.surface.subdivision")
    assert topology.differences(obj.dapple.surface, bpy.context.scene) == [
        "'Middle': Subdivision: 1 and 2"
    ]
    obj.dapple.attach_to = "FACES"
    with pytest.raises(RuntimeError, match=r"Surface 'Middle' has .* in the viewport"):
        bpy.ops.dapple.optimize()
    assert bpy.ops.dapple.match_subdivision() == {"FINISHED"}
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.attached_to == "FACES"


@pytest.mark.parametrize("render_levels", [1, 2])
def test_a_character_of_several_meshes_plays_and_is_baked(render_levels):
    body = scenes.tail(render_levels=render_levels)
    obj = over(body, cloth(body), count=120)
    assert obj.dapple.attached_to == ("FACES" if render_levels == 1 else "REST")
    dapple = pytest.importorskip("dapple3d")
    for bake in (False, True):
        if bake:
            assert bpy.ops.dapple.bake() == {"FINISHED"}
        for frame in (1, 4, 6):
            bpy.context.scene.frame_set(frame)
            arrays, found = arrays_of(obj.dapple.surface), scenes.positions(obj)
            near = dapple.project(dapple.Surface(arrays.vertices, arrays.faces), found)
            assert len(found) == 120
            assert near.distances.max() < 1e-4
            assert scenes.node_warnings(obj) == []
    bpy.context.scene.frame_set(1)
    assert reason(obj) == ""


def test_parts_that_move_apart_are_motion():
    left, middle, _ = tiles()
    obj = over(left, middle, count=60)
    for frame, place in ((1, 2.0), (6, 5.0)):
        middle.location.x = place
        middle.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(6)
    found = scenes.positions(obj)[:, 0]
    assert ((found < 1.01) | (found > 3.99)).all()
    assert (found > 3.99).sum() == pytest.approx(30, abs=3)


def test_a_character_that_is_instanced_is_scattered_on_where_the_instance_is(tmp_path):
    left, middle, right = tiles()
    char = collection_of(left, middle, name="Creature")
    inner = collection_of(right, name="Inside")
    hold = bpy.data.objects.new("Hold", None)
    hold.instance_type, hold.instance_collection, hold.location.z = "COLLECTION", inner, 1.0
    char.objects.link(hold)
    char.instance_offset = (1.0, 0.0, 0.0)
    path = str(tmp_path / "creature.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.collections = ["Creature"]
    empty = bpy.data.objects.new("Creature", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.instance_type, empty.instance_collection = "COLLECTION", wanted.collections[0]
    empty.location, empty.rotation_euler.z = (0.0, 0.0, 5.0), np.pi / 2
    obj = over(empty, count=90)
    assert obj.name == "Creature Scatter"
    found = scenes.positions(obj)
    assert np.histogram(found[:, 1], [-2, 0, 2, 4])[0].tolist() == [30, 30, 30]
    assert np.allclose(found[:, 2], np.where(found[:, 1] > 2.0, 6.0, 5.0), atol=1e-5)
    empty.location.z = 7.0
    bpy.context.view_layer.update()
    assert np.allclose(scenes.positions(obj)[:, 2], found[:, 2] + 2.0, atol=1e-5)
    assert reason(obj) == ""
    bpy.context.scene.frame_end = 6
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    with pytest.raises(RuntimeError, match=r"linked from 'creature\.blend'"):
        bpy.ops.dapple.paint_density()


def weights(obj, name):
    group = obj.vertex_groups[name].index
    found = (one for vertex in obj.data.vertices for one in vertex.groups)
    return {one.weight for one in found if one.group == group}


def share(obj):
    return np.histogram(scenes.positions(obj)[:, 0], [-1, 1, 3, 5])[0].tolist()


def test_painting_begins_on_the_part_that_was_clicked_last():
    left, middle, right = tiles()
    obj = over(left, middle, right, count=90)
    obj.dapple.auto_update_mode = "ON"
    for part in (left, middle):
        select(part)
        bpy.context.view_layer.update()
    select(obj)
    bpy.context.view_layer.update()
    with following.driven() as live:
        assert bpy.ops.dapple.paint_density() == {"FINISHED"}
        live.settle()
        assert (bpy.context.object, bpy.context.mode) == (middle, "PAINT_WEIGHT")
        name = obj.dapple.density.attribute
        assert all(weights(part, name) == {0.5} for part in (left, middle, right))
        assert "dapple.finish_painting" in test_panels.drawn()
        middle.vertex_groups.active.add(range(len(middle.data.vertices)), 0.0, "REPLACE")
        middle.data.update()
        assert live.settle() == 1
        assert np.allclose(share(obj), [45, 0, 45], atol=3)
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.context.view_layer.objects.active = left
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")  # as Blender's Transfer Mode does
        assert left.vertex_groups.active.name == name
        assert "dapple.finish_painting" in test_panels.drawn()
        bpy.ops.dapple.finish_painting()
        assert bpy.context.object == obj


def test_a_part_gets_a_group_that_others_have_and_stays_as_it_was():
    left, middle, _ = tiles()
    left.vertex_groups.new(name="Grass").add([0, 1], 1.0, "REPLACE")
    obj = over(left, middle, count=30)
    obj.dapple.density.attribute = "Grass"
    assert bpy.ops.dapple.paint_density() == {"FINISHED"}
    assert weights(middle, "Grass") == set()
    bpy.ops.dapple.finish_painting()
    obj.dapple.density.attribute = "Else"
    with pytest.raises(RuntimeError, match="'Else', which is not a vertex group of"):
        bpy.ops.dapple.paint_density()


def test_points_follow_an_edited_and_a_moved_part():
    left, middle, right = tiles()
    terrain = collection_of(left, middle)
    obj = over_collection(terrain, count=60)
    obj.dapple.auto_update_mode = "ON"
    with following.driven() as live:
        live.settle()
        for vertex in left.data.vertices:
            vertex.co.x *= 3.0
        left.data.update()
        assert live.settle() == 1
        assert scenes.positions(obj)[:, 0].min() < -2.0
        left.scale.x = 1.0 / 3.0
        assert live.settle() == 1
        assert scenes.positions(obj)[:, 0].min() > -1.0
        terrain.objects.link(right)
        assert live.settle() == 1
        assert np.allclose(share(obj), [20, 20, 20], atol=3)
        terrain.objects.unlink(left)
        assert live.settle() == 1
        assert share(obj)[0] == 0
        assert live.settle() == 0
        assert reason(obj) == ""


def test_density_colors_and_tiles_are_of_all_parts():
    obj = over(*tiles(), count=60)
    overlay = addon_host.part("blender.density.overlay")
    bpy.ops.dapple.show_density()
    assert np.ptp(overlay.triangles()[0][:, 0]) == pytest.approx(6.0)
    bpy.ops.dapple.show_density()
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    assert np.ptp(scenes.world_vertices(obj.dapple.tiles.object)[:, 0]) > 5.9


def test_parts_do_not_block_their_own_points():
    left, middle, _ = tiles()
    obj = over(left, middle, count=30)
    obj.dapple.density.avoid_collection = collection_of(left, middle)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 30


def test_a_part_lists_the_scatters_and_optimize_works_while_they_are_hidden():
    left, middle, _ = tiles()
    obj = over(left, middle, count=30)
    scatters = addon_host.part("blender.surface.scatters")
    assert scatters.scatters_of(middle) == [obj]
    obj.hide_viewport = True
    left.location.z = 2.0
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    obj.hide_viewport = False
    assert scenes.positions(obj)[:, 2].max() == pytest.approx(2.0)
    assert not obj.dapple.surface.users_collection


def test_a_hidden_scatter_is_not_called_out_of_date():
    obj = over(*tiles(), count=30)
    obj.hide_viewport = True
    staleness = addon_host.part("blender.freshness.staleness")
    found = staleness.verdict(obj, bpy.context)
    assert (found.reason, bool(found.note)) == ("", True)
    obj.hide_viewport = False
    assert (reason(obj), staleness.verdict(obj, bpy.context).note) == ("", "")


@contextmanager
def local_view():
    """The 3D View of a window, where only what is selected is seen."""
    (window,) = bpy.context.window_manager.windows
    area = next(one for one in window.screen.areas if one.type == "VIEW_3D")
    region = next(one for one in area.regions if one.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        assert bpy.ops.view3d.localview() == {"FINISHED"}
        yield area.spaces.active
        assert bpy.ops.view3d.localview() == {"FINISHED"}


def test_what_is_added_in_local_view_is_seen_there():
    made = tiles()
    lone = scenes.sphere()
    select(*made)
    with local_view() as space:
        obj = over(*made, count=30)
        assert obj.visible_get(viewport=space)
        assert bpy.ops.dapple.optimize() == {"FINISHED"}
        assert bpy.ops.dapple.paint_density() == {"FINISHED"}
        bpy.ops.dapple.finish_painting()
        assert bpy.context.object == obj
        obj.dapple.surface = lone
        obj.dapple.density.attribute = ""
        select(obj)
        with pytest.raises(RuntimeError, match="Surface 'Sphere' is hidden: show it first"):
            bpy.ops.dapple.paint_density()


@pytest.fixture
def library(tmp_path):
    """A file with a collection 'Creature': body and cloth on a rig, and a scatter over both."""
    body = scenes.tail(frames=4)
    coat = cloth(body)
    obj = over(body, coat, count=60)
    collection_of(body, coat, bpy.data.objects["Rig"], obj, name="Creature")
    path = str(tmp_path / "creature.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.context.scene.frame_set(3)
    expected = scenes.positions(obj)
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    bpy.context.scene.frame_end = 4
    return path, expected


def brought(path, link):
    with bpy.data.libraries.load(path, link=link) as (_, wanted):
        wanted.collections = ["Creature"]
    bpy.context.scene.collection.children.link(wanted.collections[0])
    return wanted.collections[0]


@pytest.mark.parametrize("how", ["append", "link", "override"])
def test_a_scatter_over_several_objects_plays_in_another_file(library, how):
    path, expected = library
    found = brought(path, link=how != "append")
    if how == "override":
        scene, layer = bpy.context.scene, bpy.context.view_layer
        own = found.override_hierarchy_create(scene, layer, do_fully_editable=True)
        scene.collection.children.unlink(found)
        found = own
    obj = next(one for one in found.all_objects if one.dapple.surface)
    bpy.context.scene.frame_set(3)
    assert np.allclose(scenes.positions(obj), expected, atol=1e-5)
    shown = [one.name for one in bpy.context.view_layer.objects if one.visible_get()]
    assert not [name for name in shown if "Surface" in name]
    if how != "link":
        select(obj)
        obj.dapple.count = 30
        assert bpy.ops.dapple.optimize() == {"FINISHED"}
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert len(scenes.positions(obj)) == 30


def test_linked_parts_are_scattered_on_and_not_written_to(library):
    found = brought(library[0], link=True)
    body, coat = (found.all_objects[name] for name in ("Tail", "Cloth"))
    obj = over(body, coat, count=40)
    assert obj.library is None
    assert obj.dapple.surface.library is None
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    with pytest.raises(RuntimeError, match=r"'(Tail|Cloth)' is linked from"):
        bpy.ops.dapple.paint_density()
    obj.dapple.attach_to = "REST"
    with pytest.raises(RuntimeError, match="Rest Position of the surface is off, and"):
        bpy.ops.dapple.optimize()
    assert obj.dapple.attached_to == "FACES"


def test_the_surface_of_a_scatter_is_made_of_other_objects():
    left, middle, right = tiles()
    obj = over(left, middle, count=60)
    obj.dapple.auto_update_mode = "ON"
    select(obj)
    assert not bpy.ops.dapple.surface_from_selected.poll()
    assert "dapple.surface_from_selected" not in test_panels.drawn()
    select(obj, right, middle, left)
    assert "dapple.surface_from_selected" in test_panels.drawn()
    with following.driven() as live:
        assert bpy.ops.dapple.surface_from_selected() == {"FINISHED"}
        joined = addon_host.part("blender.surface.joined_parts")
        assert joined.parts_of(obj.dapple.surface) == [left, middle, right]
        assert "The points are on 'Left Surface'" in reason(obj)
        assert live.settle() == 1
        assert np.allclose(share(obj), [20, 20, 20], atol=3)
        assert reason(obj) == ""
    select(obj, right)
    assert bpy.ops.dapple.surface_from_selected() == {"FINISHED"}
    assert obj.dapple.surface == right
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert share(obj) == [0, 0, 60]
