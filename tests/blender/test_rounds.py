# SPDX-License-Identifier: GPL-3.0-or-later
"""Random rounds of strokes, settings, renders, bakes, files, undo and redo with Auto Update on.

DAPPLE_ROUNDS says how many, DAPPLE_SEEDS how often they begin anew; a few by default.
"""

import os
import random

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from edits import EDITS, MORE_LOCKED, done, optimize, prepared, redo, scatter, undo

pytestmark = pytest.mark.empty_file  # the node groups are built here

ROUNDS = int(os.environ.get("DAPPLE_ROUNDS", "12"))
SEEDS = int(os.environ.get("DAPPLE_SEEDS", "2"))


def reopen(live, path, settled):
    """Save and open the file; a result that was not up to date stays so."""
    if settled:
        live.settle()
    assert bpy.ops.wm.save_as_mainfile(filepath=str(path)) == {"FINISHED"}
    assert bpy.ops.wm.open_mainfile(filepath=str(path)) == {"FINISHED"}
    if settled:
        check(live)
    else:
        optimize(None)


def check(live):
    """Nothing is out of date, and every point that is counted is there, once, on the surface.

    A bake that an undo has brought back waits for the artist instead, and so does a count that is
    smaller than the number of locked points.
    """
    obj = scatter()
    trouble = live.watcher.trouble(obj)
    assert not trouble or MORE_LOCKED in trouble
    reason = addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)
    waits = obj.dapple.baked_keys and reason.endswith("bake again")
    if reason and not waits and not done(bpy.ops.dapple.optimize):
        return
    assert not reason or waits, reason
    ids = addon_host.part("blender.scatter.points").point_columns_of(obj)["id"]
    found = scenes.positions(obj)
    assert len(ids) == len(np.unique(ids)) == obj.dapple.report.count
    assert len(found) == len(ids) or waits  # points of a removed object type are not shown
    if obj.dapple.amount == "COUNT" and not reason:
        assert len(found) == obj.dapple.count
    assert np.isfinite(found).all()
    assert obj.dapple.report.measured
    assert waits or not scenes.node_warnings(obj)


@pytest.mark.parametrize("seed", range(SEEDS))
def test_after_whatever_the_points_are_those_of_what_is_there(live, seed, tmp_path):
    chance = random.Random(seed)
    prepared()
    bpy.ops.ed.undo_push(message="Prepared")
    live.settle()
    for number in range(ROUNDS):
        for _ in range(chance.randrange(1, 4)):
            change = chance.choice(EDITS)
            change(chance)
            bpy.ops.ed.undo_push(message=f"{number} {change.__name__}")
            for _ in range(chance.randrange(30)):  # an update may be running
                live.look()
                live.clock.now += 0.1
        if chance.random() < 0.15:
            reopen(live, tmp_path / "saved.blend", chance.random() < 0.5)
        for _ in range(chance.randrange(3)):
            chance.choice([undo, undo, redo])(chance)
            if chance.random() < 0.5:
                live.look()
        live.settle()
        check(live)
