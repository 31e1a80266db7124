# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes of a remesh, driven in steps, and what they leave in the file."""

import addon_host
import bpy

_UNCHOSEN = {"density": "", "image": "", "image_channel": "BRIGHTNESS", "uv_map": ""}
PRESSED = {"feature_angle": 0.5, "max_distance": 0.0, "adaptive": False, **_UNCHOSEN}


def stepped(kind, count, frames):
    """A bake of the active object in steps, and what drives it."""
    options = {"feature_angle": 30.0, "max_distance": 0.0, "adaptive": False}
    chosen = addon_host.part("blender.remesh.density").Chosen()
    begin = getattr(addon_host.part(f"blender.remesh.{kind}"), f"{kind}_steps")
    work = begin(bpy.context, bpy.context.object, count, chosen, options, frames)
    return addon_host.part("core.base.steps").Stepper(work)


def cancel(stepper, progress):
    """Cancel it once so much is done."""
    while stepper.progress < progress:
        stepper.poll(wait=0.01)
    between = blocks()
    stepper.cancel()
    return between


def press_until(artist, progress, pressed):
    """Begin a remesh in the background, and wait until so much of it is done."""
    artist.press("remesh", **pressed)
    artist.until(lambda: artist.work.job.progress > progress)


def expect_end_by_purge(artist, obj, progress, pressed):
    """Once so much is done the artist removes unused data, and with it the meshes so far."""
    before = blocks()
    press_until(artist, progress, pressed)
    bpy.data.orphans_purge()
    artist.finish()
    assert "a mesh was removed in the meantime" in artist.said(obj)[-1][1]
    assert blocks() <= before


def blocks():
    """Names of all data-blocks that a bake makes."""
    lists = ("objects", "meshes", "collections", "node_groups", "shape_keys", "actions")
    return {one.name_full for name in lists for one in getattr(bpy.data, name)}
