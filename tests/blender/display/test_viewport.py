# SPDX-License-Identifier: GPL-3.0-or-later
"""A share of the points in the viewport, evenly spread; all of them in a render."""

import bpy
import numpy as np
import pytest
import scenes


def spacing(points, area):
    """Mean distance to the nearest, as a share of the best possible."""
    apart = np.linalg.norm(points[:, None] - points, axis=2) + np.diag(np.full(len(points), np.inf))
    return apart.min(axis=1).mean() / np.sqrt(2 * area / (np.sqrt(3) * len(points)))


@pytest.mark.parametrize("share", [0.5, 0.2])
def test_the_viewport_shows_an_even_share(share):
    obj = scenes.scattered(scenes.sphere(), count=400)
    assert len(scenes.instance_matrices(obj)) == 400
    obj.dapple.viewport_share = share
    places = scenes.instance_matrices(obj)[:, :3, 3]
    assert len(places) == pytest.approx(400 * share, abs=1)
    assert spacing(places, 4 * np.pi) > 0.65  # a random subset: 0.5
    obj.dapple.viewport_share = 0.0
    assert len(scenes.instance_matrices(obj)) == 0


def test_classes_keep_their_shares():
    obj = scenes.scattered(scenes.sphere(), count=200)
    for share in (3.0, 1.0):
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].weight = share
    bpy.ops.dapple.optimize()
    ranks, classes = (np.empty(200, dtype=kind) for kind in (np.float32, np.int32))
    obj.data.attributes["dapple_rank"].data.foreach_get("value", ranks)
    obj.data.attributes["dapple_object_type"].data.foreach_get("value", classes)
    assert (classes[ranks < 0.4] == 1).sum() == pytest.approx(20, abs=1)
    obj.dapple.viewport_share = 0.4
    assert len(scenes.instance_matrices(obj)) == pytest.approx(80, abs=1)


def test_a_bake_plays_its_share():
    obj = scenes.scattered(scenes.tail(frames=3), count=100)
    bpy.ops.dapple.bake()
    obj.dapple.viewport_share = 0.3
    for frame in (1, 3):
        bpy.context.scene.frame_set(frame)
        assert len(scenes.instance_matrices(obj)) == pytest.approx(30, abs=1)
