# SPDX-License-Identifier: GPL-3.0-or-later
"""Single points placed with the mouse in a real window, by the tool and in Edit Mode."""

import os
import sys
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

sys.path.insert(0, str(Path(__file__).resolve().parent))
import addon_host
import hand as hand_of
import scenes
import story

TICK = 0.02
SHOTS = os.environ.get("DAPPLE_SHOTS")
NAME = "Ground Scatter"


def events():
    bpy.context.preferences.edit.use_global_undo = True
    yield from scattered_ground()
    hand = hand_of.Hand()
    hand.columns = (0.62, 0.3)
    yield from with_the_tool(hand)
    yield from in_edit_mode(hand)


def scattered_ground():
    """200 points on a plane that faces the window."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20, size=4)
    ground = bpy.context.object
    ground.name = "Ground"
    with over_view():
        bpy.ops.view3d.view_axis(type="TOP")
        bpy.ops.view3d.view_selected()
    yield from hand_of.waited(hand_of.tab_is_shown)
    with over_view():
        bpy.ops.dapple.add_scatter("INVOKE_DEFAULT", count=200)
    yield from hand_of.waited(lambda: NAME in bpy.data.objects and settled(200))
    yield from rested()


def with_the_tool(hand):
    """A click adds, a drag pulls, Ctrl and a click removes: each is a step of undo."""
    yield from hand_of.Hand(hand_of.toolbar).press_button("dapple.points")
    tool = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT")
    yield from hand_of.waited(lambda: tool.idname == "dapple.points")
    first, gap = places(), gap_in(places())
    yield from hand.click(*on_screen(gap))
    yield from hand_of.waited(lambda: settled(201))
    (added,) = places().keys() - first.keys()
    near(places()[added], gap)
    assert locked() == {added}
    yield from shot("points-added")
    yield from pulled(hand, added)
    yield from removed(hand, added)
    for count in (201, 201, 200):
        with over_view():
            bpy.ops.ed.undo()
        yield from hand_of.waited(lambda count=count: settled(count))
    assert same(places(), first)


def pulled(hand, added):
    """Drag the point in the lower left to its neighbor's other side."""
    before = places()
    chosen = min(before, key=lambda one: before[one][:2].sum())
    goal = before[chosen] + (0.3, 0.15, 0.0)
    start, end = on_screen(before[chosen]), on_screen(goal)
    way = [start + (end - start) * k / 10 for k in range(11)]
    yield from hand.drag(way, before_release=lambda: shot("points-line"))
    yield from hand_of.waited(lambda: settled(201))
    near(places()[chosen], goal)
    assert locked() == {added, chosen}
    assert places().keys() == before.keys()
    yield from shot("points-pulled")


def removed(hand, added):
    """The point in the upper left, where no gizmo is."""
    before = places()
    chosen = max(before.keys() - locked(), key=lambda one: before[one][1] - before[one][0])
    yield from hand.click(*on_screen(before[chosen]), ctrl=True)
    yield from hand_of.waited(lambda: settled(200))
    assert before.keys() - places().keys() == {chosen}
    assert added in places()
    yield from shot("points-removed")


def in_edit_mode(hand):
    first, gap = places(), gap_in(places())
    yield from hand.open_panel("dapple.edit_points(", below="dapple.seed")
    yield from hand.press_button("dapple.edit_points(")
    yield from hand_of.waited(lambda: bpy.context.mode == "EDIT_MESH")
    yield from rested()
    yield from shot("points-edited")
    yield from hand.click(*on_screen(gap), button="RIGHTMOUSE", ctrl=True)
    yield from shot("points-placed")
    yield from hand.press_button("dapple.finish_editing_points(")
    yield from hand_of.waited(lambda: bpy.context.mode == "OBJECT" and settled(201))
    (added,) = places().keys() - first.keys()
    near(places()[added], gap)
    assert locked() == {added}
    yield from hand.move(*on_screen(gap))
    yield from shot("points-done")


def scatter():
    """Looked up anew: an undo leaves references dangling."""
    return bpy.data.objects[NAME]


def places():
    """Places in world space, by id."""
    ids = [one.value for one in scatter().data.attributes["id"].data]
    return dict(zip(ids, scenes.positions(scatter()), strict=True))


def locked():
    flags = scatter().data.attributes["dapple_locked"].data
    return {one for one, flag in zip(places(), flags, strict=True) if flag.value}


def gap_in(known):
    """The place on the ground, away from its border, that is farthest from all points."""
    there = np.array(list(known.values()))
    free = np.random.default_rng(0).uniform((-1.5, -1.5, 0), (1.0, 1.5, 0), size=(2000, 3))
    return max(free, key=lambda one: np.linalg.norm(there - one, axis=1).min())


def near(place, goal):
    assert np.linalg.norm(place - goal) < 0.02, (place, goal)


def same(one, other):
    return one.keys() == other.keys() and all(np.array_equal(one[key], other[key]) for key in one)


def settled(count):
    """Whether there is this number of points, and they are up to date."""
    live = addon_host.part("blender.solve.auto_update")
    if live.is_active() or len(scatter().data.vertices) != count:
        return False
    return not addon_host.part("blender.freshness.staleness").stale_reason(scatter(), bpy.context)


def on_screen(place):
    """A place as pixels of the window."""
    region = hand_of.viewport()
    view = hand_of.view().spaces.active.region_3d
    x, y = location_3d_to_region_2d(region, view, place)
    return np.array((region.x + x, region.y + y))


def over_view():
    return bpy.context.temp_override(
        window=hand_of.window(), area=hand_of.view(), region=hand_of.viewport()
    )


def rested():
    for _ in range(40):
        yield


def shot(name):
    if SHOTS:
        yield from hand_of.shot(Path(SHOTS) / f"{name}.png")


story.begin(events, TICK)
