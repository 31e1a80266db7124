# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a real window, which stays responsive. test_window.py runs this; exit status 0 is
success.
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import addon_host
import scenes
import story

TICK = 0.05
PATIENCE = 600  # most ticks


def events():
    """Add, bake, cancel a bake and an optimization, as an artist would."""
    bpy.context.preferences.edit.use_global_undo = True
    surface = scenes.tail()
    surface_name = surface.name
    obj = yield from added(surface)
    assert len(scenes.positions(obj)) == 200
    yield from until_idle(bpy.ops.dapple.bake)
    assert obj.dapple.baked_keys == 6
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    bpy.context.scene.frame_set(3)
    bpy.context.scene.frame_end = 5_000  # far more frames than there is time for
    before = scenes.snapshot()
    yield from until_idle(bpy.ops.dapple.bake, escape_after=3)
    assert scenes.snapshot() == before
    assert obj.dapple.baked_keys == 0
    obj.dapple.tolerance, obj.dapple.max_evaluations, obj.dapple.count = 1e-9, 100_000, 50_000
    yield from until_optimized(escape_after=3)
    assert scenes.snapshot() == before
    obj.dapple.count, obj.dapple.max_evaluations = 120, 200
    yield from until_optimized()
    assert len(scenes.positions(obj)) == 120
    yield from undone(obj.name)
    yield from refused(bpy.data.objects[surface_name])


def added(surface):
    bpy.context.view_layer.objects.active = surface
    yield from until_idle(bpy.ops.dapple.add_scatter, count=200)
    assert bpy.context.object is not surface
    return bpy.context.object


def until_optimized(escape_after=None):
    """Press Optimize, which returns at once, and wait until the work is done."""
    live = addon_host.part("blender.solve.auto_update")
    yield from until(bpy.ops.dapple.optimize, live.is_active, escape_after)


def until_idle(operator, escape_after=None, **options):
    """Press a button of long work, which returns at once, and wait until the work is done."""
    work = addon_host.part("blender.base.operator_jobs")
    yield from until(operator, lambda: work.current() is not None, escape_after, **options)


def until(operator, goes_on, escape_after, **options):
    window = bpy.context.window_manager.windows[0]
    area = next(one for one in window.screen.areas if one.type == "VIEW_3D")
    region = next(one for one in area.regions if one.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        assert operator("INVOKE_DEFAULT", **options) == {"CANCELLED"}
    place = {"x": area.x + 300, "y": area.y + 200}
    for tick in range(PATIENCE):
        assert not window.modal_operators
        if not goes_on():
            return
        if tick == escape_after:
            window.event_simulate("MOUSEMOVE", "NOTHING", **place)
            yield
            for value in ("PRESS", "RELEASE"):
                window.event_simulate("ESC", value, **place)
        area.spaces.active.region_3d.view_distance += 0.01  # continues to orbit and zoom
        yield
    raise TimeoutError(f"{operator} is still running")


def undone(name):
    """Undo; all that was written is a single step."""
    window = bpy.context.window_manager.windows[0]
    for undo, count in ((bpy.ops.ed.undo, 200), (bpy.ops.ed.redo, 120)):
        with bpy.context.temp_override(window=window):
            undo()
        yield
        assert len(bpy.data.objects[name].data.vertices) == count


def refused(surface):
    """An error during the work is shown in the panel: the topology changes in the frame range."""
    bpy.context.scene.frame_end = 6
    modifier = surface.modifiers["Subdivision"]
    for level, frame in ((1, 3), (2, 4)):
        modifier.levels = modifier.render_levels = level
        modifier.keyframe_insert("levels", frame=frame)
        modifier.keyframe_insert("render_levels", frame=frame)
    bpy.context.scene.frame_set(2)
    before = scenes.snapshot()
    yield from until_idle(bpy.ops.dapple.bake)
    assert scenes.snapshot() == before
    ((kind, text),) = addon_host.part("blender.base.operator_jobs").notes(bpy.context.object)
    assert kind == "ERROR"
    assert "changes its topology" in text


story.begin(events, TICK)
