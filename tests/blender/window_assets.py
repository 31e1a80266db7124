# SPDX-License-Identifier: GPL-3.0-or-later
"""An asset of a scatter is dragged from the Asset Browser onto a surface of another file."""

import os
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import addon_host
import hand as hand_of
import scenes
import story

TICK = 0.02
SHOTS = os.environ.get("DAPPLE_SHOTS")
RADIUS = 2.0


def events():
    bpy.context.preferences.edit.use_global_undo = True
    scenes.scattered(scenes.sphere(), count=90)
    yield from hand_of.asset_library()
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=RADIUS)
    view = bpy.context.temp_override(
        window=hand_of.window(), area=hand_of.view(), region=hand_of.viewport()
    )
    with view:
        bpy.ops.view3d.view_selected()
    browser = yield from hand_of.asset_browser()
    yield from hand_of.Hand().drag_asset(browser)
    yield from hand_of.waited(placed)
    if SHOTS:
        yield from hand_of.shot(Path(SHOTS) / "assets-dropped.png")
    away = np.linalg.norm(scenes.positions(dropped()), axis=1)
    assert np.abs(away - RADIUS).max() < 0.01 * RADIUS


def placed():
    """Whether it has its points and nothing is pending."""
    live = addon_host.part("blender.solve.auto_update")
    return dropped() is not None and len(dropped().data.vertices) == 90 and not live.is_active()


def dropped():
    return next((obj for obj in bpy.data.objects if obj.dapple.surface is not None), None)


story.begin(events, TICK)
