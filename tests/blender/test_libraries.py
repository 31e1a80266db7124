# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters of other files: appended, linked, overridden; surfaces of other files."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes

NAMES = ("Rig", "Tail", "Tail Scatter")
WRITING = (
    "optimize",
    "bake",
    "reattach",
    "make_tiles",
    "clear_bake",
    "live_preview",
    "edit_object_types",
    "lock_points",
    "load_preset",
)


@pytest.fixture
def library(tmp_path):
    """A file with a collection 'Creature': a rig, its skin, a baked scatter; and the animation."""
    surface = scenes.tail(frames=4)
    obj = scenes.scattered(surface)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    creature = bpy.data.collections.new("Creature")
    for name in NAMES:
        creature.objects.link(bpy.data.objects[name])
        bpy.context.scene.collection.objects.unlink(bpy.data.objects[name])
    bpy.context.scene.collection.children.link(creature)
    expected = played(obj)
    path = str(tmp_path / "creature.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    new_file()
    return path, expected


def new_file():
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 4


def brought(path, link, name="Creature"):
    """Collection of another file, in the scene."""
    with bpy.data.libraries.load(path, link=link) as (_, wanted):
        wanted.collections = [name]
    (collection,) = wanted.collections
    bpy.context.scene.collection.children.link(collection)
    return collection


def overridden(path):
    """Editable overrides of the linked creature; its scatter."""
    linked = brought(path, link=True)
    scene, layer = bpy.context.scene, bpy.context.view_layer
    own = linked.override_hierarchy_create(scene, layer, do_fully_editable=True)
    scene.collection.children.unlink(linked)
    obj = active(own.all_objects["Tail Scatter"])
    assert obj.library is None
    return obj


def active(obj):
    bpy.context.view_layer.objects.active = obj
    return obj


def played(obj):
    """World positions over the whole range."""
    found = []
    for frame in range(1, 5):
        bpy.context.scene.frame_set(frame)
        found.append(scenes.positions(obj))
    return np.array(found)


def reopened(tmp_path):
    path = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)


def own_scatter():
    (obj,) = (one for one in bpy.context.scene.objects if one.dapple.surface)
    return active(obj)


def test_appended_twice_each_plays_and_is_solved_by_itself(library):
    path, expected = library
    first, second = (
        brought(path, link=False).all_objects[name] for name in ("Tail Scatter", "Tail Scatter.001")
    )
    assert (played(first) == expected).all()
    assert (played(second) == expected).all()
    active(second)
    second.dapple.count = 20
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert played(second).shape[1] == 20
    assert (played(first) == expected).all()


def test_a_scatter_beside_appended_ones_takes_their_node_group(library):
    brought(library[0], link=False)
    groups = set(bpy.data.node_groups)
    obj = scenes.scattered(scenes.sphere())
    assert set(bpy.data.node_groups) == groups
    assert len(scenes.positions(obj)) == 60


def test_a_linked_scatter_plays_and_is_not_written_to(library):
    path, expected = library
    linked = active(brought(path, link=True).all_objects["Tail Scatter"])
    assert (played(linked) == expected).all()
    before = scenes.snapshot()
    for name in WRITING:
        operator = getattr(bpy.ops.dapple, name)
        assert not operator.poll()
        with pytest.raises(RuntimeError, match=r"'Tail Scatter' is linked from 'creature\.blend'"):
            operator()
    assert scenes.snapshot() == before
    assert (played(linked) == expected).all()


@pytest.mark.parametrize("kind", ["SELECT_OBJECT", "SELECT_OBDATA", "ALL"])
def test_a_linked_scatter_that_is_made_local_is_solved(library, tmp_path, kind):
    path, expected = library
    linked = brought(path, link=True)
    active(linked.all_objects["Tail Scatter"]).select_set(True)
    assert bpy.ops.object.make_local(type=kind) == {"FINISHED"}
    obj = next(one for one in bpy.data.objects if one.dapple.surface and not one.library)
    if obj not in bpy.context.view_layer.objects.values():
        bpy.context.scene.collection.objects.link(obj)
    active(obj)
    assert (played(obj) == expected).all()
    obj.dapple.count = 30
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    expected = played(obj)
    assert expected.shape[1] == 30
    reopened(tmp_path)
    obj = next(one for one in bpy.data.objects if one.dapple.surface and not one.library)
    assert (played(obj) == expected).all()


def test_two_scatters_joined_are_re_bound():
    surface = scenes.sphere()
    first, second = scenes.scattered(surface), scenes.scattered(surface, 20)
    first.select_set(True)
    assert bpy.ops.object.join() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="point 20 was copied by hand"):
        bpy.ops.dapple.make_tiles()
    for action in (bpy.ops.dapple.reattach, bpy.ops.dapple.make_tiles, bpy.ops.dapple.bake):
        assert action() == {"FINISHED"}
        assert len(scenes.positions(second)) == 80


def test_an_override_that_is_not_editable_is_not_written_to(library):
    obj = overridden(library[0])
    obj.override_library.is_system_override = True
    for name in WRITING:
        with pytest.raises(RuntimeError, match="override that is not editable"):
            getattr(bpy.ops.dapple, name)()


def test_an_override_plays_what_was_baked_in_its_file(library, tmp_path):
    path, expected = library
    overridden(path)
    reopened(tmp_path)
    obj = own_scatter()
    assert obj.override_library
    assert (played(obj) == expected).all()
    assert scenes.node_warnings(obj) == []


def test_an_override_is_baked_in_the_shot_and_keeps_it(library, tmp_path):
    path, before = library
    obj = overridden(path)
    rig = next(one for one in bpy.context.scene.objects if one.type == "ARMATURE")
    assert rig.library is None
    rig.scale = (1.0, 1.0, 1.4)
    obj.dapple.count, obj.dapple.repulsion_weight, obj.dapple.density.curvature = 80, 2.5, 0.25
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    expected = played(obj)
    assert expected.shape[1] == 80
    reopened(tmp_path)
    obj = own_scatter()
    assert obj.override_library
    assert (played(obj) == expected).all()
    assert (obj.dapple.count, obj.dapple.repulsion_weight) == (80, 2.5)
    assert obj.dapple.density.curvature == 0.25
    assert (obj.dapple.baked_frames, obj.dapple.report.count) == (4, 80)
    staleness = addon_host.part("blender.freshness.staleness")
    assert staleness.stale_reason(obj, bpy.context) == ""
    bpy.ops.wm.open_mainfile(filepath=path)
    assert (played(own_scatter()) == before).all()  # the scatter in its own file is unchanged


def test_an_override_is_cleared_and_tiled_in_the_shot(library, tmp_path):
    obj = overridden(library[0])
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    expected, tiles = played(obj), len(obj.dapple.tiles.object.data.polygons)
    reopened(tmp_path)
    obj = own_scatter()
    assert obj.dapple.baked_keys == 0
    assert (played(obj) == expected).all()
    assert len(obj.dapple.tiles.object.data.polygons) == tiles
    assert obj.dapple.tiles.object.name in bpy.context.view_layer.objects


def test_the_classes_of_an_override_are_those_of_its_file(library):
    overridden(library[0])
    with pytest.raises(RuntimeError, match="object types come from a linked file: edit them there"):
        bpy.ops.dapple.edit_object_types(action="ADD")


def test_a_scatter_over_a_linked_surface_is_of_this_file(library, tmp_path):
    linked = brought(library[0], link=True)
    active(linked.all_objects["Tail"])
    assert bpy.ops.dapple.add_scatter(count=25) == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    expected = played(bpy.context.object)
    assert list(bpy.context.object.users_collection) == [bpy.context.scene.collection]
    reopened(tmp_path)
    obj = next(one for one in bpy.context.scene.collection.objects if one.dapple.surface)
    assert (played(obj) == expected).all()


def test_a_scatter_over_an_overridden_surface_lies_in_an_open_collection(library, tmp_path):
    active(overridden(library[0]).dapple.surface)
    assert bpy.ops.dapple.add_scatter(count=25) == {"FINISHED"}
    assert list(bpy.context.object.users_collection) == [bpy.context.scene.collection]
    reopened(tmp_path)
    obj = next(one for one in bpy.context.scene.collection.objects if one.dapple.surface)
    assert len(scenes.positions(obj)) == 25


def test_rest_position_of_an_overridden_surface_stays_on(library, tmp_path):
    active(overridden(library[0]).dapple.surface)
    assert bpy.ops.dapple.add_scatter(count=25, attach_to="REST") == {"FINISHED"}
    expected = played(bpy.context.object)
    reopened(tmp_path)
    obj = next(one for one in bpy.context.scene.collection.objects if one.dapple.surface)
    assert np.allclose(played(obj), expected, atol=1e-5)


def test_rest_position_of_a_linked_surface_cannot_be_turned_on(library):
    linked = brought(library[0], link=True)
    active(linked.all_objects["Tail"])
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match="Rest Position of the surface is off, and 'Tail' is"):
        bpy.ops.dapple.add_scatter(attach_to="REST")
    assert scenes.snapshot() == before


def test_levels_of_a_linked_surface_are_not_matched(library):
    surface = active(brought(library[0], link=True).all_objects["Tail"])
    surface.modifiers["Subdivision"].levels = 0  # another file may have changed it
    with pytest.raises(RuntimeError, match="'Tail' is linked from"):
        bpy.ops.dapple.match_subdivision()


def half_black(rows):
    """Image 'Paint' on a plane, white where a row is 1."""
    image = bpy.data.images.new("Paint", 2, 2)
    image.pixels = [value for row in rows for value in (row, row, row, 1.0) * 2]
    image.pack()
    return image


def test_images_and_collections_of_the_same_name_in_two_files_are_reported_apart(tmp_path):
    path = str(tmp_path / "paint.blend")
    half_black((1.0, 0.0)).use_fake_user = True
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(-1.0, 0.0, 0.0))
    rocks = bpy.data.collections.new("Rocks")
    rocks.objects.link(bpy.context.object)
    rocks.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=path)
    new_file()
    half_black((0.0, 1.0))
    bpy.context.scene.collection.children.link(bpy.data.collections.new("Rocks"))
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.images, wanted.collections = ["Paint"], ["Rocks"]
    bpy.context.scene.collection.children.link(wanted.collections[0])
    bpy.ops.mesh.primitive_plane_add(size=4.0)
    obj = scenes.scattered(bpy.context.object)
    obj.dapple.density.image = wanted.images[0]
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert scenes.positions(obj)[:, 1].mean() < -0.5
    obj.dapple.density.image, obj.dapple.density.avoid_collection = None, wanted.collections[0]
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    found = scenes.positions(obj)
    assert not ((found[:, 0] < -0.1) & (np.abs(found[:, 1]) < 0.9)).any()
