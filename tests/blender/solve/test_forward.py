# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances that point along an axis of the surface."""

import math

import bpy
import numpy as np
import pytest
import scenes


def pointed(surface, forward, attach_to="FACES"):
    obj = scenes.scattered(surface, count=80)
    obj.dapple.forward, obj.dapple.random_turn, obj.dapple.attach_to = forward, 0.0, attach_to
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def axes(obj):
    """Unit X and Z axes of the instances."""
    matrices = scenes.instance_matrices(obj)[:, :3, :3]
    found = matrices / np.linalg.norm(matrices, axis=1, keepdims=True)
    return found[:, :, 0], found[:, :, 2]


def expect_along(ahead, normal, axis):
    """As far along the axis as the surface lets it."""
    along = np.asarray(axis) - (normal @ axis)[:, None] * normal
    length = np.linalg.norm(along, axis=1)
    clear = length > 0.2
    cosines = (ahead * along).sum(axis=1)[clear] / length[clear]
    assert clear.sum() > 60
    assert cosines.min() > 0.999  # the normals of the nodes differ slightly from ours


@pytest.mark.parametrize(("forward", "axis"), [("X", (1, 0, 0)), ("-Z", (0, 0, -1))])
def test_things_point_along_an_axis(forward, axis):
    expect_along(*axes(pointed(scenes.sphere(), forward)), np.array(axis, dtype=float))


def test_the_axis_is_that_of_the_surface_object():
    surface = scenes.sphere(rotation=(0, 0, math.radians(90)))
    expect_along(*axes(pointed(surface, "X")), np.array([0.0, 1.0, 0.0]))


def test_things_bound_to_the_rest_position_point_there_too():
    expect_along(*axes(pointed(scenes.sphere(), "Y", "REST")), np.array([0.0, 1.0, 0.0]))


def test_they_turn_with_the_surface_in_a_bake():
    obj = pointed(scenes.tail(), "Z")
    ahead, _ = axes(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(1)
    first, _ = axes(obj)
    assert (ahead * first).sum(axis=1).min() > 0.99
    bpy.context.scene.frame_set(6)
    last, normal = axes(obj)
    assert np.abs((last * normal).sum(axis=1)).max() < 1e-5
    tip = scenes.instance_matrices(obj)[:, 2, 3] > 3.0
    assert (last[:, 2] > 0.0).mean() > 0.9, "all still point toward the tip"
    assert last[tip, 1].std() < 0.5
