# SPDX-License-Identifier: GPL-3.0-or-later
"""Points avoid boxes and convex hulls of the instances of other scatters, as renders show them."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import reason
from scipy.spatial import ConvexHull

MARGIN = 0.05
ROUNDED = 1e-5  # positions are stored in single precision


def ground(size=4.0, cuts=1):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, size=size)
    return bpy.context.object


def thing(make, scale=(1.0, 1.0, 1.0)):
    """An object, away from everything, that is instanced."""
    make()
    made = bpy.context.object
    made.location = (0, 0, 50)
    made.data.transform(np.diag([*scale, 1.0]).tolist())
    return made


def log():
    return thing(lambda: bpy.ops.mesh.primitive_cube_add(size=1), (1.2, 0.08, 0.1))


def cone():
    return thing(lambda: bpy.ops.mesh.primitive_cone_add(vertices=9), (0.3, 0.15, 0.2))


def avoided(surface, instance=None, count=9, **settings):
    """A scatter whose instances are turned, tilted and scaled, and a collection with it."""
    obj = scenes.scattered(surface, count=count)
    obj.dapple.instance = instance
    obj.dapple.random_tilt, obj.dapple.random_scale_down = 0.2, 0.4
    for name, value in settings.items():
        setattr(obj.dapple, name, value)
    return obj, scenes.collection_of(obj)


def grass_on(surface, things, shape, count=1500, margin=MARGIN):
    obj = scenes.scattered(surface, count=count)
    density = obj.dapple.density
    density.avoid_collection, density.avoid_shape = things, shape
    density.avoid_margin = margin
    scenes.activate(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def instances(obj):
    """Each instance as the corners (k, 3) in its own space and its matrix, from the scene."""
    for one in bpy.context.evaluated_depsgraph_get().object_instances:
        if one.is_instance and one.parent is not None and one.parent.original == obj:
            corners = np.array([vertex.co[:] for vertex in one.object.data.vertices])
            yield corners.reshape(-1, 3), np.array(one.matrix_world, dtype=np.float64)


def outside_of_box(points, corners, matrix):
    """Least distance of points from the box around an instance, as if it had no shear."""
    axes = np.linalg.norm(matrix[:3, :3], axis=0)
    low, high = corners.min(axis=0) * axes, corners.max(axis=0) * axes
    own = (points - matrix[:3, 3]) @ (matrix[:3, :3] / axes)
    return np.linalg.norm(np.maximum(np.maximum(low - own, own - high), 0.0), axis=1)


def outside_of_hull(points, corners, matrix):
    """Distance of points from the hull of an instance, of those near it by its planes."""
    planes = ConvexHull(corners @ matrix[:3, :3].T + matrix[:3, 3]).equations
    return (points @ planes[:, :3].T + planes[:, 3]).max(axis=1)


def test_points_keep_off_the_boxes_of_instances_and_stand_beside_them():
    surface = ground()
    logs, things = avoided(surface, log())
    grass = grass_on(surface, things, "BOX")
    points = scenes.positions(grass)
    away = np.array([outside_of_box(points, *one) for one in instances(logs)])
    assert len(away) == 9
    assert away.min() > MARGIN - ROUNDED
    assert (away < MARGIN + 0.06).any(axis=1).all()  # some stand beside each
    assert grass.dapple.report.capacity_variation < 0.05
    assert len(points) == 1500


def test_points_keep_off_hulls_and_may_stand_in_the_corners_of_boxes():
    surface = ground()
    cones, things = avoided(surface, cone(), count=20)
    points = scenes.positions(grass_on(surface, things, "HULL", margin=0.0))
    away = np.array([outside_of_hull(points, *one) for one in instances(cones)])
    assert away.min() > -ROUNDED
    boxes = np.array([outside_of_box(points, *one) for one in instances(cones)])
    assert (boxes == 0.0).any()


def test_each_object_type_and_each_object_of_a_collection_has_its_shape():
    kinds, pair = [log(), cone(), None], bpy.data.collections.new("Pair")
    for place in (-0.3, 0.3):
        part = log()
        part.location = (0.0, place, 0.0)
        pair.objects.link(part)
    surface = ground()
    logs, things = avoided(surface, count=12)
    for instance in kinds:
        bpy.ops.dapple.edit_object_types(action="ADD")
        kind = logs.dapple.object_types[-1]
        kind.instance, kind.count = instance, 4
    kind.collection = pair
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    points = scenes.positions(grass_on(surface, things, "HULL", margin=0.0))
    shown = list(instances(logs))
    assert len(shown) == 12
    assert len({len(corners) for corners, _ in shown}) == 2  # logs and cones
    assert min(outside_of_hull(points, *one).min() for one in shown) > -ROUNDED


def test_what_the_viewport_leaves_out_is_avoided_too():
    surface = ground()
    logs, things = avoided(surface, log())
    expected = scenes.positions(grass_on(surface, things, "HULL"))
    logs.dapple.display_as, logs.dapple.viewport_share = "POINTS", 0.1
    found = scenes.positions(grass_on(surface, things, "HULL"))
    np.testing.assert_array_equal(found, expected)
    assert (logs.dapple.display_as, round(logs.dapple.viewport_share, 6)) == ("POINTS", 0.1)
    assert not [mesh.name for mesh in bpy.data.meshes if mesh.name.startswith("Cube.0")]


def test_discs_are_as_they_were():
    surface = ground()
    logs, things = avoided(surface, log())
    logs.dapple.object_types.add().radius = 0.3
    found = scenes.positions(grass_on(surface, things, "DISC"))
    apart = np.linalg.norm(found[:, None] - scenes.positions(logs)[None], axis=2)
    assert 0.3 - ROUNDED < apart.min() < 0.35


@pytest.mark.parametrize("shape", ["BOX", "HULL"])
def test_instances_that_are_no_meshes_keep_their_discs(shape):
    surface = ground()
    empty = bpy.data.objects.new("Empty", None)
    bpy.context.scene.collection.objects.link(empty)
    others, things = avoided(surface, empty)
    found = scenes.positions(grass_on(surface, things, shape, 300, margin=0.2))
    apart = np.linalg.norm(found[:, None] - scenes.positions(others)[None], axis=2)
    assert apart.min() > 0.2 - ROUNDED


@pytest.mark.parametrize("shape", ["BOX", "HULL"])
def test_instances_of_no_size_keep_nothing_free(shape):
    surface = ground()
    nothing = bpy.data.objects.new("Nothing", bpy.data.meshes.new("Nothing"))
    bpy.context.scene.collection.objects.link(nothing)
    for instance, scale in ((log(), 0.0), (nothing, 1.0)):
        others, things = avoided(surface, instance, scale=scale)
        found = scenes.positions(grass_on(surface, things, shape, 300, margin=0.2))
        apart = np.linalg.norm(found[:, None] - scenes.positions(others)[None], axis=2)
        assert apart.min() < 0.2


def test_flat_instances_keep_what_they_cover_free():
    surface = ground()
    sheets, things = avoided(surface, thing(lambda: bpy.ops.mesh.primitive_plane_add(size=0.5)))
    sheets.dapple.random_tilt = 0.0
    for shape in ("BOX", "HULL"):
        points = scenes.positions(grass_on(surface, things, shape))
        away = [outside_of_box(points, *one).min() for one in instances(sheets)]
        assert MARGIN - ROUNDED < min(away) < MARGIN + 0.1


def layer_of(obj):
    """The collection that an object is in, in the view layer."""
    children = bpy.context.view_layer.layer_collection.children
    return children[obj.users_collection[0].name]


HIDING = {
    "eye": lambda obj: obj.hide_set(True),
    "monitor": lambda obj: setattr(obj, "hide_viewport", True),
    "collection": lambda obj: setattr(layer_of(obj), "hide_viewport", True),
    "disabled": lambda obj: setattr(obj.users_collection[0], "hide_viewport", True),
}


@pytest.mark.parametrize("shape", ["BOX", "HULL"])
@pytest.mark.parametrize("how", HIDING)
def test_hidden_instances_are_avoided_and_stay_hidden(how, shape):
    surface = ground()
    logs, things = avoided(surface, log())
    expected = scenes.positions(grass_on(surface, things, shape, 300))
    bpy.context.scene.collection.objects.unlink(logs)
    HIDING[how](logs)
    bpy.context.view_layer.update()
    shown, hidden = logs.visible_get(), logs.hide_viewport
    grass = grass_on(surface, things, shape, 300)
    np.testing.assert_array_equal(scenes.positions(grass), expected)
    assert not shown
    assert (logs.visible_get(), logs.hide_viewport) == (False, hidden)
    assert logs.name not in bpy.context.scene.collection.objects
    assert reason(grass) == ""


def test_a_scatter_without_points_is_no_trouble():
    surface = ground()
    logs, things = avoided(surface, log())
    logs.data.clear_geometry()
    assert len(scenes.positions(grass_on(surface, things, "HULL", 100))) == 100


def test_instances_that_stand_still_are_read_once(monkeypatch):
    module = addon_host.part("blender.surface.avoided_shapes")
    read, frames = module.read_shapes, []
    monkeypatch.setattr(module, "read_shapes", lambda *what: frames.append(1) or read(*what))
    instance = log()
    _, things = avoided(ground(), instance)
    moving = ground(size=2.0, cuts=4)
    for frame, place in ((1, -0.5), (5, 0.5)):
        moving.location.x = place
        moving.keyframe_insert("location", frame=frame)
    grass = grass_on(moving, things, "BOX", 200)

    def reads(frame_end):
        bpy.context.scene.frame_end = frame_end
        bpy.context.scene.frame_set(1)
        scenes.activate(grass)
        frames.clear()
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        return len(frames)

    still = reads(4)
    assert reads(9) == still
    instance.shape_key_add(name="Basis")
    instance.shape_key_add(name="Wide").data[0].co.x -= 1.0
    wide = instance.data.shape_keys.key_blocks["Wide"]
    for frame, value in ((1, 0.0), (9, 1.0)):
        wide.value = value
        wide.keyframe_insert("value", frame=frame)
    assert reads(9) >= still + 7


def test_a_change_of_an_instance_makes_the_result_out_of_date():
    surface = ground()
    instance = log()
    logs, things = avoided(surface, instance)
    grass = grass_on(surface, things, "BOX", 200)
    assert reason(grass) == ""
    instance.data.vertices[0].co.x -= 0.5
    instance.data.update()
    assert reason(grass).startswith("Avoided objects were moved or changed")
    scenes.activate(grass)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(grass) == ""
    logs.dapple.scale = 0.5
    assert reason(grass).startswith("Avoided objects were moved or changed")


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_points_leave_boxes_that_move_as_they_were_baked(population):
    raft = ground(size=1.0, cuts=4)
    for frame, place in ((1, -1.2), (5, 0.4)):
        raft.location.x = place
        raft.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = 5
    bpy.context.scene.frame_set(1)
    logs, things = avoided(raft, log(), count=3)
    scenes.activate(logs)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    grass = grass_on(ground(cuts=20), things, "BOX", 500)
    grass.dapple.population = population
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in range(1, 6):
        bpy.context.scene.frame_set(frame)
        points = scenes.positions(grass)
        away = [outside_of_box(points, *one).min() for one in instances(logs)]
        assert min(away) > MARGIN - 1e-4
        assert reason(grass) == ""
