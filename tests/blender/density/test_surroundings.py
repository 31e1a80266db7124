# SPDX-License-Identifier: GPL-3.0-or-later
"""Density from beside the surface: images, the camera, objects to avoid."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def plane(size=2.0):
    """One square of two triangles: whatever varies, varies within its faces."""
    bpy.ops.mesh.primitive_plane_add(size=size)
    return bpy.context.object


def picture(values, name="Mask"):
    """Image with these gray values (rows, columns), row 0 at the bottom."""
    values = np.asarray(values, dtype=np.float32)
    image = bpy.data.images.new(name, values.shape[1], values.shape[0], float_buffer=True)
    pixels = np.ones((*values.shape, 4), dtype=np.float32)
    pixels[:, :, :3] = values[:, :, None]
    image.pixels.foreach_set(pixels.ravel())
    return image


def optimized(obj, **density):
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return scenes.positions(obj)


def collection(name="Things"):
    made = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(made)
    return made


def obstacle(into, scale=0.3, location=(0, 0, 0), flat=False):
    add = bpy.ops.mesh.primitive_plane_add if flat else bpy.ops.mesh.primitive_cube_add
    add(size=2, location=location)
    obj = bpy.context.object
    obj.scale = (scale,) * 3
    for other in list(obj.users_collection):
        other.objects.unlink(obj)
    into.objects.link(obj)
    return obj


def activate(obj):
    bpy.context.view_layer.objects.active = obj


def test_an_image_is_followed_within_two_triangles():
    obj = scenes.scattered(plane(), count=400)
    values = np.zeros((64, 64))
    values[:, 32:] = 1.0
    found = optimized(obj, image=picture(values))
    assert len(found) == 400
    assert found[:, 0].min() > -0.05
    assert np.ptp(found[:, 1]) > 1.8
    assert obj.dapple.report.capacity_variation < 0.05


@pytest.mark.parametrize("times", [2, 6, 20])
def test_an_image_that_repeats_is_cut_no_finer_than_the_points_need(times):
    obj = scenes.scattered(plane(), count=400)
    values = np.random.default_rng(0).random((128, 128))
    uv = obj.dapple.surface.data.uv_layers[0]
    for corner in uv.data:
        corner.uv = times * corner.uv
    obj.dapple.density.image = picture(values)
    settings = addon_host.part("blender.scatter.object").settings_of(obj)
    arrays = addon_host.part("blender.surface.reading").read(obj.dapple.surface, settings)
    ground = addon_host.part("core.density.masked_surface").masked_surface_of(arrays, settings)
    assert len(ground.surface.faces) < 30 * 400 + 2 * len(arrays.faces)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.report.converged


def test_an_image_lies_on_a_mirrored_surface_as_it_is_painted():
    surface = plane()
    surface.scale = (-1, 1, 1)
    bpy.context.view_layer.update()
    values = np.zeros((64, 64))
    values[:, 32:] = 1.0
    found = optimized(scenes.scattered(surface, count=200), image=picture(values))
    assert found[:, 0].max() < 0.05


def test_a_uv_map_is_chosen():
    surface = plane()
    turned = surface.data.uv_layers.new(name="Turned")
    places = np.empty(2 * len(surface.data.loops), dtype=np.float32)
    surface.data.uv_layers[0].uv.foreach_get("vector", places)
    turned.uv.foreach_set("vector", 1.0 - places)
    values = np.zeros((64, 64))
    values[:, 32:] = 1.0
    obj = scenes.scattered(surface, count=200)
    found = optimized(obj, image=picture(values), uv_map="Turned")
    assert found[:, 0].max() < 0.05


def test_an_image_is_kept_while_a_bake_goes_on():
    """The tracker has finer faces than the file: what is stored is on those of the file."""
    surface = plane()
    values = np.zeros((64, 64))
    values[:, 32:] = 1.0
    surface.scale = (1, 1, 1)
    surface.keyframe_insert("scale", frame=1)
    surface.scale = (1, 1.5, 1)
    surface.keyframe_insert("scale", frame=6)
    obj = scenes.scattered(surface, count=150)
    optimized(obj, image=picture(values))
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 4, 6):
        bpy.context.scene.frame_set(frame)
        places = scenes.instance_matrices(obj)[:, :3, 3]
        assert places[:, 0].min() > -0.05
    assert np.ptp(places[:, 1]) > 2.6
    assert obj.dapple.report.capacity_variation < 0.06


def test_a_scaled_camera_sees_what_it_would_without_its_scale():
    """Renders and the viewport take no notice of it; of an orthographic one it would be seen."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    camera.location, camera.rotation_euler = (3, 0, 5), (0.1, 0.2, 0.3)
    camera.data.type, bpy.context.scene.camera = "ORTHO", camera
    found = []
    for scale in (1.0, 2.0):
        camera.scale = (scale, scale, scale)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        found.append(addon_host.part("blender.surface.surroundings").read_camera(depsgraph))
    assert np.allclose(*found, atol=1e-6)


def test_points_lie_where_the_camera_looks():
    surface = plane(20.0)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.collection.objects.link(camera)
    camera.location = (3, 0, 5)
    bpy.context.scene.camera = camera
    bpy.context.view_layer.update()
    activate(surface)
    obj = scenes.scattered(surface, count=300)
    found = optimized(obj, use_camera_view=True, camera_margin=0.0)
    half = 5 * math.tan(camera.data.angle_x / 2)
    render = bpy.context.scene.render
    low = half * render.resolution_y / render.resolution_x
    assert np.abs(found[:, 0] - 3).max() < 1.05 * half
    assert np.abs(found[:, 1]).max() < 1.05 * low
    assert np.ptp(found[:, 0]) > 1.8 * half
    wider = optimized(obj, camera_margin=0.5)
    assert np.ptp(wider[:, 0]) > 2.7 * half


def test_points_keep_off_closed_things_and_near_open_ones():
    surface = plane(4.0)
    things = collection()
    obstacle(things, 0.4, (1, 1, 0))
    obstacle(things, 0.4, (-1, -1, 0.02), flat=True)
    activate(surface)
    obj = scenes.scattered(surface, count=600)
    found = optimized(obj, avoid_collection=things, avoid_margin=0.1)
    away = np.abs(found[:, :2] - [1, 1]).max(axis=1)
    flat = np.abs(found[:, :2] + [1, 1]).max(axis=1)
    assert away.min() > 0.4 + 0.1 - 1e-6
    assert flat.min() > 0.4 + 0.09
    assert away.min() < 0.65  # points are no farther away than necessary
    assert obj.dapple.report.capacity_variation < 0.05


def test_points_keep_off_those_of_another_scatter():
    surface = plane(4.0)
    trees = scenes.scattered(surface, count=12)
    trees.dapple.object_types.add().radius = 0.3
    things = collection()
    things.objects.link(trees)
    activate(surface)
    grass = scenes.scattered(surface, count=500)
    found = optimized(grass, avoid_collection=things)
    apart = np.linalg.norm(found[:, None] - scenes.positions(trees)[None], axis=2)
    assert apart.min() >= 0.3 - 1e-5


def of_its_own(obj, things):
    """What a scatter makes and places, in a collection inside another."""
    inner = bpy.data.collections.new("Inner")
    things.children.link(inner)
    activate(obj)
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    tiles = obj.dapple.tiles.object
    twin = bpy.data.objects.new("Twin", tiles.data)
    obj.dapple.instance = obstacle(inner, 0.3)
    obj.dapple.object_types[0].instance = obstacle(inner, 0.3, (1, 1, 0))
    placed = bpy.data.collections.new("Placed")
    obstacle(placed, 0.3, (-1, 1, 0))
    inner.children.link(placed)
    obj.dapple.object_types[0].collection = placed
    for one in (obj, tiles, twin):
        inner.objects.link(one)
    activate(obj)


def test_a_scatter_does_not_flee_from_its_own_points_tiles_and_things():
    obj = scenes.scattered(plane(4.0), count=60)
    bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[0].radius = 0.1
    expected = optimized(obj)
    things = collection()
    of_its_own(obj, things)
    for _ in range(2):
        found = optimized(obj, avoid_collection=things)
        np.testing.assert_array_equal(found, expected)


def test_a_bake_does_not_flee_from_its_own_points():
    obj = scenes.scattered(plane(4.0), count=60)
    obj.dapple.object_types.add().radius = 0.1
    optimized(obj)
    bpy.context.scene.frame_end = 2
    found = []
    for obstacles in (None, collection()):
        if obstacles:
            obstacles.objects.link(obj)
        obj.dapple.density.avoid_collection = obstacles
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        found.append(scenes.positions(obj))
    np.testing.assert_array_equal(*found)


def test_a_copy_of_a_scatter_keeps_off_the_first_but_not_off_the_tiles_that_both_have():
    first = scenes.scattered(plane(4.0), count=20)
    first.dapple.object_types.add().radius = 0.1
    optimized(first)
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    things = collection()
    for one in (first, first.dapple.tiles.object):
        things.objects.link(one)
    expected = scenes.positions(first)
    assert bpy.ops.object.duplicate() == {"FINISHED"}
    second = bpy.context.object
    assert second.dapple.tiles.object == first.dapple.tiles.object
    found = optimized(second, avoid_collection=things)
    apart = np.linalg.norm(found[:, None] - expected[None], axis=2)
    assert apart.min() >= 0.1 - 1e-5
    things.objects.unlink(first.dapple.tiles.object)
    np.testing.assert_array_equal(optimized(second), found)


def test_a_range_of_heights_is_met_within_faces():
    surface = plane(4.0)
    surface.rotation_euler = (0, math.radians(60), 0)
    bpy.context.view_layer.update()
    obj = scenes.scattered(surface, count=200)
    found = optimized(obj, use_height=True, height_min=0.0, height_max=0.5, height_falloff=0.0)
    assert found[:, 2].min() > -0.1
    assert found[:, 2].max() < 0.6


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("black", "black everywhere"),
        ("negative", r"Mask.*-1 at pixel \(2, 1\)"),
        ("missing", "has no pixels"),
        ("uv", "no UV map"),
        ("camera", "has no camera"),
        ("unseen", "density is 0"),
        ("covered", "density is 0"),
    ],
)
def test_what_cannot_be_a_density_is_reported_and_nothing_is_lost(given, said):
    surface = plane()
    obj = scenes.scattered(surface, count=50)
    before, density = scenes.positions(obj), obj.dapple.density
    if given in ("black", "negative", "uv"):
        values = np.zeros((4, 4))
        values[1, 2] = {"black": 0.0, "negative": -1.0, "uv": 1.0}[given]
        density.image = picture(values)
    if given == "missing":
        density.image = bpy.data.images.new("Gone", 4, 4)
        density.image.source, density.image.filepath = "FILE", "//gone.png"
    if given == "uv":
        surface.data.uv_layers.remove(surface.data.uv_layers[0])
        surface.data.update()
    if given in ("camera", "unseen"):
        density.use_camera_view = True
    if given == "unseen":
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        bpy.context.collection.objects.link(camera)
        camera.location = (0, 0, -5)
        bpy.context.scene.camera = camera
        bpy.context.view_layer.update()
    if given == "covered":
        density.avoid_collection = collection()
        obstacle(density.avoid_collection, 5.0)
    activate(obj)
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.dapple.optimize()
    np.testing.assert_array_equal(scenes.positions(obj), before)


def test_a_result_of_before_these_settings_is_not_stale():
    """Files written before know nothing of them."""
    stale, settings = (
        addon_host.part("core.solve.stale"),
        addon_host.part("core.settings.values").Settings(),
    )
    old = stale.settings_text(settings).replace('"use_camera_view": false, ', "")
    assert "use_camera_view" not in old
    assert stale.changed_settings(old, settings) == []
