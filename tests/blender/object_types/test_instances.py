# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances and their sizes: scales, offset, clearances of points."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from test_object_types import classes_of, with_classes

pytestmark = pytest.mark.usefixtures("addon")


def box(name, size, location=(9.0, 9.0, 9.0)):
    """A box of this size (x, y, z), which reaches as far on all sides of its origin."""
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=location)
    obj = bpy.context.object
    obj.name = name
    obj.data.transform(np.diag([*size, 1.0]).tolist())
    return obj


def radius_of(obj):
    """Of the circle around its Z axis that its vertices never leave."""
    return max(np.hypot(vertex.co.x, vertex.co.y) for vertex in obj.data.vertices)


def shown(obj):
    """Name of the object, place and scale (n, 3) of each instance."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    rows = [
        (one.object.name, np.array(one.matrix_world))
        for one in depsgraph.object_instances
        if one.is_instance and one.parent.original == obj
    ]
    names, matrices = [name for name, _ in rows], np.array([matrix for _, matrix in rows])
    return names, matrices[:, :3, 3], np.linalg.norm(matrices[:, :3, :3], axis=1)


def half_distances(points):
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(distances, np.inf)
    return 0.5 * distances.min(axis=1)


def test_random_scales_go_down_and_up():
    obj = scenes.scattered(scenes.sphere(), count=300)
    obj.dapple.scale, obj.dapple.random_scale_down = 2.0, 0.25
    down = shown(obj)[2]
    obj.dapple.random_scale_up = 0.5
    both = shown(obj)[2]
    assert 1.5 - 1e-5 <= both.min() < 1.52
    assert 2.95 < both.max() <= 3.0 + 1e-5
    assert np.array_equal(np.argsort(down[:, 0]), np.argsort(both[:, 0])), "the same are large"


def test_each_axis_has_its_scale():
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.scale, obj.dapple.scale_x, obj.dapple.scale_z = 0.5, 2.0, 3.0
    assert np.allclose(shown(obj)[2], (1.0, 0.5, 1.5), atol=1e-5)


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 1, 1)])
def test_an_offset_lifts_and_sinks_instances_along_the_normal(scale):
    obj = scenes.scattered(scenes.sphere(scale, location=(1, 2, 3), rotation=(0.1, 0.2, 0.3)))
    before = shown(obj)[1]
    normals = scenes.rotations(obj)[:, :, 2]
    for offset in (0.25, -0.5):
        obj.dapple.offset = offset
        assert np.allclose(shown(obj)[1], before + offset * normals, atol=1e-5)


def test_fitted_instances_are_as_large_as_their_room():
    obj = scenes.scattered(scenes.sphere(), count=200)
    obj.dapple.instance = thing = box("Thing", (3.0, 4.0, 1.0))
    obj.dapple.fit_to_spacing = 1.0
    _, places, scales = shown(obj)
    assert np.allclose(scales[:, 0] * radius_of(thing), half_distances(places), rtol=1e-4)
    obj.dapple.scale = 0.5
    assert np.allclose(shown(obj)[2], 0.5 * scales, rtol=1e-5)
    obj.dapple.scale, obj.dapple.fit_to_spacing = 1.0, 0.5
    assert np.allclose(shown(obj)[2], np.sqrt(scales), rtol=1e-5)


def test_the_cone_fits_too():
    obj = scenes.scattered(scenes.sphere(), count=200)
    obj.dapple.fit_to_spacing = 1.0
    _, places, scales = shown(obj)
    radius = 0.3 * obj.dapple.report.spacing
    assert np.allclose(scales[:, 0] * radius, half_distances(places), rtol=1e-4)


def test_a_fitted_instance_that_is_edited_or_exchanged_is_fitted_anew():
    obj = scenes.scattered(scenes.sphere())
    thing, other = box("Thing", (1.0, 1.0, 1.0)), box("Other", (8.0, 6.0, 2.0))
    obj.dapple.instance, obj.dapple.fit_to_spacing = thing, 1.0
    before = shown(obj)[2]
    thing.data.transform(np.diag([4.0, 4.0, 1.0, 1.0]).tolist())
    thing.data.update()
    assert np.allclose(shown(obj)[2], before / 4.0, rtol=1e-5)
    obj.dapple.instance = other
    assert np.allclose(shown(obj)[2] * radius_of(other), before * np.sqrt(0.5), rtol=1e-4)


def test_each_object_of_a_collection_is_fitted_by_its_own_bounds():
    things = [box("Flat", (4.0, 4.0, 0.1)), box("Pole", (0.1, 0.1, 5.0)), box("Log", (1, 9, 1))]
    empty = bpy.data.objects.new("Empty", None)
    obj = scenes.scattered(scenes.sphere(), count=200)
    obj.dapple.collection, obj.dapple.fit_to_spacing = scenes.collection_of(*things, empty), 1.0
    names, places, scales = shown(obj)
    radii = {"Empty": 1.0, **{thing.name: radius_of(thing) for thing in things}}
    assert set(names) == set(radii)
    everything = [thing.name for thing in things]
    fitted = np.isin(names, everything)
    own = np.array([radii[name] for name in names])
    assert np.allclose((scales[:, 0] * own)[fitted], half_distances(places)[fitted], rtol=1e-4)


def test_a_collection_in_a_collection_is_fitted_as_a_whole():
    left, right = box("Left", (1, 1, 1), (-2.0, 0.0, 0.0)), box("Right", (1, 1, 1), (3.0, 0.0, 0.0))
    outer = bpy.data.collections.new("Outer")
    outer.children.link(scenes.collection_of(left, right))
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.collection, obj.dapple.fit_to_spacing = outer, 1.0
    names, _, scales = shown(obj)
    chosen = np.array(names) == "Right"
    assert chosen.sum() == 60
    room = np.array([one.value for one in obj.data.attributes["dapple_clearance"].data])
    assert np.allclose(scales[chosen, 0] * np.hypot(3.5, 0.5), room, rtol=1e-4)


def test_each_class_is_fitted_to_the_room_among_its_like():
    big, small = box("Big", (6.0, 8.0, 1.0)), box("Small", (1.0, 1.0, 1.0))
    obj = with_classes(
        scenes.sphere(),
        {"instance": big, "use_count": True, "count": 20, "fit_to_spacing": 1.0},
        {"instance": small},
        count=200,
    )
    names, places, scales = shown(obj)
    is_big = np.array(names) == "Big"
    assert is_big.sum() == 20
    assert np.allclose(scales[is_big, 0] * 5.0, half_distances(places[is_big]), rtol=1e-4)
    assert np.allclose(scales[~is_big], 1.0, atol=1e-5)
    obj.dapple.object_types[0].fit_to_spacing, obj.dapple.object_types[1].fit_to_spacing = 0.0, 1.0
    _, places, scales = shown(obj)
    room = half_distances(places[~is_big])
    assert np.allclose(scales[~is_big, 0] * np.sqrt(0.5), room, rtol=1e-4)
    assert np.allclose(scales[is_big], 1.0, atol=1e-5)


def test_a_radius_limits_the_room():
    thing = box("Thing", (1.0, 1.0, 1.0))
    kinds = [
        {"instance": thing, "radius": 0.05, "fit_to_spacing": 1.0},
        {"instance": thing, "weight": 9.0},
    ]
    obj = with_classes(scenes.sphere(), *kinds, count=200)
    scales = shown(obj)[2][: (classes_of(obj) == 0).sum()]
    assert np.allclose(scales[:, 0] * np.sqrt(0.5), 0.05, rtol=1e-4)


def following(obj):
    """The first class, whose radius is that of its instances from now on."""
    kind = obj.dapple.object_types[0]
    kind.radius_from_bounds = True
    return kind


def test_a_radius_follows_the_bounds_and_the_scale_of_its_instance():
    thing, other = box("Thing", (0.6, 0.8, 1.0)), box("Other", (0.3, 0.4, 9.0))
    obj = with_classes(scenes.sphere(), {"instance": thing}, {"instance": other}, count=40)
    kind = following(obj)
    assert kind.radius == pytest.approx(0.5)
    assert obj.dapple.object_types[1].radius == 0.0
    kind.instance = other
    assert kind.radius == pytest.approx(0.25)
    kind.scale, kind.scale_x, kind.scale_y = 2.0, 0.5, 0.25
    kind.random_scale_up, kind.random_scale_down, kind.density_scale = 0.5, 0.5, -0.5
    assert kind.radius == pytest.approx(0.25 * 2.0 * 0.5 * 1.5 * 1.5)
    kind.radius = 7.0
    assert kind.radius == pytest.approx(0.25 * 2.0 * 0.5 * 1.5 * 1.5)


def test_a_radius_follows_an_instance_that_is_edited():
    thing = box("Thing", (0.12, 0.16, 1.0))
    obj = with_classes(scenes.sphere(), {"instance": thing}, {}, count=40)
    kind = following(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    reason = addon_host.part("blender.scatter.object").settings_reason
    assert reason(obj) == ""
    thing.data.transform(np.diag([2.0, 2.0, 1.0, 1.0]).tolist())
    thing.data.update()
    bpy.context.view_layer.update()
    assert kind.radius == pytest.approx(0.2)
    assert "Object Types" in reason(obj)
    thing.modifiers.new("Array", "ARRAY").relative_offset_displace = (1.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    assert kind.radius == pytest.approx(np.hypot(0.36, 0.16))


def test_a_radius_from_a_collection_is_that_of_its_largest_object():
    small, large = box("Small", (0.1, 0.1, 0.1)), box("Large", (0.6, 0.8, 0.1))
    large.scale = (3.0, 3.0, 3.0)  # this object is not instanced
    left, right = box("Left", (1, 1, 1), (-2.0, 0.0, 0.0)), box("Right", (1, 1, 1), (3.0, 0.0, 0.0))
    chosen = scenes.collection_of(small, large, bpy.data.objects.new("Empty", None))
    obj = with_classes(scenes.sphere(), {"collection": chosen}, {}, count=40)
    kind = following(obj)
    assert kind.radius == pytest.approx(0.5)
    chosen.children.link(scenes.collection_of(left, right))
    bpy.context.view_layer.update()
    assert kind.radius == pytest.approx(np.hypot(3.5, 0.5))


def test_instances_with_the_radius_of_their_bounds_are_only_made_smaller():
    thing = box("Thing", (0.12, 0.16, 0.1))
    kinds = [{"instance": thing, "fit_to_spacing": 1.0, "scale": 2.0}, {"weight": 20.0}]
    obj = with_classes(scenes.sphere(), *kinds, count=210)
    kind = following(obj)
    assert kind.radius == pytest.approx(0.2)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    scales = shown(obj)[2][:10]
    assert np.allclose(scales, 2.0, rtol=1e-4), "there is room"


def test_instances_that_are_too_large_for_the_surface_become_as_large_as_fits():
    houses, trees = box("House", (3.0, 4.0, 1.0)), box("Tree", (1.0, 1.0, 2.0))
    obj = with_classes(scenes.sphere(), {"instance": houses}, {"instance": trees}, count=60)
    for kind in obj.dapple.object_types:
        kind.radius_from_bounds = True
    with pytest.raises(RuntimeError, match="radii need discs"):
        bpy.ops.dapple.optimize()
    for kind in obj.dapple.object_types:
        kind.fit_to_spacing = 1.0
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert addon_host.part("blender.scatter.object").settings_reason(obj) == ""
    names, places, scales = shown(obj)
    radii = scales[:, 0] * np.where(np.array(names) == "House", 2.5, np.sqrt(0.5))
    distances = np.linalg.norm(places[:, None] - places[None], axis=2) + 9.0 * np.eye(60)
    overlap = 1.0 - distances / (radii[:, None] + radii[None])
    assert overlap.max() < 0.1
    assert radii[:30].mean() > 2.0 * radii[30:].mean(), "they stay larger"
    assert (np.pi * radii**2).sum() > 0.4 * 4.0 * np.pi


def test_a_new_setting_gives_a_scatter_of_an_older_version_the_group_of_this_one():
    nodes, builder = addon_host.part("nodes"), addon_host.part("nodes.builder")
    obj = scenes.scattered(scenes.sphere())
    old = builder.new_group("Old", [*nodes.INPUTS, ("Scale", "NodeSocketFloat")], nodes.INPUTS[:1])
    old[nodes.VERSION_KEY] = 12
    obj.modifiers[0].node_group = old
    obj.dapple.scale = 2.0
    assert obj.modifiers[0].node_group == old
    obj.dapple.scale_z = 2.0
    assert obj.modifiers[0].node_group == nodes.ensure_group()
    assert np.allclose(shown(obj)[2], (2.0, 2.0, 4.0), atol=1e-5)


ODD_NAMES = [
    *("a", "B", "a.001", "a 1", "a10", "a9", "A9", "a09", "a009", "a1b", "a01a", "ab", "a1", "A"),
    *(
        "Rock",
        "rock.01",
        "rock 01",
        "Röck",
        "Zebra",
        "Österreich",
        "é",
        "e",
        "_",
        "Tree2",
        "Tree10",
    ),
    *("tree2a", "Tree 2", "10", "9", "1.5", "1.05", "-1", "日本", "x0", "x", "x00y", "x0z"),
]


def test_members_are_in_the_order_in_which_nodes_have_them():
    things = [box(name, (0.1, 0.1, 0.1)) for name in ODD_NAMES]
    chosen = scenes.collection_of(*things[::2])
    for thing in things[1::2]:
        chosen.children.link(scenes.collection_of(thing))
        chosen.children[-1].name = f"{thing.name}c"
    obj = scenes.scattered(scenes.sphere(), count=30 * len(things))
    obj.dapple.collection, obj.dapple.use_weights = chosen, True
    inner = {f"{thing.name}c": thing.name for thing in things[1::2]}
    for entry in obj.dapple.weights:
        for other in obj.dapple.weights:
            other.weight = float(other == entry)
        name = entry.object.name if entry.object else inner[entry.collection.name]
        assert set(shown(obj)[0]) == {name}


def test_weights_say_how_often_objects_are_picked():
    things = [box(name, (0.1, 0.1, 0.1)) for name in ("A", "B", "C")]
    obj = scenes.scattered(scenes.sphere(), count=1000)
    obj.dapple.collection = scenes.collection_of(*things)
    before = shown(obj)[0]
    obj.dapple.use_weights = True
    assert [one.object for one in obj.dapple.weights] == things
    assert shown(obj)[0] == before, "all are picked alike"
    obj.dapple.weights[1].weight = 3.0
    counts = [shown(obj)[0].count(name) for name in "ABC"]
    assert np.allclose(counts, (200, 600, 200), atol=60)
    obj.dapple.weights[0].weight = 0.0
    assert "A" not in shown(obj)[0]
    found = shown(obj)[0]
    obj.dapple.scale, obj.dapple.seed = 2.0, 5
    assert shown(obj)[0] == found
    obj.dapple.use_weights = False
    assert shown(obj)[0] == before


def test_weights_and_fit_work_together():
    things = [box("A", (0.5, 0.5, 1.0)), box("B", (3.0, 4.0, 1.0))]
    obj = scenes.scattered(scenes.sphere(), count=100)
    obj.dapple.collection, obj.dapple.fit_to_spacing = scenes.collection_of(*things), 1.0
    obj.dapple.use_weights, obj.dapple.weights[1].weight = True, 4.0
    names, places, scales = shown(obj)
    own = np.array([{"A": np.sqrt(0.125), "B": 2.5}[name] for name in names])
    assert np.allclose(scales[:, 0] * own, half_distances(places), rtol=1e-4)
    assert names.count("B") > 60


def test_a_weight_stays_with_its_object():
    things = [box(name, (0.1, 0.1, 0.1)) for name in ("B", "C")]
    obj = scenes.scattered(scenes.sphere(), count=60)
    obj.dapple.collection = chosen = scenes.collection_of(*things)
    obj.dapple.use_weights, obj.dapple.weights[0].weight = True, 0.0
    assert set(shown(obj)[0]) == {"C"}
    chosen.objects.link(box("A", (0.1, 0.1, 0.1)))
    bpy.context.view_layer.update()
    assert [one.object.name for one in obj.dapple.weights] == ["A", "B", "C"]
    assert [one.weight for one in obj.dapple.weights] == [1.0, 0.0, 1.0]
    assert set(shown(obj)[0]) == {"A", "C"}
    chosen.objects.unlink(things[1])
    bpy.context.view_layer.update()
    assert set(shown(obj)[0]) == {"A"}
    obj.dapple.weights[1].weight = 1.0
    things[0].name = "0"
    obj.dapple.weights[0].weight = 0.5
    obj.update_tag()
    bpy.context.view_layer.update()
    assert [one.object.name for one in obj.dapple.weights] == ["0", "A"]


def test_each_class_has_its_weights_and_the_first_takes_over_those_of_the_scatter():
    things = [box(name, (0.1, 0.1, 0.1)) for name in ("A", "B")]
    obj = scenes.scattered(scenes.sphere(), count=60)
    obj.dapple.collection, obj.dapple.use_weights = scenes.collection_of(*things), True
    obj.dapple.weights[0].weight = 0.0
    for _ in range(2):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    first, second = obj.dapple.object_types
    assert [one.weight for one in first.weights] == [0.0, 1.0]
    second.collection, second.use_weights = first.collection, True
    second.weights[1].weight = 0.0
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert shown(obj)[0] == ["B"] * 30 + ["A"] * 30
    first.radius_from_bounds = True
    assert first.radius == pytest.approx(np.hypot(0.05, 0.05))
    things[0].data.transform(np.diag([9.0, 9.0, 1.0, 1.0]).tolist())
    things[0].data.update()
    bpy.context.view_layer.update()
    assert first.radius == pytest.approx(np.hypot(0.05, 0.05)), "A is never picked"
    first.weights[0].weight = 0.1
    assert first.radius == pytest.approx(np.hypot(0.45, 0.45))
