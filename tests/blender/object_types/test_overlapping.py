# SPDX-License-Identifier: GPL-3.0-or-later
"""Select Overlapping Instances: by boxes and convex hulls, of what is rendered."""

from itertools import combinations

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from scipy.optimize import linprog

overlapping = addon_host.part("blender.object_types.overlapping")
shapes = addon_host.part("blender.scatter.instance_shapes")
Placed = addon_host.part("core.export").Placed


def select(obj, **options):
    """Ids of the points that the operator selects."""
    scenes.activate(obj)
    assert bpy.ops.dapple.select_overlapping(**options) == {"FINISHED"}
    chosen = [vertex.index for vertex in obj.data.vertices if vertex.select]
    return {obj.data.attributes["id"].data[k].value for k in chosen}


def shown(obj):
    """Corners (k, 3) in world space of the instances by id, from the scene itself."""
    found = {}
    for one in bpy.context.evaluated_depsgraph_get().object_instances:
        if not one.is_instance or one.parent is None or one.parent.original != obj:
            continue
        number = next(n for n in reversed(one.persistent_id) if n != 2**31 - 1)
        corners = np.array([one.matrix_world @ v.co for v in one.object.data.vertices])
        found.setdefault(number, []).append(corners)
    return found


def are_apart(first, second):
    """Whether a plane separates two sets of points, by linear programming."""
    rows = [np.column_stack([first, -np.ones(len(first))])]
    rows += [np.column_stack([-second, np.ones(len(second))])]
    matrix = np.vstack(rows)
    tried = linprog(np.zeros(4), A_ub=matrix, b_ub=-np.ones(len(matrix)), bounds=[(None, None)] * 4)
    return tried.status == 0


def expected(obj):
    parts = shown(obj)
    pairs = [
        (one, other)
        for one, other in combinations(parts, 2)
        if not all(are_apart(a, b) for a in parts[one] for b in parts[other])
    ]
    return {number for pair in pairs for number in pair}


def with_instances(make, count=60, scale=0.1, **settings):
    surface = scenes.sphere()
    make()
    thing = bpy.context.object
    thing.location = (0, 0, 50)
    obj = scenes.scattered(surface, count=count)
    obj.dapple.instance, obj.dapple.scale = thing, scale
    obj.dapple.random_tilt, obj.dapple.random_scale_down = 0.6, 0.5
    for name, value in settings.items():
        setattr(obj.dapple, name, value)
    return obj


def cones():
    bpy.ops.mesh.primitive_cone_add(vertices=7)


def cubes():
    bpy.ops.mesh.primitive_cube_add()


@pytest.mark.parametrize(("make", "scale"), [(cubes, 0.16), (cones, 0.22)])
def test_hulls_overlap_where_no_plane_separates_them(make, scale):
    obj = with_instances(make, scale=scale)
    found = select(obj, shape="HULL")
    assert found == expected(obj)
    assert 0 < len(found) < 60


def test_boxes_of_boxes_are_their_hulls_and_boxes_of_cones_are_larger():
    obj = with_instances(cubes, scale=0.16)
    assert select(obj, shape="BOX") == select(obj, shape="HULL")
    obj = with_instances(cones, scale=0.22)
    assert select(obj, shape="BOX") > select(obj, shape="HULL")


def test_a_mirrored_and_sheared_instance_is_as_any_other():
    obj = with_instances(cones, scale=0.2, scale_x=-1.0, scale_z=1.7)
    assert select(obj) == expected(obj) != set()


def test_nothing_overlaps_is_said_and_clears_the_selection(capfd):
    obj = with_instances(cubes, scale=0.01)
    for vertex in obj.data.vertices:
        vertex.select = True
    assert select(obj) == set()
    assert "0 of 60 instances overlap" in capfd.readouterr().out


def test_parts_of_a_collection_are_one_instance():
    group = bpy.data.collections.new("Pair")
    for x in (0.0, 0.4):
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=(x, 0, 0))
        group.objects.link(bpy.context.object)
    obj = scenes.scattered(scenes.sphere(), count=20)
    obj.dapple.collection, obj.dapple.scale = group, 0.05
    assert select(obj) == set()
    obj.dapple.scale = 0.8
    assert select(obj) == expected(obj) != set()


def test_what_the_viewport_leaves_out_counts():
    obj = with_instances(cubes, scale=0.16)
    found = select(obj)
    obj.dapple.display_as, obj.dapple.viewport_share = "POINTS", 0.1
    assert select(obj) == found
    assert (obj.dapple.display_as, round(obj.dapple.viewport_share, 6)) == ("POINTS", 0.1)
    assert not [mesh.name for mesh in bpy.data.meshes if mesh.name.startswith("Cube.0")]


def test_a_bake_counts_on_its_frame():
    surface = scenes.tail(frames=4, levels=0, render_levels=0)
    cubes()
    thing = bpy.context.object
    obj = scenes.scattered(surface, count=60)
    obj.dapple.instance, obj.dapple.scale = thing, 0.13
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 4):
        bpy.context.scene.frame_set(frame)
        assert select(obj) == expected(obj)


def pairs_of(matrices, ids=None):
    rows = np.arange(len(matrices))
    frame = Placed(np.array(matrices), rows if ids is None else ids, 0 * rows, 0 * rows)
    placed = shapes.placed_shapes(frame, [shapes.BOX_CORNERS])
    return {tuple(pair) for pair in overlapping.overlapping_pairs(placed).tolist()}


def moved(*place, scale=1.0):
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = place
    return matrix


def test_what_touches_does_not_overlap_and_what_is_inside_does():
    assert pairs_of([moved(0, 0, 0), moved(1, 0, 0), moved(0, 1, 1)]) == set()
    assert pairs_of([moved(0, 0, 0), moved(0.999, 0, 0)]) == {(0, 1)}
    assert pairs_of([moved(0, 0, 0), moved(0.4, 0.4, 0.4, scale=0.1)]) == {(0, 1)}
    assert pairs_of([moved(0, 0, 0), moved(0.5, 0, 0)], np.array([7, 7])) == set()


def test_flat_and_empty_instances():
    obj = with_instances(lambda: bpy.ops.mesh.primitive_plane_add(), scale=0.3)
    assert select(obj, shape="HULL") == expected(obj) != set()
    empty = bpy.data.objects.new("Nothing", bpy.data.meshes.new("Nothing"))
    bpy.context.scene.collection.objects.link(empty)
    obj.dapple.instance = empty
    assert select(obj) == set()


def test_a_scatter_without_instances_is_refused():
    obj = with_instances(cubes)
    obj.hide_set(True)
    with pytest.raises(RuntimeError, match="shows no instances: it is hidden"):
        bpy.ops.dapple.select_overlapping()
