# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update in a real window. test_window.py runs this; exit status 0 is success.

Each step of `events` yields until Blender's event loop has gone on. DAPPLE_SHOTS may name a folder
for screenshots.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import addon_host
import scenes
import story

TICK = 0.05
PATIENCE = 60.0  # seconds
SHOTS = os.environ.get("DAPPLE_SHOTS")


def events():
    """A slider, an undo, a brush stroke, and Esc while it takes long."""
    bpy.context.preferences.edit.use_global_undo = True
    surface = scenes.sphere()
    subdivision = surface.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = subdivision.render_levels = 2
    yield from waited(panel_is_open)
    surface.name = "Ground"
    bpy.context.view_layer.objects.active = surface
    with window():
        assert bpy.ops.dapple.add_scatter("INVOKE_DEFAULT", count=300) == {"CANCELLED"}
    yield from waited(lambda: has_points(300))
    bpy.context.object.dapple.auto_update_mode = "ON"
    yield from slider()
    yield from stroke(surface)
    yield from optimized_while_moving()
    yield from escape()


def slider():
    """The value is changed again and again, as a slider does; at the end the points are there."""
    undo_push("Before")
    for count in range(310, 401, 10):
        scatter().dapple.count = count
        yield
    undo_push("Count")
    yield from waited(lambda: fits(400))
    yield from shot("live-slider")
    with window():
        bpy.ops.ed.undo()
    assert scatter().dapple.count == 300
    yield from waited(lambda: fits(300))
    with window():
        bpy.ops.ed.redo()
    yield from waited(lambda: fits(400))


def stroke(surface):
    group = surface.vertex_groups.new(name="Grass")
    group.add(range(len(surface.data.vertices)), 1.0, "REPLACE")
    scatter().dapple.density.attribute = "Grass"
    yield from waited(lambda: fits(400))
    bpy.context.view_layer.objects.active = surface
    with window():
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    yield
    for first in range(0, 120, 20):  # the stroke is scripted, because not every Blender has brushes
        group.add(range(first, first + 20), 0.0, "REPLACE")
        surface.data.update()
        yield
    undo_push("Weight Paint")
    before = scenes.positions(scatter())
    yield from waited(lambda: not fits(400))
    yield from waited(lambda: fits(400))
    yield from shot("live-stroke")
    assert not np.array_equal(scenes.positions(scatter()), before)
    assert bpy.context.mode == "PAINT_WEIGHT"
    with window():
        bpy.ops.object.mode_set(mode="OBJECT")
    yield


def optimized_while_moving():
    """Optimize is pressed and an object moved: the points come once that has ended."""
    live = addon_host.part("blender.solve.auto_update")
    scatter().dapple.auto_update_mode = "OFF"
    scatter().dapple.count = 350
    bpy.context.view_layer.objects.active = scatter()
    undo_push("Count")
    bpy.ops.object.empty_add(location=(5.0, 0.0, 0.0))
    empty = bpy.context.object.name
    undo_push("Empty")
    with window():
        bpy.context.view_layer.objects.active = scatter()
        assert bpy.ops.dapple.optimize("INVOKE_DEFAULT") == {"CANCELLED"}
        assert bpy.ops.transform.translate("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    for _ in range(40):
        yield
    assert live.is_requested(scatter())
    assert len(scatter().data.vertices) == 400
    click("RET")
    yield from waited(lambda: not the_window().modal_operators)
    yield from waited(lambda: fits(350))
    yield from shot("live-optimized")
    with window():
        bpy.ops.ed.undo()
    assert len(scatter().data.vertices) == 400
    assert empty in bpy.data.objects
    with window():
        bpy.ops.ed.redo()
    assert fits(350)
    scatter().dapple.count = 400
    scatter().dapple.auto_update_mode = "ON"
    yield from waited(lambda: fits(400))


def click(key):
    """Press a key over the 3D View."""
    area = next(one for one in the_window().screen.areas if one.type == "VIEW_3D")
    for value in ("PRESS", "RELEASE"):
        the_window().event_simulate(key, value, x=area.x + 300, y=area.y + 200)


def escape():
    obj = scatter()
    bpy.context.view_layer.objects.active = obj
    before = [tuple(vertex.co) for vertex in obj.data.vertices]
    obj.dapple.count, obj.dapple.tolerance, obj.dapple.max_evaluations = 60_000, 1e-9, 100_000
    live = addon_host.part("blender.solve.auto_update")
    yield from waited(lambda: live.is_solving() and live.progress(obj) > 0.0)
    assert not the_window().modal_operators  # no operator captures the mouse
    yield from shot("live-progress")
    area = next(one for one in the_window().screen.areas if one.type == "VIEW_3D")
    the_window().event_simulate("MOUSEMOVE", "NOTHING", x=area.x + 300, y=area.y + 200)
    yield
    for value in ("PRESS", "RELEASE"):
        the_window().event_simulate("ESC", value, x=area.x + 300, y=area.y + 200)
    yield from waited(lambda: not live.is_active())
    assert [tuple(vertex.co) for vertex in obj.data.vertices] == before
    yield from waited(lambda: not fits(400))
    yield from shot("live-canceled")


def scatter():
    """Looked up anew: an undo leaves references dangling."""
    return bpy.data.objects["Ground Scatter"]


def has_points(count):
    return any(len(obj.data.vertices) == count for obj in bpy.data.objects if obj.dapple.surface)


def fits(count):
    """Whether there is this number of points, and they are up to date."""
    live, obj = addon_host.part("blender.solve.auto_update"), scatter()
    if live.is_active() or len(obj.data.vertices) != count:
        return False
    return not addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def panel_is_open():
    for area in the_window().screen.areas:
        if area.type == "VIEW_3D":
            area.spaces.active.show_region_ui = True
            for region in area.regions:
                if region.type == "UI" and hasattr(region, "active_panel_category"):
                    try:
                        region.active_panel_category = "Dapple"
                    except (AttributeError, TypeError):
                        return False
    return True


def undo_push(message):
    with window():
        bpy.ops.ed.undo_push(message=message)


def window():
    area = next(one for one in the_window().screen.areas if one.type == "VIEW_3D")
    region = next(one for one in area.regions if one.type == "WINDOW")
    return bpy.context.temp_override(window=the_window(), area=area, region=region)


def the_window():
    return bpy.context.window_manager.windows[0]


def waited(done):
    end = time.monotonic() + PATIENCE
    while not done():
        assert time.monotonic() < end
        yield


def shot(name):
    for _ in range(20):
        yield
    if SHOTS:
        subprocess.run(["import", "-window", "root", f"{SHOTS}/{name}.png"], check=True)


story.begin(events, TICK)
