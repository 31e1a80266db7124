# SPDX-License-Identifier: GPL-3.0-or-later
"""Discs of object types do not overlap on any frame of parts that move into each other."""

import addon_host
import bpy
import pytest
from stopped_bakes import stop_after
from test_outside_over_time import FRAMES, moving_balls


def mixed():
    """Three object types on two balls."""
    moving_balls()
    assert bpy.ops.dapple.add_scatter(count=300) == {"FINISHED"}
    obj = bpy.context.object
    for count, radius in ((15, 0.25), (60, 0.1), (0, 0.0)):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        kind = obj.dapple.object_types[-1]
        kind.use_count, kind.count, kind.radius = count > 0, max(count, 1), radius
    return obj


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("smoothing", "FORWARD"),
        ("smoothing", "BOTH_WAYS"),
        ("smoothing", "LOOP"),
        ("population", "KEEP_DENSITY"),
    ],
)
def test_discs_stay_apart_where_parts_meet(name, value):
    obj = mixed()
    setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.report.worst_overlap < 0.01


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_a_stopped_bake_of_discs_goes_on_to_the_same_bytes(population):
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    obj = mixed()
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    obj.dapple.population = population
    found = []
    for stopped in (True, False):
        if stopped:
            stop_after(6, FRAMES)
        baker = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
        assert (baker.taken > 0) == stopped
        found.append(addon_host.part("blender.scatter.key_stores").read_baked(obj).keys)
        assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    for key, values in found[0].items():
        assert found[1][key].tobytes() == values.tobytes()
