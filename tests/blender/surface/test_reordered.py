# SPDX-License-Identifier: GPL-3.0-or-later
"""Modifiers that order the same faces otherwise from one evaluation to the next lose no bake."""

from dataclasses import replace

import addon_host
import bpy
import numpy as np
import pytest
import scenes

FRAMES = 4


def other_order(arrays):
    """The same faces, the other way around."""
    return replace(
        arrays,
        faces=np.ascontiguousarray(arrays.faces[::-1]),
        loops=np.ascontiguousarray(arrays.face_corners[::-1]),
        topology=arrays.topology[::-1],
    )


@pytest.fixture
def reordering(monkeypatch):
    """Let marked evaluations return vertices in another order."""
    reading = addon_host.part("blender.surface.reading")
    steps, count = reading.read_steps, [0]

    def start(which):
        def reordered(*args, **options):
            arrays = yield from steps(*args, **options)
            count[0] += 1
            return other_order(arrays) if which(count[0]) else arrays

        monkeypatch.setattr(reading, "read_steps", reordered)

    return start


def keys_of(obj):
    return addon_host.part("blender.scatter.key_stores").read_baked(obj).keys


def test_a_bake_goes_on_where_an_evaluation_orders_faces_otherwise(reordering):
    obj = scenes.scattered(scenes.tail(frames=FRAMES))
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    before = keys_of(obj)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    reordering(lambda count: count % 3 == 1)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for name, values in keys_of(obj).items():
        assert values.tobytes() == before[name].tobytes()


def test_a_finished_bake_is_written_though_its_first_frame_is_ordered_otherwise_now(reordering):
    obj = scenes.scattered(scenes.tail(frames=FRAMES))
    reordering(lambda count: count > FRAMES + 2)  # all frames and the search for motion
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.baked_frames == FRAMES


def finished(going, change):
    """The end of a bake whose surface is changed after its first step."""
    package = addon_host.part("core.base.native").package()
    task = next(going)
    change()
    try:
        while True:
            task = going.send(task.call(package.Context()))
    except StopIteration as end:
        return end.value


def test_a_surface_that_was_changed_while_it_was_baked_is_no_such_one():
    surface = scenes.tail(frames=FRAMES)
    scenes.scattered(surface)
    going = addon_host.part("blender.bake.steps").bake_steps(bpy.context, 1, FRAMES)

    def change():
        surface.data.vertices[3].co.x += 0.2
        surface.data.update_tag()

    with pytest.raises(addon_host.part("core.base.errors").ScatterError, match="changed while"):
        finished(going, change)
