# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks in Blender: targets of a distance, following changes, messages."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import linked, note, reason, solved
from dapple3d.density import noise
from following import driven
from test_panels import drawn
from test_surroundings import activate, collection, obstacle, optimized, picture, plane


@pytest.fixture
def live():
    with driven() as driver:
        yield driver


def path(points=((-0.9, -0.5, 0.0), (0.9, 0.5, 0.0)), name="Path"):
    """A curve without bevel through these points."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("POLY")
    spline.points.add(len(points) - 1)
    for point, place in zip(spline.points, points, strict=True):
        point.co = (*place, 1.0)
    return linked(bpy.data.objects.new(name, data))


def away(points, curve):
    """Distances to the first segment of a curve."""
    begin, end = (np.array(curve.matrix_world @ p.co.to_3d()) for p in curve.data.splines[0].points)
    share = np.clip((points - begin) @ (end - begin) / ((end - begin) @ (end - begin)), 0.0, 1.0)
    return np.linalg.norm(points - begin - share[:, None] * (end - begin), axis=1)


def on_plane(count=300, **density):
    surface = plane()
    activate(surface)
    obj = scenes.scattered(surface, count=count)
    return obj, optimized(obj, **density) if density else None


def test_points_lie_near_a_curve_that_has_no_faces():
    curve = path()
    obj, found = on_plane(
        use_distance=True, distance_object=curve, distance_max=0.2, distance_falloff=0.0
    )
    assert away(found, curve).max() < 0.2 + 0.02
    assert away(found, curve).max() > 0.17
    assert obj.dapple.report.capacity_variation < 0.05
    found = optimized(obj, distance_invert=True)
    assert away(found, curve).min() > 0.2 - 0.02


def test_a_curve_above_the_surface_counts_if_height_is_ignored():
    curve = path()
    curve.location.z = 3.0
    obj, _ = on_plane(60)
    with pytest.raises(RuntimeError, match="density is 0"):
        optimized(
            obj, use_distance=True, distance_object=curve, distance_max=0.2, distance_falloff=0.0
        )
    found = optimized(obj, ignore_height=True)
    assert away(found + np.array([0.0, 0.0, 3.0]), curve).max() < 0.22


def test_points_thin_out_over_the_falloff():
    curve = path(((-5.0, 0.0, 0.0), (5.0, 0.0, 0.0)))
    _, found = on_plane(
        800, use_distance=True, distance_object=curve, distance_max=0.2, distance_falloff=0.8
    )
    distance = np.abs(found[:, 1])
    full = 0.2 + 0.5 * 0.8  # integral of the density on one side
    for low, high in ((0.0, 0.2), (0.2, 0.4), (0.4, 0.7), (0.7, 1.0)):
        share = sum(min(1.0, 1.0 - (y - 0.2) / 0.8) for y in np.linspace(low, high, 401)) / 401
        expected = share * (high - low) / full
        assert ((distance >= low) & (distance < high)).mean() == pytest.approx(expected, abs=0.02)


def test_a_bezier_curve_counts_as_it_is_drawn_and_moves_with_its_object():
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.5, location=(0.3, 0.0, 0.0))
    circle = bpy.context.object
    circle.data.resolution_u = 32
    _, found = on_plane(
        use_distance=True, distance_object=circle, distance_max=0.1, distance_falloff=0.0
    )
    radius = np.linalg.norm(found - [0.3, 0.0, 0.0], axis=1)
    assert 0.38 < radius.min() < radius.max() < 0.62


def empty(location=(0.5, 0.5, 0.0), name="Empty"):
    made = linked(bpy.data.objects.new(name, None))
    made.location = location
    return made


def edges_of(location):
    mesh = bpy.data.meshes.new("Wire")
    mesh.from_pydata([(0, -0.3, 0), (0, 0.3, 0), (0.5, 0, 0)], [(0, 1)], [])
    made = linked(bpy.data.objects.new("Wire", mesh))
    made.location = location
    return made


def test_empties_wires_and_points_count_where_they_are():
    at = empty()
    obj, found = on_plane(200, use_distance=True, distance_object=at, distance_falloff=0.0)
    assert np.linalg.norm(found - [0.5, 0.5, 0.0], axis=1).max() < 0.52
    wire = edges_of((-0.5, 0.0, 0.0))
    found = optimized(obj, distance_object=wire, distance_max=0.2)
    beside = np.hypot(found[:, 0] + 0.5, np.maximum(np.abs(found[:, 1]) - 0.3, 0.0))
    loose = np.linalg.norm(found, axis=1)
    assert np.minimum(beside, loose).max() < 0.22
    assert (loose < 0.22).any()
    assert (beside < 0.22).any()


@pytest.mark.skipif(
    "add_curves" not in bpy.types.Curves.bl_rna.functions, reason="strands cannot be made here"
)
def test_strands_count_by_their_lines():
    hair = bpy.data.hair_curves.new("Hair")
    hair.add_curves([2, 3])
    places = [(-0.8, -0.5, 0), (-0.8, 0.5, 0), (0.8, -0.5, 0), (0.8, 0.0, 0), (0.8, 0.5, 0)]
    hair.attributes["position"].data.foreach_set("vector", np.ravel(places))
    made = linked(bpy.data.objects.new("Hair", hair))
    _, found = on_plane(200, use_distance=True, distance_object=made, distance_falloff=0.0)
    beside = np.hypot(np.abs(found[:, 0]) - 0.8, np.maximum(np.abs(found[:, 1]) - 0.5, 0.0))
    assert beside.max() < 0.52
    assert (beside < 0.1).any()


def test_the_nearest_object_of_a_collection_counts():
    things = collection()
    inner = bpy.data.collections.new("Inner")
    things.children.link(inner)
    for into, x in ((things, -0.6), (inner, 0.6)):
        made = empty((x, 0.0, 0.0), f"At {x}")
        bpy.context.scene.collection.objects.unlink(made)
        into.objects.link(made)
    curve = path(((0.0, -0.8, 0.0), (0.0, -0.7, 0.0)))
    obj, found = on_plane(
        300, use_distance=True, distance_collection=things, distance_max=0.2, distance_falloff=0.0
    )
    assert np.abs(np.abs(found[:, 0]) - 0.6).max() < 0.22
    assert 0.4 < (found[:, 0] > 0.0).mean() < 0.6
    found = optimized(obj, distance_object=curve)
    assert (np.abs(found[:, 0]) < 0.3).any()


def test_inside_of_a_closed_mesh_the_distance_is_nothing():
    things = collection()
    stone = obstacle(things, 0.4)
    activate(plane())
    obj = scenes.scattered(bpy.context.object, count=300)
    found = optimized(
        obj, use_distance=True, distance_object=stone, distance_max=0.1, distance_falloff=0.0
    )
    beyond = np.abs(found[:, :2]).max(axis=1)
    assert beyond.max() < 0.52
    assert (beyond < 0.2).any()
    found = optimized(obj, distance_min=0.05)
    assert np.abs(found[:, :2]).max(axis=1).min() > 0.44


def test_points_of_another_scatter_count_and_its_own_do_not():
    surface = plane(4.0)
    trees = scenes.scattered(surface, count=6)
    things = collection()
    things.objects.link(trees)
    activate(surface)
    obj = scenes.scattered(surface, count=200)
    things.objects.link(obj)
    density = {"use_distance": True, "distance_collection": things, "distance_falloff": 0.0}
    found = optimized(obj, distance_max=0.3, **density)
    apart = np.linalg.norm(found[:, None] - scenes.positions(trees)[None], axis=2).min(axis=1)
    assert apart.max() < 0.32
    np.testing.assert_array_equal(optimized(obj), found)


def test_an_object_that_is_hidden_counts():
    curve = path()
    curve.hide_set(True)
    _, found = on_plane(
        100, use_distance=True, distance_object=curve, distance_max=0.2, distance_falloff=0.0
    )
    assert away(found, curve).max() < 0.22


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("empty", "Distance: there is nothing in 'Things' to measure to"),
        ("own", "Distance: there is nothing in 'Plane' to measure to"),
        ("disabled", "Object 'Path', to which a distance is measured, is not evaluated"),
        ("far", "density is 0"),
    ],
)
def test_what_a_distance_cannot_be_measured_to_is_reported(given, said):
    surface, curve = plane(), path(((0, 0, 50), (1, 0, 50)))
    obj = scenes.scattered(surface, count=50)
    before, density = scenes.positions(obj), obj.dapple.density
    density.use_distance = True
    if given == "empty":
        density.distance_collection = collection()
    elif given == "own":
        density.distance_object = surface
    else:
        density.distance_object = curve
        curve.hide_viewport = given == "disabled"
    activate(obj)
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.dapple.optimize()
    np.testing.assert_array_equal(scenes.positions(obj), before)


def test_without_an_object_the_distance_has_no_effect_and_the_panel_says_so():
    obj, _ = on_plane(60)
    before = scenes.positions(obj)
    said = "No effect yet: choose an object or a collection"
    assert said not in drawn()
    np.testing.assert_array_equal(optimized(obj, use_distance=True), before)
    assert said in " ".join(drawn())
    obj.dapple.density.distance_object = empty()
    assert said not in " ".join(drawn())


def test_points_keep_to_the_border_or_off_it():
    obj, found = on_plane(use_border=True, border_max=0.2, border_falloff=0.0)
    assert (1.0 - np.abs(found[:, :2]).max(axis=1)).max() < 0.22
    found = optimized(obj, border_invert=True)
    assert (1.0 - np.abs(found[:, :2]).max(axis=1)).min() > 0.18


def test_a_border_mask_on_a_closed_surface_has_no_effect_and_the_panel_says_so():
    said = "No effect: the surface is closed and has no border"
    obj = scenes.scattered(scenes.sphere(), count=60)
    before = scenes.positions(obj)
    np.testing.assert_array_equal(optimized(obj, use_border=True), before)
    assert said in " ".join(drawn())
    other, _ = on_plane(20, use_border=True)
    activate(other)
    assert said not in " ".join(drawn())


def test_aspect_keeps_one_side_of_a_sphere():
    obj = scenes.scattered(scenes.sphere(), count=200)
    found = optimized(
        obj, use_aspect=True, aspect_max=math.radians(60), aspect_falloff=math.radians(10)
    )
    around = np.degrees(np.arctan2(found[:, 0], found[:, 1]))  # clockwise from north
    steep = np.abs(found[:, 2]) < 0.95
    assert np.abs(around[steep]).max() < 80.0
    found = optimized(obj, aspect_direction=math.radians(90))
    steep = np.abs(found[:, 2]) < 0.95
    assert found[steep, 0].min() > 0.0


def test_noise_makes_patches_that_stay_with_the_surface():
    obj, found = on_plane(400, use_noise=True, noise_size=0.5, noise_falloff=0.0)
    values = noise(found / 0.5, 2, 0)
    assert np.quantile(values, 0.05) > 0.45
    surface = obj.dapple.surface
    surface.location, surface.rotation_euler.z = (3.0, 4.0, 0.0), 0.8
    bpy.context.view_layer.update()
    assert reason(obj) == ""
    there = np.array(surface.matrix_world.inverted())
    again = optimized(obj) @ there[:3, :3].T + there[:3, 3]
    values = noise(again / 0.5, 2, 0)
    assert np.quantile(values, 0.05) > 0.45
    other = optimized(obj, noise_seed=1)
    assert not np.allclose(other, found)


def test_masks_multiply():
    curve = path(((-5.0, 0.0, 0.0), (5.0, 0.0, 0.0)))
    _, found = on_plane(
        use_distance=True,
        distance_object=curve,
        distance_max=0.3,
        distance_falloff=0.0,
        use_border=True,
        border_max=0.3,
        border_falloff=0.0,
    )
    assert np.abs(found[:, 1]).max() < 0.32
    assert np.abs(found[:, 0]).min() > 0.68


def test_strength_leaves_a_part_of_the_density():
    curve = path(((-5.0, 0.0, 0.0), (5.0, 0.0, 0.0)))
    mask = {"distance_max": 0.5, "distance_falloff": 0.0, "distance_strength": 0.75}
    _, found = on_plane(600, use_distance=True, distance_object=curve, **mask)
    assert (np.abs(found[:, 1]) < 0.5).mean() == pytest.approx(0.8, abs=0.02)


@pytest.mark.parametrize("channel", ["RED", "GREEN", "BLUE", "ALPHA", "BRIGHTNESS"])
def test_an_image_counts_by_its_channel(channel):
    """Each channel is 1 in one quarter of the image and 0 elsewhere."""
    image = picture(np.zeros((64, 64)))
    pixels = np.zeros((64, 64, 4), dtype=np.float32)
    corners = {"RED": (0, 0), "GREEN": (0, 32), "BLUE": (32, 0), "ALPHA": (32, 32)}
    for k, (row, column) in enumerate(corners.values()):
        pixels[row : row + 32, column : column + 32, k] = 1.0
    if channel == "BRIGHTNESS":
        pixels[:32, :32, 3] = 1.0
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(pixels.ravel())
    _, found = on_plane(100, image=image, image_channel=channel)
    row, column = corners.get(channel, (0, 0))
    quarter = np.column_stack([found[:, 0] > 0.0, found[:, 1] > 0.0])
    assert (quarter == [column > 0, row > 0]).all(axis=1).mean() > 0.95


def moved_curve(obj, curve):
    curve.location.y = 0.2


def edited_curve(obj, curve):
    curve.data.splines[0].points[0].co.y += 0.2
    curve.data.update_tag()


def another_object(obj, curve):
    obj.dapple.density.distance_object = empty()


def another_of_the_collection(obj, curve):
    made = empty()
    bpy.data.collections["Guides"].objects.link(made)


def given_faces(obj, curve):
    curve.location.z = 0.2
    curve.data.bevel_depth = 0.05  # a bevel gives the curve faces


CHANGES = [moved_curve, edited_curve, another_object, another_of_the_collection, given_faces]
SAID = "Objects that a distance is measured to were moved or changed"


def by_curve(**more):
    curve, guides = path(), collection("Guides")
    guides.objects.link(path(((-0.9, 0.8, 0.0), (0.9, 0.8, 0.0)), "Other"))
    surface = plane()
    activate(surface)
    density = {"use_distance": True, "distance_object": curve, "distance_collection": guides}
    return solved(surface, **density, **more), curve


@pytest.mark.parametrize("change", CHANGES)
def test_a_result_is_out_of_date_when_that_changes_to_which_a_distance_is(change):
    obj, curve = by_curve()
    change(obj, curve)
    assert SAID in reason(obj)
    activate(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == note(obj) == ""


@pytest.mark.parametrize("change", CHANGES)
def test_auto_update_follows_that_to_which_a_distance_is(live, change):
    obj, curve = by_curve()
    obj.dapple.auto_update_mode = "ON"
    assert live.settle() == 0
    change(obj, curve)
    assert reason(obj) != ""
    assert live.settle() == 1
    assert reason(obj) == ""
    assert live.settle() == 0


def test_an_object_no_mask_uses_any_more_is_not_followed(live):
    obj, curve = by_curve()
    obj.dapple.auto_update_mode = "ON"
    obj.dapple.density.use_distance = False
    assert live.settle() == 1
    curve.location.y = 0.5
    assert live.settle() == 0
    assert reason(obj) == ""


def test_an_object_that_is_deleted_leaves_the_others(live):
    obj, curve = by_curve()
    obj.dapple.auto_update_mode = "ON"
    live.settle()
    bpy.data.objects.remove(curve)
    assert live.settle() == 1
    assert reason(obj) == ""
    assert scenes.positions(obj)[:, 1].min() > -0.3
    bpy.data.collections.remove(bpy.data.collections["Guides"])
    assert live.settle() == 1
    assert reason(obj) == ""
    assert scenes.positions(obj)[:, 1].min() < -0.7


MASK_SETTINGS = {
    "use_border": True,
    "use_aspect": True,
    "use_noise": True,
    "noise_seed": 3,
    "noise_detail": 4,
    "noise_size": 0.3,
    "distance_falloff": 0.2,
    "distance_invert": True,
    "ignore_height": True,
    "distance_strength": 0.5,
}


@pytest.mark.parametrize("name", MASK_SETTINGS)
def test_a_setting_of_a_mask_is_a_change_and_followed(live, name):
    obj, _ = by_curve(use_noise=name.startswith("noise_"))
    obj.dapple.auto_update_mode = "ON"
    setattr(obj.dapple.density, name, MASK_SETTINGS[name])
    assert "Settings were changed (Density)" in reason(obj)
    assert live.settle() == 1
    assert reason(obj) == ""


def test_settings_of_a_mask_that_is_off_change_nothing():
    obj = solved(plane())
    density = obj.dapple.density
    density.distance_max, density.border_invert, density.noise_seed = 3.0, True, 9
    density.distance_object, density.aspect_direction = empty(), 1.0
    density.image_channel = "RED"
    assert reason(obj) == ""


def test_a_surface_that_turns_under_an_aspect_is_reported():
    obj = solved(scenes.sphere(), use_aspect=True)
    obj.dapple.surface.rotation_euler.z = 0.5
    assert "was rotated or moved, and the density depends on it" in reason(obj)


def test_another_origin_under_noise_is_reported():
    surface = scenes.sphere()
    obj = solved(surface, use_noise=True)
    for vertex in surface.data.vertices:
        vertex.co.x += 1.0
    surface.location.x = -1.0
    assert "has another origin, and the noise depends on it" in reason(obj)


@pytest.mark.parametrize("density", [{"use_noise": True}, {"use_noise": True, "use_height": True}])
def test_a_shape_that_was_edited_is_reported_before_what_follows_from_that(density):
    surface = scenes.sphere()
    obj = solved(surface, **density)
    surface.data.vertices[17].co *= 1.5
    assert "has another shape or scale than before" in reason(obj)


def test_what_moves_by_itself_is_a_note_on_another_frame():
    obj, curve = by_curve()
    curve.keyframe_insert("location", frame=1)
    curve.location.y = 0.3
    curve.keyframe_insert("location", frame=5)
    bpy.context.scene.frame_set(5)
    assert reason(obj) == ""
    assert "objects that a distance is measured to" in note(obj)


def test_a_curve_that_moves_leaves_what_is_far_from_it(live):
    """Keep Points: two guides, of which one is moved."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=40, size=4)
    surface = bpy.context.object
    near, far = path(((-1.5, -1.5, 0), (-1.5, 1.5, 0))), path(((1.5, -1.5, 0), (1.5, 1.5, 0)))
    guides = collection("Guides")
    for one in (near, far):
        guides.objects.link(one)
    activate(surface)
    obj = scenes.scattered(surface, count=100)
    obj.dapple.auto_update_mode, obj.dapple.amount = "ON", "PER_AREA"
    obj.dapple.points_per_area = 100.0
    density = obj.dapple.density
    density.use_distance, density.distance_collection, density.distance_falloff = True, guides, 0.3
    density.distance_strength = 0.7
    live.settle()
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    live.settle()
    before = scenes.positions(obj)
    sparse = obj.dapple.report.spacing / math.sqrt(0.3)  # the spacing far from all curves
    near.location.x, reach = 0.1, 0.1 - 1.5 + 0.5 + 0.3 + 3 * sparse
    assert live.settle() == 1
    after = {place.tobytes() for place in scenes.positions(obj)}
    there = before[before[:, 0] > reach]
    assert len(there) > 100
    assert np.mean([place.tobytes() in after for place in there]) >= 0.99
    assert not np.array_equal(scenes.positions(obj), before)


def test_a_bake_keeps_to_a_distance():
    surface, curve = plane(), path()
    surface.keyframe_insert("scale", frame=1)
    surface.scale = (1.3, 1.3, 1.0)
    surface.keyframe_insert("scale", frame=3)
    bpy.context.scene.frame_end = 3
    bpy.context.scene.frame_set(1)
    activate(surface)
    obj = scenes.scattered(surface, count=80)
    optimized(obj, use_distance=True, distance_object=curve, distance_falloff=0.0, distance_max=0.2)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(3)
    places = scenes.instance_matrices(obj)[:, :3, 3] / [1.3, 1.3, 1.0]
    assert away(places, curve).max() < 0.25
    assert reason(obj) == ""


def test_one_mask_is_shown_with_its_legend(overlay):
    curve = path(((-5.0, 0.0, 0.0), (5.0, 0.0, 0.0)))
    obj, _ = on_plane(100, use_distance=True, distance_object=curve, use_border=True)
    bpy.ops.dapple.show_density()
    title, low, high = overlay.legend()
    mass = 100 / float(high.split()[0])
    assert (title, low) == ("Density", "0")
    assert high.endswith("points / m²")
    assert 0.1 < mass < 4.0
    obj.dapple.density.shown_term = "use_distance"
    overlay.tick()
    overlay.tick()
    assert overlay.legend() == ("Distance", "0", "1")
    positions, colors = overlay.triangles()
    expected = np.clip(1.0 - (np.abs(positions[:, 1]) - 0.5) / 0.5, 0.0, 1.0)
    own = addon_host.part("core.density.colors").colored(expected)
    assert np.abs(colors - own).max() < 1e-3
    assert "shown_term" in drawn()
    bpy.ops.dapple.show_density()
    assert overlay.legend() is None
    assert "shown_term" not in drawn()


def test_a_mask_that_is_shown_follows_what_its_distance_is_to(overlay):
    curve = path(((-5.0, 0.0, 0.0), (5.0, 0.0, 0.0)))
    obj, _ = on_plane(60, use_distance=True, distance_object=curve)
    obj.dapple.density.shown_term = "use_distance"
    bpy.ops.dapple.show_density()
    before = overlay.triangles()
    curve.location.y = 0.5
    bpy.context.view_layer.update()
    assert overlay.is_computing()
    overlay.tick()
    assert not np.array_equal(overlay.triangles()[1], before[1])


def test_each_term_can_be_shown(overlay):
    obj, _ = on_plane(40)
    table = addon_host.part("core.settings.density_table")
    for term, label, _ in table.SHOWN_TERMS:
        obj.dapple.density.shown_term = term
        bpy.ops.dapple.show_density()
        assert overlay.legend()[0] == label
        bpy.ops.dapple.show_density()


def test_the_legend_is_a_ramp_of_the_colors():
    legend, colors = (
        addon_host.part(f"{name}") for name in ("blender.density.legend", "core.density.colors")
    )
    corners, shades = legend.strip(100.0, 10.0)
    assert (corners.min(axis=0) == 0.0).all()
    assert (corners.max(axis=0) == [100.0, 10.0]).all()
    expected = colors.colored(corners[:, 0] / 100.0)
    np.testing.assert_allclose(shades[:, :3], expected[:, :3], atol=1e-6)
    triangles = corners.reshape(-1, 3, 2)
    sides = triangles[:, 1:] - triangles[:, :1]
    areas = 0.5 * (sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    assert areas.sum() == pytest.approx(1000.0)


def test_masks_are_lines_that_open_their_settings():
    obj, _ = on_plane(20)
    names = ("slope", "height", "distance", "border", "aspect", "noise")
    shown = drawn()
    for name in names:
        assert f"use_{name}" in shown
        assert f"{name}_strength" not in shown
        setattr(obj.dapple.density, f"use_{name}", True)
        own = set(drawn())
        for setting in ("min", "max", "falloff", "invert", "strength"):
            assert f"{name}_{setting}" in own
        setattr(obj.dapple.density, f"use_{name}", False)
