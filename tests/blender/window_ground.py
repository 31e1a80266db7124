# SPDX-License-Identifier: GPL-3.0-or-later
"""A scatter on a plane that faces a real window, for stories about its points."""

import os
from pathlib import Path

import addon_host
import bpy
import hand as hand_of
import numpy as np
import scenes
from bpy_extras.view3d_utils import location_3d_to_region_2d

SHOTS = os.environ.get("DAPPLE_SHOTS")
NAME = "Ground Scatter"


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
