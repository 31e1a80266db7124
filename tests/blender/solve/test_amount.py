# SPDX-License-Identifier: GPL-3.0-or-later
"""Number and regularity of points: points per area, presets of quality."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def plane(size=2.0):
    bpy.ops.mesh.primitive_grid_add(size=size, x_subdivisions=10, y_subdivisions=10)
    return bpy.context.object


def per_area(obj, points):
    obj.dapple.amount, obj.dapple.points_per_area = "PER_AREA", points
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj.dapple.report.count


def test_points_per_area_count_the_world_area():
    surface = plane(2.0)
    obj = scenes.scattered(surface, count=10)
    assert per_area(obj, 50.0) == 200
    surface.scale = (2.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    assert per_area(obj, 50.0) == 400
    assert len(scenes.positions(obj)) == 400


def test_points_per_area_follow_the_density():
    surface = plane(2.0)
    group = surface.vertex_groups.new(name="Half")
    group.add([v.index for v in surface.data.vertices], 0.5, "REPLACE")
    obj = scenes.scattered(surface, count=10)
    obj.dapple.density.attribute = "Half"
    assert per_area(obj, 50.0) == 100


def test_at_least_one_point_and_not_too_many():
    obj = scenes.scattered(plane(2.0), count=10)
    assert per_area(obj, 0.001) == 1
    obj.dapple.points_per_area = 1e9
    with pytest.raises(RuntimeError, match="4,000,000,000 points on this surface: at most"):
        bpy.ops.dapple.optimize()
    assert len(scenes.positions(obj)) == 1


def test_classes_share_the_points_per_area():
    obj = scenes.scattered(plane(2.0), count=10)
    for share in (3.0, 1.0):
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].weight = share
    assert per_area(obj, 25.0) == 100
    meshio = addon_host.part("blender.base.mesh_arrays")
    kinds = meshio.read_columns(obj.data, {"dapple_object_type": "INT"})["dapple_object_type"]
    assert np.bincount(kinds).tolist() == [75, 25]


def order_of_neighbors(points):
    """psi6 of points in the plane z = 0, away from the border: 1 for hexagons."""
    found = []
    for p in points[np.abs(points[:, :2]).max(axis=1) < 0.75]:
        way = points - p
        nearest = np.argsort(np.linalg.norm(way, axis=1))[1:7]
        angle = np.arctan2(way[nearest, 1], way[nearest, 0])
        found.append(abs(np.exp(6j * angle).mean()))
    return float(np.mean(found))


def test_qualities_go_from_natural_to_honeycomb():
    obj = scenes.scattered(plane(2.0), count=400)
    orders = {}
    for name in ("NATURAL", "REGULAR", "HONEYCOMB"):
        obj.dapple.quality = name
        bpy.ops.dapple.optimize()
        orders[name] = order_of_neighbors(scenes.positions(obj))
    assert orders["NATURAL"] + 0.1 < orders["REGULAR"] < orders["HONEYCOMB"]


def test_natural_is_the_default_and_draft_takes_fewer_steps():
    obj = scenes.scattered(plane(2.0), count=400)
    natural = obj.dapple.report.evaluations
    reason = addon_host.part("blender.scatter.object").settings_reason
    obj.dapple.quality = "NATURAL"
    assert reason(obj) == ""
    obj.dapple.quality = "DRAFT"
    assert "Tolerance" in reason(obj)
    bpy.ops.dapple.optimize()
    assert obj.dapple.report.evaluations < natural
    assert math.isclose(obj.dapple.tolerance, 5e-4, rel_tol=1e-5)


def test_quality_shows_which_one_the_settings_are():
    obj = scenes.scattered(plane(2.0), count=40)
    assert obj.dapple.quality == "NATURAL"
    for name in ("DRAFT", "FINE", "REGULAR", "HONEYCOMB", "NATURAL"):
        obj.dapple.quality = name
        assert obj.dapple.quality == name
    obj.dapple.tolerance = 3e-5
    assert obj.dapple.quality == "CUSTOM"
    obj.dapple.quality = "CUSTOM"
    assert math.isclose(obj.dapple.tolerance, 3e-5, rel_tol=1e-5), "it stays as it is"
    obj.dapple.quality = "REGULAR"
    assert obj.dapple.max_evaluations == 400
