# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles of a scatter: an object with attributes, on the surface of the frame."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes
from mathutils.bvhtree import BVHTree


def tiled(obj, **settings):
    for name, value in settings.items():
        setattr(obj.dapple.tiles, name, value)
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    return obj.dapple.tiles.object


def column(mesh, name, kind):
    values = np.empty(len(mesh.polygons), dtype=kind)
    mesh.attributes[name].data.foreach_get("value", values)
    return values


def area(made):
    bpy.context.view_layer.update()
    mesh = made.data.copy()
    mesh.transform(made.matrix_world)
    return sum(polygon.area for polygon in mesh.polygons)


def test_tiles_cover_the_surface_without_grout():
    surface = scenes.sphere()
    obj = scenes.scattered(surface, count=60)
    made = tiled(obj, grout=0.0, thickness=0.0)
    assert area(made) == pytest.approx(area(surface), rel=1e-3)
    assert set(column(made.data, "cell", np.int32)) == set(range(60))
    assert not made.data.validate()
    assert made.data.edges


def test_grout_and_inset_take_area_and_thickness_makes_bodies():
    obj = scenes.scattered(scenes.sphere(), count=60)
    whole = area(tiled(obj, grout=0.0, thickness=0.0))
    grout = area(tiled(obj, grout=0.1))
    assert 0.75 < grout / whole < 0.87
    assert area(tiled(obj, random_inset=0.2)) < 0.9 * grout
    made = tiled(obj, random_inset=0.0, thickness=0.2)
    faces_of = np.bincount([key for p in made.data.polygons for key in edge_indices(made, p)])
    assert set(faces_of) == {2}, "closed bodies"


def edge_indices(made, polygon):
    return [made.data.loops[k].edge_index for k in polygon.loop_indices]


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 2.0, 0.5)])
def test_tiles_lie_on_a_transformed_surface_and_move_with_it(scale):
    surface = scenes.sphere(scale=scale, location=(3.0, -2.0, 1.0), rotation=(0.3, 0.2, 0.1))
    made = tiled(scenes.scattered(surface, count=40), thickness=0.0, grout=0.0)
    assert area(made) == pytest.approx(area(surface), rel=1e-3)
    before = np.array([made.matrix_world @ v.co for v in made.data.vertices])
    local = np.array([surface.matrix_world.inverted() @ v for v in map(vector, before)])
    assert np.abs(np.linalg.norm(local, axis=1) - 1.0).max() < 0.03
    surface.location.x += 1.0
    bpy.context.view_layer.update()
    after = np.array([made.matrix_world @ v.co for v in made.data.vertices])
    assert np.allclose(after - before, (1.0, 0.0, 0.0), atol=1e-5)


def vector(row):
    from mathutils import Vector

    return Vector(row)


def test_tiles_of_one_class_have_one_hue_and_all_carry_their_class():
    obj = scenes.scattered(scenes.sphere(), count=60)
    for _ in range(2):
        bpy.ops.dapple.edit_object_types(action="ADD")
    bpy.ops.dapple.optimize()
    made = tiled(obj, color_by="CLASS")
    kinds = column(made.data, "dapple_object_type", np.int32)
    assert set(kinds) == {0, 1}
    colors = np.array([one.color[:3] for one in made.data.color_attributes["Color"].data])
    for kind in (0, 1):
        corners = [
            made.data.loops[k].vertex_index
            for p in np.flatnonzero(kinds == kind)
            for k in made.data.polygons[p].loop_indices
        ]
        order = {tuple(np.argsort(row)) for row in colors[corners].round(5)}
        assert len(order) == 1
    assert made.data.materials[0].name == "Dapple Tiles"


def test_tiles_are_replaced_and_what_was_added_to_them_stays():
    obj = scenes.scattered(scenes.sphere(), count=60)
    made = tiled(obj)
    made.modifiers.new("Bevel", "BEVEL")
    material = bpy.data.materials.new("Stone")
    made.data.materials[0] = material
    obj.dapple.count = 30
    bpy.ops.dapple.optimize()
    objects = len(bpy.data.objects)
    assert tiled(obj) == made
    assert len(bpy.data.objects) == objects
    assert len(set(column(made.data, "cell", np.int32))) == 30
    assert [one.name for one in made.modifiers] == ["Dapple Tiles", "Bevel"]
    assert made.data.materials[0] == material


def shown(made):
    """Vertices of the tiles as they are played, in the world."""
    mesh = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    places = np.array([v.co for v in mesh.vertices])
    matrix = np.array(made.matrix_world)
    return places @ matrix[:3, :3].T + matrix[:3, 3]


def farthest_off(surface, places):
    """Largest distance of places from the surface as it is now."""
    tree = BVHTree.FromObject(surface, bpy.context.evaluated_depsgraph_get())
    back = surface.matrix_world.inverted()
    return max(tree.find_nearest(back @ vector(place))[3] for place in places)


@pytest.mark.parametrize("render_levels", [1, 2])
def test_tiles_deform_with_the_body(render_levels):
    surface = scenes.tail(render_levels=render_levels)
    obj = scenes.scattered(surface, count=40)
    assert obj.dapple.attached_to == ("FACES" if render_levels == 1 else "REST")
    made = tiled(obj, thickness=0.0, grout=0.1)
    first = shown(made)
    assert np.allclose(first, stored(made), atol=1e-5)
    for frame in (3, 6):
        bpy.context.scene.frame_set(frame)
        assert np.abs(shown(made) - first).max() > 0.1
        assert farthest_off(surface, shown(made)) < 0.02
    assert np.allclose(stored(made), first, atol=1e-5), "the mesh itself stays"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(5)
    assert farthest_off(surface, shown(made)) < 0.02


def stored(made):
    matrix = np.array(made.matrix_world)
    return np.array([v.co for v in made.data.vertices]) @ matrix[:3, :3].T + matrix[:3, 3]


def test_thick_tiles_keep_their_thickness_on_a_body_that_bends():
    surface = scenes.tail()
    made = tiled(scenes.scattered(surface, count=40), thickness=0.2, grout=0.1)
    depths = []
    for frame in (1, 6):
        bpy.context.scene.frame_set(frame)
        depths.append(farthest_off(surface, shown(made)))
    assert depths[1] == pytest.approx(depths[0], rel=0.1)


def test_a_mosaic_without_grout_stays_closed_on_a_body_that_bends():
    surface = scenes.tail()
    made = tiled(scenes.scattered(surface, count=40), thickness=0.0, grout=0.0)
    places = np.array([v.co for v in made.data.vertices])
    _, same = np.unique(places.round(6), axis=0, return_inverse=True)
    for frame in (3, 6):
        bpy.context.scene.frame_set(frame)
        found = shown(made)
        for group in range(same.max() + 1):
            assert np.ptp(found[same.ravel() == group], axis=0).max() < 1e-5


def test_tiles_of_several_objects_deform_with_them():
    body = scenes.tail()
    bpy.ops.mesh.primitive_grid_add(location=(3.0, 0.0, 0.0))
    other = bpy.context.object
    for part in (body, other):
        part.select_set(True)
    bpy.ops.dapple.add_scatter(count=60)
    obj = bpy.context.object
    made = tiled(obj, thickness=0.0)
    first = shown(made)
    other.location.z = 2.0
    bpy.context.scene.frame_set(6)
    moved = shown(made) - first
    assert np.isclose(moved[first[:, 0] > 1.9], (0.0, 0.0, 2.0), atol=1e-5).all()
    assert np.abs(moved[first[:, 0] < 1.9]).max() > 0.1


def test_tiles_stay_where_the_surface_has_other_faces():
    surface = scenes.sphere()
    made = tiled(scenes.scattered(surface, count=40), thickness=0.0)
    surface.modifiers.new("Subdivision", "SUBSURF")
    assert np.allclose(shown(made), stored(made), atol=1e-6)


def test_tiles_follow_the_frame():
    surface = scenes.tail()
    obj = scenes.scattered(surface, count=30)
    extents = []
    for frame in (1, 6):
        bpy.context.scene.frame_set(frame)
        made = tiled(obj, thickness=0.0, grout=0.0)
        there = np.array([made.matrix_world @ v.co for v in made.data.vertices])
        extents.append(np.array([there.min(axis=0), there.max(axis=0)]))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        shape = np.array([v.co for v in surface.evaluated_get(depsgraph).to_mesh().vertices])
        assert np.allclose(extents[-1], [shape.min(axis=0), shape.max(axis=0)], atol=1e-3)
    assert not np.allclose(*extents, atol=0.5)


def test_a_grout_that_takes_some_tiles_is_reported():
    obj = scenes.scattered(scenes.sphere(), count=60)
    made = tiled(obj, grout=0.85, random_inset=0.1)
    assert 0 < len(set(column(made.data, "cell", np.int32))) < 60


def test_a_grout_that_leaves_nothing_is_refused_and_the_tiles_stay():
    obj = scenes.scattered(scenes.sphere(), count=60)
    made = tiled(obj)
    polygons = len(made.data.polygons)
    obj.dapple.tiles.grout, obj.dapple.tiles.random_inset = 1.0, 0.5
    with pytest.raises(RuntimeError, match="Sphere': all 60 tiles are empty: the grout and the"):
        bpy.ops.dapple.make_tiles()
    assert len(made.data.polygons) == polygons


def test_tiles_without_grout_are_closed_once_merged_by_distance():
    obj = scenes.scattered(scenes.sphere(), count=200)
    made = tiled(obj, grout=0.0, thickness=0.0)
    mesh = bmesh.new()
    mesh.from_mesh(made.data)
    bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=1e-7)
    assert all(len(edge.link_faces) == 2 for edge in mesh.edges)
    mesh.free()


def test_a_surface_that_lost_its_faces_is_refused_and_the_tiles_stay():
    surface = scenes.sphere()
    obj = scenes.scattered(surface, count=60)
    made = tiled(obj)
    polygons = len(made.data.polygons)
    surface.data.clear_geometry()
    with pytest.raises(RuntimeError, match="Sphere"):
        bpy.ops.dapple.make_tiles()
    assert len(made.data.polygons) == polygons
