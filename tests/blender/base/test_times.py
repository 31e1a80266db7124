# SPDX-License-Identifier: GPL-3.0-or-later
"""Time Stretching: frames of the scene are other times of the animation."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def reason(obj):
    bpy.context.view_layer.update()
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def played(obj, frames):
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(int(frame), subframe=frame % 1)
        assert reason(obj) == ""
        found.append(scenes.positions(obj))
    return np.array(found)


def stretched(old, new):
    render = bpy.context.scene.render
    render.frame_map_old, render.frame_map_new = old, new


@pytest.fixture
def baked():
    """A baked scatter, and its places at the times 1 to 4 in steps of a half."""
    obj = scenes.scattered(scenes.tail(frames=4))
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj, played(obj, np.arange(1.0, 4.1, 0.5))


@pytest.mark.parametrize("again", [False, True])
def test_a_bake_plays_the_keys_of_the_time_that_is_shown(baked, again):
    obj, expected = baked
    stretched(100, 200)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 2, 8
    if again:
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert (obj.dapple.baked_start, obj.dapple.baked_frames) == (1, 4)
    assert np.abs(played(obj, np.arange(2.0, 8.1)) - expected).max() < 1e-5


def test_a_compressed_time_is_baked_whole(baked):
    obj, expected = baked
    stretched(200, 100)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 2
    assert reason(obj) == ""
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert (obj.dapple.baked_start, obj.dapple.baked_frames) == (2, 3)
    bpy.context.scene.frame_set(1)
    fit = scenes.positions(obj)
    assert fit.shape == expected[0].shape
    assert played(obj, (1.0, 1.5, 2.0)).shape == (3, 60, 3)


def test_times_beyond_the_bake_are_said(baked):
    obj, _ = baked
    stretched(100, 200)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 2, 10
    assert reason(obj) == "Frames 1 to 4 are baked, the scene has 1 to 5: bake again"
