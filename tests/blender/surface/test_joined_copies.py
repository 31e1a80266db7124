# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of joined surfaces and of their scatters."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from joined_scenes import cloth, collection_of, over, reason, select, tiles


def dressed_scatter(**options):
    """A scatter on a body on a rig and on its clothes."""
    body = scenes.tail()
    parts = body, cloth(body)
    for part in parts:
        part.parent = next(one for one in bpy.data.objects if one.type == "ARMATURE")
    bpy.context.view_layer.update()
    return over(*parts, **options)


def everything_copied(linked=False, but=()):
    """All objects of the scene duplicated, by the operator that Shift D and Alt D call."""
    before = set(bpy.context.scene.objects)
    for obj in before:
        obj.select_set(obj not in but)
    assert bpy.ops.object.duplicate(linked=linked) == {"FINISHED"}
    bpy.context.view_layer.update()
    return sorted(set(bpy.context.scene.objects) - before, key=lambda obj: obj.name)


def scatters_of(objects):
    return [obj for obj in objects if addon_host.part("blender.scatter.object").is_scatter(obj)]


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize("baked", [False, True])
def test_a_copied_character_has_its_scatter_on_the_copy(linked, baked):
    obj = dressed_scatter(count=80)
    if baked:
        assert bpy.ops.dapple.bake() == {"FINISHED"}
    found = scenes.positions(obj)
    made = everything_copied(linked)
    (copy,) = scatters_of(made)
    assert reason(copy) == reason(obj) == ""
    rigs = [one for one in made if one.type == "ARMATURE"]
    rigs[0].location.x += 3.0
    bpy.context.view_layer.update()
    assert np.allclose(scenes.positions(copy), found + np.array([3.0, 0.0, 0.0]), atol=1e-5)
    assert np.allclose(scenes.positions(obj), found, atol=1e-5)
    assert copy.dapple.surface != obj.dapple.surface
    bpy.context.view_layer.objects.active = copy
    assert bpy.ops.dapple.optimize(delete_keyframes=True) == {"FINISHED"}
    assert scenes.positions(copy)[:, 0].mean() == pytest.approx(found[:, 0].mean() + 3.0, abs=0.1)


def test_tiles_that_are_copied_too_follow_the_copy():
    left, middle, _ = tiles()
    obj = over(left, middle, count=30)
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    made = everything_copied(but={bpy.data.objects["Right"]})
    (copy,) = scatters_of(made)
    assert copy.dapple.tiles.object not in {None, obj.dapple.tiles.object}
    for one in made:
        if one.name.startswith(("Left.", "Middle.")) and one.type == "MESH" and one in made:
            one.location.z += 0.0 if one in scatters_of(made) else 4.0
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    heights = [
        [
            (tile.matrix_world @ vertex.co).z
            for vertex in tile.evaluated_get(depsgraph).data.vertices
        ]
        for tile in (obj.dapple.tiles.object, copy.dapple.tiles.object)
    ]
    assert np.mean(heights[1]) == pytest.approx(np.mean(heights[0]) + 4.0, abs=1e-4)


def test_scatters_that_are_copied_together_are_on_one_surface(tmp_path):
    left, middle, _ = tiles()
    one = over(left, middle, count=30)
    other = over(left, middle, count=40)
    assert one.dapple.surface == other.dapple.surface
    made = scatters_of(everything_copied())
    assert len({copy.dapple.surface for copy in made}) == 1
    assert made[0].dapple.surface != one.dapple.surface
    again = scatters_of(everything_copied())
    assert len({copy.dapple.surface for copy in again}) == 2
    path = str(tmp_path / "copies.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    surfaces = [obj.dapple.surface.name for obj in scatters_of(bpy.data.objects)]
    assert sorted(map(surfaces.count, set(surfaces))) == [2, 2, 2, 2]


def test_a_copy_of_the_scatter_alone_stays_where_it_is():
    left, middle, _ = tiles()
    obj = over(left, middle, count=30)
    (copy,) = everything_copied(but={one for one in bpy.data.objects if one != obj})
    assert copy.dapple.surface == obj.dapple.surface
    assert np.allclose(scenes.positions(copy), scenes.positions(obj))


def test_a_copy_with_some_of_the_parts_follows_those():
    left, middle, right = tiles()
    obj = over(left, middle, count=60)
    found = scenes.positions(obj)
    made = everything_copied(but={left, right})
    (copy,) = scatters_of(made)
    (part,) = set(made) - {copy}
    part.location.z = 5.0
    bpy.context.view_layer.update()
    moved = scenes.positions(copy)[:, 2] > 4.0
    assert (moved == (found[:, 0] > 1.0)).all()
    assert (scenes.positions(obj)[:, 2] < 1.0).all()


def test_a_copied_instance_of_a_character_has_its_scatter_on_the_copy():
    left, middle, _ = tiles()
    char = collection_of(left, middle, name="Creature")
    empty = bpy.data.objects.new("Creature", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.instance_type, empty.instance_collection = "COLLECTION", char
    empty.location.z = 5.0
    bpy.context.view_layer.update()
    obj = over(empty, count=60)
    found = scenes.positions(obj)
    made = everything_copied(but={left, middle, bpy.data.objects["Right"]})
    (copy,) = scatters_of(made)
    (other,) = set(made) - {copy}
    other.location.z = 8.0
    bpy.context.view_layer.update()
    assert np.allclose(scenes.positions(copy), found + np.array([0.0, 0.0, 3.0]), atol=1e-5)


def test_parts_that_are_exchanged_are_no_copies():
    left, middle, right = tiles()
    obj = over(left, middle, count=60)
    surface = obj.dapple.surface
    select(obj, left, right)
    assert bpy.ops.dapple.surface_from_selected() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.surface != surface
    assert set(addon_host.part("blender.surface.joined_parts").parts_of(obj.dapple.surface)) == {
        left,
        right,
    }
