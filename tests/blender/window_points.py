# SPDX-License-Identifier: GPL-3.0-or-later
"""Single points placed with the mouse in a real window, by the tool and in Edit Mode."""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import hand as hand_of
import story
from window_ground import (
    gap_in,
    locked,
    near,
    on_screen,
    over_view,
    places,
    rested,
    same,
    scattered_ground,
    settled,
    shot,
)

TICK = 0.02


def events():
    bpy.context.preferences.edit.use_global_undo = True
    yield from scattered_ground()
    hand = hand_of.Hand()
    hand.columns = (0.62, 0.3)
    yield from with_the_tool(hand)
    yield from in_edit_mode(hand)


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


story.begin(events, TICK)
