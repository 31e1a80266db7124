# SPDX-License-Identifier: GPL-3.0-or-later
"""Points sprayed with the mouse in a real window: strokes, Ctrl, Esc, undo, F."""

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import hand as hand_of
import story
from window_ground import (
    locked,
    on_screen,
    over_view,
    places,
    same,
    scatter,
    scattered_ground,
    settled,
    shot,
)

TICK = 0.02
WAY = [(-1.2 + 0.1 * k, 0.0, 0.0) for k in range(20)]  # of a stroke, in world space


def events():
    bpy.context.preferences.edit.use_global_undo = True
    yield from scattered_ground()
    scatter().dapple.auto_update_mode = "OFF"
    with over_view():
        bpy.ops.ed.undo_push(message="Auto Update")
    hand = hand_of.Hand()
    yield from hand_of.Hand(hand_of.toolbar).press_button("dapple.spray")
    tool = bpy.context.workspace.tools.from_space_view3d_mode("OBJECT")
    yield from hand_of.waited(lambda: tool.idname == "dapple.spray")
    yield from removed_and_sprayed(hand)
    yield from canceled(hand)
    yield from resized(hand, tool.operator_properties("dapple.spray_points"))
    yield from adjusted(hand)


def removed_and_sprayed(hand):
    """Ctrl and a stroke clears a band, another stroke fills it; each is a step of undo."""
    first = places()
    yield from hand.drag(seen(), before_release=lambda: shot("spray-removing"), ctrl=True)
    yield from hand_of.waited(lambda: len(places()) < len(first))
    band = places()
    assert all(near_way(first[one]) for one in first.keys() - band.keys())
    assert len(first) - len(band) > 20
    yield from shot("spray-removed")
    yield from hand.drag(seen(), before_release=lambda: shot("spray-adding"))
    yield from hand_of.waited(lambda: len(places()) > len(band))
    filled = places()
    added = filled.keys() - band.keys()
    assert locked() == added
    assert all(near_way(filled[one]) for one in added)
    assert apart(filled, added) >= 0.8 * spacing() * 0.999
    assert 0.75 < len(added) / (len(first) - len(band)) < 1.2  # about as dense
    yield from shot("spray-added")
    for before in (band, first):
        with over_view():
            bpy.ops.ed.undo()
        yield from hand_of.waited(lambda before=before: len(places()) == len(before))
        assert same(places(), before)


def adjusted(hand):
    """Adjust Last Operation repeats the stroke with another spacing. Called by a script it makes
    no step of undo, so this comes last."""
    first = len(places())
    yield from hand.drag(seen(), ctrl=True)
    yield from hand_of.waited(lambda: len(places()) < first)
    removed = len(places())
    yield from hand.drag(seen())
    yield from hand_of.waited(lambda: len(places()) > removed)
    filled = len(places())
    (last,) = bpy.context.window_manager.operators[-1:]
    assert last.bl_idname == "DAPPLE_OT_spray_points"
    last.properties.spacing = 0.5
    with over_view():
        bpy.ops.ed.undo_redo()
    yield from hand_of.waited(lambda: len(places()) != filled)
    assert len(places()) - removed > 1.7 * (filled - removed)
    assert apart(places(), locked()) >= 0.5 * spacing() * 0.999


def canceled(hand):
    """Esc during a stroke leaves everything as it was."""
    first = places()

    def escape():
        story.press_escape()
        yield
        yield

    yield from hand.drag(seen(), before_release=escape, ctrl=True)
    assert not hand_of.window().modal_operators
    assert same(places(), first)
    assert settled(len(first))


def resized(hand, brush):
    """F and the mouse to the right enlarge the brush until a click."""
    before = brush.radius
    middle = seen()[8]
    yield from hand.press("F", *middle)
    yield from hand.move(middle[0] + 60, middle[1])
    yield from shot("spray-resized")
    assert 1.2 * before < brush.radius < 1.5 * before
    yield from hand.click(middle[0] + 60, middle[1])
    yield from hand_of.waited(lambda: not hand_of.window().modal_operators)
    assert brush.radius > 1.2 * before
    yield from hand.press("F", *middle)
    yield from hand.move(middle[0] + 90, middle[1])
    now = brush.radius
    yield from hand.press("ESC", middle[0] + 90, middle[1])
    yield from hand_of.waited(lambda: not hand_of.window().modal_operators)
    assert brush.radius < now


def seen():
    """The way on the screen."""
    return [tuple(on_screen(place)) for place in WAY]


def spacing():
    return scatter().dapple.report.spacing


def near_way(place):
    """Whether the brush reaches a place."""
    x, y = np.clip(place[0], WAY[0][0], WAY[-1][0]), place[1]
    return np.hypot(place[0] - x, y) < 3.0 * spacing() + 0.05


def apart(there, some):
    """The least distance of some points from all others."""
    keys, points = list(there), np.array(list(there.values()))
    gaps = np.linalg.norm(points[:, None] - points, axis=2)
    np.fill_diagonal(gaps, np.inf)
    return gaps[[key in some for key in keys]].min()


story.begin(events, TICK)
