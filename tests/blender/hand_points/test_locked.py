# SPDX-License-Identifier: GPL-3.0-or-later
"""Locked and hand-placed points."""

import bpy
import numpy as np
import pytest
import scenes


def column(obj, name, kind=np.int32):
    values = np.empty(len(obj.data.vertices), dtype=kind)
    obj.data.attributes[name].data.foreach_get("value", values)
    return values


def select(obj, rows):
    chosen = np.zeros(len(obj.data.vertices), dtype=bool)
    chosen[rows] = True
    obj.data.vertices.foreach_set("select", chosen)


def test_locked_points_stay_while_others_are_spread_anew():
    obj = scenes.scattered(scenes.sphere(), count=200)
    kept = scenes.positions(obj)[[3, 50, 120]]
    select(obj, [3, 50, 120])
    assert bpy.ops.dapple.lock_points() == {"FINISHED"}
    obj.dapple.seed, obj.dapple.count = 9, 300
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    found, ids = scenes.positions(obj), column(obj, "id")
    for place, one in zip(kept, (3, 50, 120), strict=True):
        np.testing.assert_allclose(found[ids == one], [place], atol=1e-5)
    assert sorted(ids) == list(range(300))
    assert column(obj, "dapple_locked", np.bool_).sum() == 3
    assert obj.dapple.locked_count == 3
    assert obj.dapple.report.capacity_variation < 0.02


def test_a_point_keeps_its_variation_when_others_are_locked():
    obj = scenes.scattered(scenes.sphere(), count=100)
    turn = dict(zip(column(obj, "id"), column(obj, "dapple_turn", np.float32), strict=True))
    select(obj, [70])
    bpy.ops.dapple.lock_points()
    bpy.ops.dapple.optimize()
    again = dict(zip(column(obj, "id"), column(obj, "dapple_turn", np.float32), strict=True))
    assert again == turn


def test_points_are_placed_by_hand_in_edit_mode():
    """Added, moved and locked there; they come down on the surface."""
    obj = scenes.scattered(scenes.sphere(), count=100)
    obj.data.vertices.add(2)
    obj.data.vertices[100].co, obj.data.vertices[101].co = (0, 0, 1.2), (0.1, 0, 1.1)
    select(obj, [100, 101])
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.dapple.lock_points() == {"FINISHED"}
    assert obj.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    found = scenes.positions(obj)[column(obj, "dapple_locked", np.bool_)]
    assert len(scenes.positions(obj)) == 100
    assert len(set(column(obj, "id"))) == 100
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=0.03)
    assert np.abs(found[:, :2] - [[0, 0], [0.09, 0]]).max() < 0.03


def test_locked_points_stay_in_their_classes():
    obj = scenes.scattered(scenes.sphere(), count=200)
    bpy.ops.dapple.edit_object_types(action="ADD")
    bpy.ops.dapple.edit_object_types(action="ADD")
    bpy.ops.dapple.optimize()
    rows = np.flatnonzero(column(obj, "dapple_object_type") == 1)[:5]
    kept = scenes.positions(obj)[rows]
    select(obj, rows)
    bpy.ops.dapple.lock_points()
    obj.dapple.seed = 4
    bpy.ops.dapple.optimize()
    locked = column(obj, "dapple_locked", np.bool_)
    assert (column(obj, "dapple_object_type")[locked] == 1).all()
    np.testing.assert_allclose(scenes.positions(obj)[locked], kept, atol=1e-5)


def test_unlocking_and_too_many_are_reported():
    obj = scenes.scattered(scenes.sphere(), count=50)
    select(obj, [])
    with pytest.raises(RuntimeError, match="no point is selected"):
        bpy.ops.dapple.lock_points()
    bpy.ops.dapple.lock_points(every=True)
    obj.dapple.count = 20
    before = scenes.positions(obj)
    with pytest.raises(RuntimeError, match="50 points are locked, the count is 20"):
        bpy.ops.dapple.optimize()
    np.testing.assert_array_equal(scenes.positions(obj), before)
    bpy.ops.dapple.lock_points(lock=False, every=True)
    assert obj.dapple.locked_count == 0
    assert bpy.ops.dapple.optimize() == {"FINISHED"}


def test_a_bake_takes_locked_points_along():
    obj = scenes.scattered(scenes.tail(), count=60)
    select(obj, [1, 2])
    bpy.ops.dapple.lock_points()
    bpy.ops.dapple.optimize()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.ops.dapple.clear_bake()
    assert column(obj, "dapple_locked", np.bool_).sum() == 2
