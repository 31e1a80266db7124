# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep Points in Blender: which points stay after an update, and when all are solved again."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import reason
from test_auto_update import grown


@pytest.fixture
def obj(live):
    """A scatter by area over a fine sphere with a vertex group."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32)
    surface = bpy.context.object
    grown(surface).add(range(len(surface.data.vertices)), 1.0, "REPLACE")
    made = scenes.scattered(surface, count=100)
    made.dapple.auto_update_mode = "ON"
    made.dapple.amount, made.dapple.points_per_area = "PER_AREA", 60.0
    made.dapple.density.attribute = "Grass"
    assert live.settle() > 0
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    live.settle()
    return made


def stored(obj):
    """All that is stored of each point, by its id, in bytes."""
    meshio, records = (
        addon_host.part("blender.base.mesh_arrays"),
        addon_host.part("core.surface.records"),
    )
    types = {**records.ROW_ATTRIBUTES, "id": "INT", "dapple_scale": "FLOAT", "dapple_rank": "FLOAT"}
    columns = {**meshio.read_columns(obj.data, types), "place": meshio.read_points(obj.data)}
    count = len(columns["id"])
    rows = np.concatenate(
        [one.reshape(count, -1).astype(np.float64) for one in columns.values()], 1
    )
    return {int(key): row.tobytes() for key, row in zip(columns["id"], rows, strict=True)}


def places(obj):
    ids = addon_host.part("blender.scatter.points").point_columns_of(obj)["id"]
    return dict(zip(ids.tolist(), scenes.positions(obj), strict=True))


def stroke(surface, middle, radius, weight):
    """A brush stroke on the vertex group."""
    away = np.linalg.norm(scenes.world_vertices(surface) - middle, axis=1)
    near = np.flatnonzero(away < radius).tolist()
    surface.vertex_groups["Grass"].add(near, weight, "REPLACE")
    surface.data.update()


def far_stay(before, after, there, middle, reach):
    """Share of the points farther from a place than that, whose bytes are the same."""
    far = [key for key, place in there.items() if np.linalg.norm(place - middle) > reach]
    assert len(far) > 200
    return np.mean([before[key] == after.get(key) for key in far])


@pytest.mark.parametrize("weight", [0.0, 0.4])
def test_a_stroke_leaves_what_is_far_from_it(live, obj, weight):
    middle = np.array([0.0, 0.0, 1.0])
    before, there = stored(obj), places(obj)
    stroke(obj.dapple.surface, middle, 0.4, weight)
    assert live.settle() == 1
    assert reason(obj) == ""
    assert obj.dapple.report.measured
    assert obj.dapple.report.capacity_variation < 0.05
    reach = 0.4 + 3 * obj.dapple.report.spacing
    assert far_stay(before, stored(obj), there, middle, reach) >= 0.99
    assert len(obj.data.vertices) < len(before)


def test_an_obstacle_that_is_added_and_moved_leaves_what_is_far_from_it(live, obj):
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    obj.dapple.density.avoid_collection = stones
    stone = scenes.sphere(location=(1.0, 0.0, 0.0), scale=(0.3, 0.3, 0.3))
    live.settle()
    for shift in (0.0, 0.1):
        before, there = stored(obj), places(obj)
        if stone.users_collection[0] != stones:
            stones.objects.link(stone)
        stone.location.y = shift
        assert live.settle() == 1
        assert reason(obj) == ""
        reach = 0.5 + 3 * obj.dapple.report.spacing
        assert far_stay(before, stored(obj), there, np.array([1.0, 0, 0]), reach) >= 0.99
        away = np.linalg.norm(scenes.positions(obj) - np.array(stone.location), axis=1)
        assert away.min() > 0.3


def test_an_edited_surface_leaves_what_is_far_from_the_edit(live, obj):
    surface, middle = obj.dapple.surface, np.array([0.0, 0.0, -1.0])
    before, there = stored(obj), places(obj)
    for vertex in surface.data.vertices:
        if (vertex.co - type(vertex.co)(middle)).length < 0.3:
            vertex.co.z -= 0.1
    surface.data.update()
    assert live.settle() == 1
    reach = 0.4 + 3 * obj.dapple.report.spacing
    assert far_stay(before, stored(obj), there, middle, reach) >= 0.99


def test_another_amount_keeps_the_ids(live, obj):
    before = stored(obj).keys()
    obj.dapple.points_per_area = 50.0
    assert live.settle() == 1
    assert stored(obj).keys() < before
    obj.dapple.amount, obj.dapple.count = "COUNT", 900
    assert live.settle() == 1
    assert len(stored(obj)) == obj.dapple.report.count == 900


def test_an_exact_count_is_exact_after_a_stroke(live, obj):
    obj.dapple.amount, obj.dapple.count = "COUNT", 700
    live.settle()
    before = stored(obj).keys()
    stroke(obj.dapple.surface, (0.0, 0.0, 1.0), 0.5, 0.0)
    assert live.settle() == 1
    assert len(obj.data.vertices) == 700
    assert len(before & stored(obj).keys()) > 600
    assert scenes.positions(obj)[:, 2].max() < 0.95
    assert reason(obj) == ""


def test_optimize_starts_anew_from_the_seed(live, obj):
    expected = scenes.positions(obj)
    stroke(obj.dapple.surface, (0.0, 0.0, 1.0), 0.4, 0.0)
    live.settle()
    stroke(obj.dapple.surface, (0.0, 0.0, 1.0), 0.4, 1.0)
    live.settle()
    assert not np.array_equal(scenes.positions(obj), expected)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert np.array_equal(scenes.positions(obj), expected)


@pytest.mark.parametrize("forget", ["session", "keep_points"])
def test_without_a_memory_or_the_setting_the_points_fit_too(live, obj, forget):
    ids = stored(obj).keys()
    if forget == "session":
        addon_host.part("blender.solve.session_solutions").SUBSCRIBER.before_load()
    else:
        obj.dapple.keep_points = False
    stroke(obj.dapple.surface, (0.0, 0.0, 1.0), 0.4, 0.0)
    assert live.settle() == 1
    assert reason(obj) == ""
    assert scenes.positions(obj)[:, 2].max() < 0.97
    if forget == "session":
        assert stored(obj).keys() <= ids


@pytest.mark.parametrize("change", ["seed", "classes", "faces", "tolerance"])
def test_what_cannot_be_kept_is_solved_anew(live, obj, change):
    surface, obj.dapple.max_evaluations = obj.dapple.surface, 20
    assert live.settle() == 1
    if change == "classes":
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[0].radius = 0.01
    elif change == "faces":
        surface.modifiers.new("Triangulate", "TRIANGULATE")
        # The limit surface at the poles, where 64 faces meet, takes Blender seconds.
        surface.modifiers.new("Subdivision", "SUBSURF").use_limit_surface = False
    else:
        setattr(obj.dapple, change, {"seed": 3, "tolerance": 1e-4}[change])
    assert live.settle() == 1
    assert reason(obj) == ""
    expected = scenes.positions(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert np.array_equal(scenes.positions(obj), expected)


def test_locked_points_stay(live, obj):
    obj.data.vertices.foreach_set("select", np.arange(len(obj.data.vertices)) % 5 == 0)
    assert bpy.ops.dapple.lock_points() == {"FINISHED"}
    before = stored(obj)
    locked = [key for key, row in zip(before, range(len(before)), strict=True) if row % 5 == 0]
    stroke(obj.dapple.surface, (0.0, 0.0, 1.0), 0.4, 0.4)
    assert live.settle() == 1
    assert obj.dapple.locked_count == len(locked)
    after = stored(obj)
    assert all(before[key] == after[key] for key in locked)


def test_a_change_between_the_parts_of_an_update_loses_nothing(live, obj):
    """An exact count is made in two parts; what is shown between them is called out of date."""
    obj.dapple.amount, obj.dapple.count = "COUNT", 700
    live.settle()
    stroke(obj.dapple.surface, (0.0, 0.0, 1.0), 0.5, 0.0)
    live.look()
    live.clock.rest()
    while len(obj.data.vertices) == 700:
        live.look()
        assert live.watcher.is_active()
    live.watcher.cancel()
    assert obj.dapple.report.count == len(obj.data.vertices) < 700
    assert "Settings were changed (Count)" in reason(obj)
    obj.dapple.count = 701
    live.settle()
    assert len(obj.data.vertices) == 701
    assert reason(obj) == ""


@pytest.fixture
def mixed(live, obj):
    """Few large discs, more of smaller ones, and points."""
    obj.dapple.amount, obj.dapple.count = "COUNT", 900
    for count, radius in ((25, 0.12), (120, 0.04), (0, 0.0)):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        kind = obj.dapple.object_types[-1]
        kind.use_count, kind.count, kind.radius = count > 0, max(count, 1), radius
    live.settle()
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    live.settle()
    return obj


def kinds_of(obj):
    return addon_host.part("blender.scatter.points").point_columns_of(obj)["dapple_object_type"]


def test_object_types_keep_their_counts_and_ids_after_a_stroke(live, mixed):
    before, middle = stored(mixed), np.array([0.0, 0.0, 1.0])
    stroke(mixed.dapple.surface, middle, 0.3, 0.2)
    assert live.settle() == 1
    assert reason(mixed) == ""
    assert np.bincount(kinds_of(mixed)).tolist() == [25, 120, 755]
    assert len(before.keys() & stored(mixed).keys()) > 850
    assert mixed.dapple.report.worst_overlap < 5e-3
    assert mixed.dapple.report.measured
    assert mixed.dapple.report.capacity_variation < 0.2


def test_object_types_by_area_leave_what_is_far_from_a_stroke(live, mixed):
    for kind, share in zip(mixed.dapple.object_types, (0.03, 0.15, 0.82), strict=True):
        kind.use_count, kind.weight = False, share
    mixed.dapple.amount, mixed.dapple.points_per_area = "PER_AREA", 60.0
    live.settle()
    middle, before = np.array([0.0, 0.0, 1.0]), stored(mixed)
    points = addon_host.part("blender.base.mesh_arrays").read_points(mixed.data)
    there = dict(zip(before, points, strict=True))
    stroke(mixed.dapple.surface, middle, 0.3, 0.9)
    assert live.settle() == 1
    far = [key for key, place in there.items() if np.linalg.norm(place - middle) > 1.5]
    after = stored(mixed)
    assert np.mean([before[key] == after.get(key) for key in far]) > 0.9
    assert len(before.keys() & after.keys()) > 0.95 * len(before)


def test_an_object_type_follows_the_stroke_on_its_own_density(live, mixed):
    own = mixed.dapple.surface.vertex_groups.new(name="Rocks")
    own.add(range(len(mixed.dapple.surface.data.vertices)), 1.0, "REPLACE")
    mixed.dapple.object_types[0].density = "Rocks"
    live.settle()
    before = stored(mixed)
    away = scenes.world_vertices(mixed.dapple.surface)[:, 2] > 0.0
    own.add(np.flatnonzero(away).tolist(), 0.0, "REPLACE")
    mixed.dapple.surface.data.update()
    assert live.settle() == 1
    rocks = addon_host.part("blender.base.mesh_arrays").read_points(mixed.data)[
        kinds_of(mixed) == 0
    ]
    assert len(rocks) == 25
    assert rocks[:, 2].max() < 0.1
    assert len(before.keys() & stored(mixed).keys()) > 800
