# SPDX-License-Identifier: GPL-3.0-or-later
"""Object types: their counts, their instances, and bakes."""

import addon_host
import bmesh
import bpy
import numpy as np
import pytest
import scenes


def with_classes(surface, *kinds, count=90):
    """A scatter with classes of these properties, optimized."""
    obj = scenes.scattered(surface, count=count)
    for values in kinds:
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        for name, value in values.items():
            setattr(obj.dapple.object_types[-1], name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def solid(name, location=(0.0, 0.0, 0.0)):
    bpy.ops.mesh.primitive_cube_add(size=0.1, location=location)
    bpy.context.object.name = name
    return bpy.context.object


def classes_of(obj):
    meshio = addon_host.part("blender.base.mesh_arrays")
    return meshio.read_columns(obj.data, {"dapple_object_type": "INT"})["dapple_object_type"]


def shown(obj):
    """Name of the object on each instance, and its place."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    rows = [
        (one.object.name, np.array(one.matrix_world)[:3, 3])
        for one in depsgraph.object_instances
        if one.is_instance and one.parent.original == obj
    ]
    return [name for name, _ in rows], np.array([place for _, place in rows])


def counts(*kinds, count=100):
    settings = addon_host.part("core.settings.values")
    classes = tuple(settings.ClassSettings(**kind) for kind in kinds)
    return addon_host.part("core.solve.class_counts").class_counts(
        settings.Settings(count=count, object_types=classes)
    )


def test_shares_are_met_by_largest_remainders():
    assert counts({"weight": 1}, {"weight": 1}, {"weight": 1}) == [34, 33, 33]
    assert counts({"weight": 0.2}, {"weight": 0.6}) == [25, 75]
    assert counts({"count": 40, "weight": 0}, {"weight": 1}, {"weight": 2}) == [40, 20, 40]
    assert counts({"count": 7}, {"count": 9}) == [7, 9]
    assert counts({"count": 100}, {"weight": 1}) == [100, 0]
    assert counts({"weight": 0.0}, {"weight": 1.0}) == [0, 100]


def test_counts_that_cannot_be_are_refused():
    error = addon_host.part("core.base.errors").ScatterError
    with pytest.raises(error, match="add up to 120 points, Count is 100"):
        counts({"count": 120}, {"weight": 1})
    with pytest.raises(error, match="60 points have no object type: all weights are 0"):
        counts({"count": 40}, {"weight": 0})


def test_each_class_gets_its_points_and_its_object():
    rock, bush = solid("Rock"), solid("Bush")
    surface = scenes.sphere()
    obj = with_classes(
        surface, {"instance": rock, "weight": 2.0}, {"instance": bush, "weight": 1.0}, count=90
    )
    assert np.bincount(classes_of(obj)).tolist() == [60, 30]
    names, places = shown(obj)
    assert (names.count("Rock"), names.count("Bush")) == (60, 30)
    points = scenes.positions(obj)
    for place, name in zip(places, names, strict=True):
        nearest = np.argmin(np.linalg.norm(points - place, axis=1))
        assert classes_of(obj)[nearest] == ("Rock", "Bush").index(name)


def test_each_class_is_even_by_itself_and_together():
    obj = with_classes(scenes.sphere(), {"weight": 1.0}, {"weight": 1.0}, count=200)
    points, kinds = scenes.positions(obj), classes_of(obj)
    for chosen, least in ((kinds == 0, 0.45), (kinds == 1, 0.45), (kinds >= 0, 0.3)):
        some = points[chosen]
        distance = np.linalg.norm(some[:, None] - some[None], axis=2) + 9.0 * np.eye(len(some))
        best = np.sqrt(2.0 * 4.0 * np.pi / (np.sqrt(3.0) * len(some)))
        assert distance.min() / best > least


def test_each_class_has_its_own_size():
    rock, bush = solid("Rock"), solid("Bush")
    obj = with_classes(
        scenes.sphere(), {"instance": rock, "scale": 2.0}, {"instance": bush, "scale": 0.5}
    )
    sizes = np.linalg.norm(scenes.instance_matrices(obj)[:, :3, 0], axis=1)
    assert sorted(np.unique(sizes.round(4))) == [0.5, 2.0]
    obj.dapple.object_types[1].scale = 3.0
    sizes = np.linalg.norm(scenes.instance_matrices(obj)[:, :3, 0], axis=1)
    assert sorted(np.unique(sizes.round(4))) == [2.0, 3.0]


def test_a_number_that_only_a_class_in_the_middle_has_is_its_own():
    things = [{"instance": solid(f"Thing {k}"), "random_turn": 0.0} for k in range(3)]
    things[1]["scale"], things[1]["align_to_normal"] = 2.0, 0.0
    obj = with_classes(scenes.sphere(), *things, count=60)
    names, _ = shown(obj)
    matrices = scenes.instance_matrices(obj)
    sizes = np.linalg.norm(matrices[:, :3, 0], axis=1)
    outward = matrices[:, :3, 3] / np.linalg.norm(matrices[:, :3, 3], axis=1)[:, None]
    middle = np.array(names) == "Thing 1"
    assert middle.sum() == 20
    assert np.allclose(sizes, np.where(middle, 2.0, 1.0), atol=1e-5)
    up = matrices[:, :3, 2] / sizes[:, None]
    assert np.allclose(up[middle], (0.0, 0.0, 1.0), atol=1e-5)
    assert np.einsum("nd,nd->n", up, outward)[~middle].min() > 0.98


def test_a_collection_gives_each_point_one_of_its_objects():
    trees = bpy.data.collections.new("Trees")
    for k in range(3):
        tree = solid(f"Tree {k}", location=(5.0, k, 0.0))
        trees.objects.link(tree)
    obj = with_classes(scenes.sphere(), {"collection": trees}, {"weight": 1.0}, count=120)
    names, places = shown(obj)
    found = [names.count(f"Tree {k}") for k in range(3)]
    assert sum(found) == 60
    assert min(found) > 8
    assert np.linalg.norm(places, axis=1).max() < 1.1, "where the objects stand does not count"


def test_a_collection_without_classes():
    both = bpy.data.collections.new("Both")
    for name in ("One", "Two"):
        both.objects.link(solid(name))
    obj = scenes.scattered(scenes.sphere(), count=50)
    obj.dapple.collection = both
    names, _ = shown(obj)
    assert len(names) == 50
    assert min(names.count("One"), names.count("Two")) > 8


def test_things_with_radii_are_kept_apart_and_the_worst_pair_is_reported():
    surface = scenes.sphere()
    obj = with_classes(surface, {"radius": 0.16}, {"radius": 0.08}, count=60)
    radii = np.array([0.16, 0.08])[classes_of(obj)]
    points = scenes.positions(obj)
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(distance, np.inf)
    overlap = 1.0 - distance / (radii[:, None] + radii[None])
    report = obj.dapple.report
    assert report.worst_overlap == pytest.approx(max(overlap.max(), 0.0), abs=1e-4)
    # almost the largest possible
    obj.dapple.object_types[0].radius = obj.dapple.object_types[1].radius = 0.24
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert report.worst_overlap > 0.02
    assert bpy.ops.dapple.select_overlap() == {"FINISHED"}
    chosen = [v.index for v in obj.data.vertices if v.select]
    assert sorted(chosen) == sorted([report.overlap_first, report.overlap_second])
    between = scenes.positions(obj)[chosen].mean(axis=0)
    assert np.allclose(bpy.context.scene.cursor.location, between, atol=1e-5)


@pytest.mark.parametrize("radius", [0.3, 0.4])
def test_grass_without_a_radius_grows_outside_of_rocks(radius):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=40, size=10.0)
    surface = bpy.context.object
    obj = with_classes(surface, {"radius": radius, "use_count": True, "count": 100}, {}, count=1600)
    points, kinds = scenes.positions(obj), classes_of(obj)
    assert (np.bincount(kinds) == [100, 1500]).all()
    grass, rocks = points[kinds == 1], points[kinds == 0]
    distance = np.linalg.norm(grass[:, None] - rocks[None], axis=2)
    assert (distance < radius * (1.0 - 1e-5)).sum() == 0
    assert obj.dapple.report.worst_overlap == 0.0


def test_the_first_class_takes_over_what_was_placed():
    rock = solid("Rock")
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.instance, obj.dapple.scale = rock, 1.5
    bpy.ops.dapple.edit_object_types(action="ADD")
    assert obj.dapple.object_types[0].instance == rock
    assert obj.dapple.object_types[0].scale == 1.5
    assert set(shown(obj)[0]) == {"Rock"}


def test_an_object_type_has_the_name_of_what_it_places_unless_it_was_named():
    obj = scenes.scattered(scenes.sphere())
    rock, tree = (bpy.data.objects.new(name, None) for name in ("Rock", "Tree"))
    for instance in (rock, rock, tree):
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].instance = instance
    assert [kind.name for kind in obj.dapple.object_types] == ["Rock", "Type 2", "Tree"]
    obj.dapple.object_types[0].instance = tree
    assert obj.dapple.object_types[0].name == "Rock"


def test_the_list_is_edited_and_the_node_group_follows():
    obj = scenes.scattered(scenes.sphere())
    for _ in range(3):
        bpy.ops.dapple.edit_object_types(action="ADD")
    names = [kind.name for kind in obj.dapple.object_types]
    assert names == ["Type 1", "Type 2", "Type 3"]
    assert obj.dapple.object_type_index == 2
    bpy.ops.dapple.edit_object_types(action="UP")
    assert [kind.name for kind in obj.dapple.object_types] == ["Type 1", "Type 3", "Type 2"]
    bpy.ops.dapple.edit_object_types(action="REMOVE")
    assert [kind.name for kind in obj.dapple.object_types] == ["Type 1", "Type 2"]
    assert obj.modifiers[0].node_group == addon_host.part("nodes").ensure_group(2)
    assert len(scenes.positions(obj)) == 60
    for _ in range(2):
        bpy.ops.dapple.edit_object_types(action="REMOVE")
    assert obj.modifiers[0].node_group == addon_host.part("nodes").ensure_group()
    bpy.ops.dapple.edit_object_types(action="REMOVE")
    assert len(scenes.positions(obj)) == 60


def test_changed_classes_are_stale():
    stale = addon_host.part("blender.scatter.object").settings_reason
    obj = with_classes(scenes.sphere(), {"weight": 1.0}, {"weight": 1.0})
    assert stale(obj) == ""
    obj.dapple.object_types[0].weight = 2.0
    assert stale(obj) == "Settings were changed (Object Types): optimize again"
    obj.dapple.object_types[0].weight = 1.0
    obj.dapple.object_types[0].scale = 4.0
    assert stale(obj) == "", "what is placed does not move the points"


def test_a_bake_keeps_classes_even_and_survives_another_class():
    surface = scenes.tail()
    obj = with_classes(surface, {"weight": 2.0}, {"weight": 1.0}, count=60)
    before = classes_of(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert (classes_of(obj) == before).all()
    bpy.context.scene.frame_set(4)
    baked = scenes.positions(obj)
    bpy.ops.dapple.edit_object_types(action="ADD")  # another node group, which takes over the keys
    assert np.allclose(scenes.positions(obj), baked, atol=1e-6)


def variation(surface, points):
    """Of the areas of points on a surface as it is now."""
    dapple = addon_host.part("core.base.native").package()
    arrays = addon_host.part("blender.surface.mesh").read_mesh(surface)
    native = dapple.Surface(arrays.vertices, arrays.faces)
    closest = dapple.project(native, points)
    samples = dapple.Samples(native, closest.faces, closest.barycentric)
    return dapple.analyze(native, samples).capacity_variation


def test_frames_solved_together_keep_classes_even():
    surface = scenes.tail()
    obj = with_classes(surface, {"weight": 2.0}, {"weight": 1.0}, count=60)
    before = classes_of(obj)
    obj.dapple.smoothing = "BOTH_WAYS"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert (classes_of(obj) == before).all()
    for frame in (1, 3, 6):
        bpy.context.scene.frame_set(frame)
        for one in (0, 1):
            assert variation(surface, scenes.positions(obj)[before == one]) < 0.06


def overlapping(surface, count=60):
    """A scatter whose instances are nearly the largest that do not overlap."""
    obj = with_classes(surface, {"weight": 1.0}, {"weight": 1.0}, count=count)
    for kind in obj.dapple.object_types:
        kind.radius = 0.24
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.report.worst_overlap > 0.0
    return obj


def worst_overlap(obj):
    points = scenes.positions(obj)
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(distance, np.inf)
    return 1.0 - distance.min() / (2.0 * obj.dapple.object_types[0].radius)


def test_the_worst_overlap_of_a_bake_is_that_of_all_frames():
    surface = scenes.tail(frames=4)
    for frame, size in ((1, 1.0), (2, 0.85), (4, 1.0)):  # the largest overlap is in the middle
        surface.scale = (size, size, size)
        surface.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_set(1)
    obj = overlapping(surface)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    found = []
    for frame in range(1, 5):
        bpy.context.scene.frame_set(frame)
        found.append(worst_overlap(obj))
    report = obj.dapple.report
    assert report.worst_overlap == pytest.approx(max(found), abs=1e-4)
    worst = 1 + int(np.argmax(found))
    assert 1 < worst < 4  # neither the first nor the last computed frame
    assert report.overlap_frame == worst
    assert bpy.ops.dapple.select_overlap() == {"FINISHED"}
    assert bpy.context.scene.frame_current == worst
    chosen = [vertex.index for vertex in obj.data.vertices if vertex.select]
    pair = scenes.positions(obj)[chosen]
    assert 1.0 - np.linalg.norm(pair[0] - pair[1]) / 0.48 == pytest.approx(max(found), abs=1e-4)
    assert np.allclose(bpy.context.scene.cursor.location, pair.mean(axis=0), atol=1e-4)


@pytest.mark.parametrize("attach_to", ["FACES", "REST"])
def test_an_overlap_is_selected_where_it_is_played(attach_to):
    surface = scenes.tail(frames=4)
    obj = overlapping(surface)
    obj.dapple.attach_to = attach_to
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    surface.location.x = 7.0
    bpy.context.scene.frame_set(4)
    assert bpy.ops.dapple.select_overlap() == {"FINISHED"}
    chosen = [vertex.index for vertex in obj.data.vertices if vertex.select]
    between = scenes.positions(obj)[chosen].mean(axis=0)
    assert np.allclose(bpy.context.scene.cursor.location, between, atol=1e-4)


def test_an_overlap_of_points_that_were_deleted_is_said_or_found_by_their_ids():
    obj = overlapping(scenes.sphere())
    report = obj.dapple.report
    pair = [report.overlap_first, report.overlap_second]
    ids = [one.value for one in obj.data.attributes["id"].data]

    def remove(id_):
        mesh = bmesh.new()
        mesh.from_mesh(obj.data)
        mesh.verts.ensure_lookup_table()
        layer = mesh.verts.layers.int["id"]
        mesh.verts.remove(next(vertex for vertex in mesh.verts if vertex[layer] == id_))
        mesh.to_mesh(obj.data)
        mesh.free()

    remove(next(one for one in ids if one not in pair))
    assert bpy.ops.dapple.select_overlap() == {"FINISHED"}
    chosen = [obj.data.attributes["id"].data[v.index].value for v in obj.data.vertices if v.select]
    assert sorted(chosen) == sorted(pair)
    remove(pair[1])
    with pytest.raises(RuntimeError, match=f"point {pair[1]} was removed: optimize the scatter"):
        bpy.ops.dapple.select_overlap()


def test_counts_of_classes_are_reported_for_points_per_area():
    labels = addon_host.part("blender.object_types.operators").count_labels
    obj = with_classes(scenes.sphere(), {"weight": 2.0}, {"weight": 1.0}, count=60)
    obj.dapple.amount, obj.dapple.points_per_area = "PER_AREA", 20.0
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    found = np.bincount(classes_of(obj))
    assert found.sum() > 200
    assert labels(obj) == [f"{count:,}" for count in found]
    obj.dapple.points_per_area = 7.3
    told = labels(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert labels(obj) == [f"{count:,}" for count in np.bincount(classes_of(obj))]
    assert told == [f"~{label}" for label in labels(obj)]
    obj.dapple.solved_from, obj.dapple.points_per_area = "", 8.0
    assert labels(obj) == ["?", "?"]


def test_counts_of_classes_are_those_of_the_points_that_are_there():
    labels = addon_host.part("blender.object_types.operators").count_labels
    obj = with_classes(scenes.sphere(), {"weight": 2.0}, {"weight": 1.0}, count=60)
    assert labels(obj) == ["40", "20"]
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    edited.verts.ensure_lookup_table()
    gone = [edited.verts[row] for row in np.flatnonzero(classes_of(obj) == 0)[:3]]
    bmesh.ops.delete(edited, geom=gone, context="VERTS")
    edited.to_mesh(obj.data)
    edited.free()
    assert labels(obj) == ["37", "20"]
    obj.dapple.object_types[1].weight = 2.0
    assert labels(obj) == ["~30", "~30"]
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    assert labels(obj) == ["~24", "~24", "~12"]
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert labels(obj) == ["24", "24", "12"]
