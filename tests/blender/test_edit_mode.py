# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and operators while the surface or the points are in Edit Mode, where meshes have no
arrays.
"""

import addon_host
import bpy
import pytest
import scenes
import test_panels


def of_two_types(surface):
    """A scatter of two object types with a density, everything that counts points."""
    obj = scenes.scattered(surface)
    for _ in range(2):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def baked(surface):
    obj = scenes.scattered(surface)
    bpy.context.scene.frame_end = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


def locked(surface):
    obj = scenes.scattered(surface)
    assert bpy.ops.dapple.lock_points(lock=True, every=True) == {"FINISHED"}
    return obj


MADE = (scenes.scattered, of_two_types, baked, locked)


def own_operators():
    names = [name for name in dir(bpy.ops.dapple) if not name.startswith("_")]
    return [getattr(bpy.ops.dapple, name) for name in names]


def edited(made, which):
    """The scatter, with it or its surface active and in Edit Mode."""
    obj = made(scenes.tail(frames=3))
    scenes.activate(obj if which == "points" else obj.dapple.surface)
    bpy.ops.object.mode_set(mode="EDIT")
    return obj


@pytest.mark.parametrize("which", ["points", "surface"])
@pytest.mark.parametrize("made", MADE)
def test_panels_are_drawn(made, which):
    obj = edited(made, which)
    assert test_panels.drawn()
    if which == "surface":  # which stays in Edit Mode while the scatter is looked at
        bpy.context.view_layer.objects.active = obj
        assert "dapple.optimize" in test_panels.drawn()


def said(operator):
    """What an operator says if it fails."""
    try:
        operator()
    except RuntimeError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("which", ["points", "surface"])
@pytest.mark.parametrize("made", MADE)
def test_operators_end_or_say_why_not(made, which, capfd):
    edited(made, which)
    for operator in own_operators():
        if operator.poll():
            assert "failed, nothing was changed" not in said(operator), operator
        assert "Traceback" not in capfd.readouterr().err, operator


@pytest.mark.parametrize("made", MADE)
def test_points_are_compared_again_once_they_are_not_edited(made):
    obj = edited(made, "points")
    verdict = addon_host.part("blender.freshness.staleness").verdict
    found = verdict(obj, bpy.context)
    assert (found.reason, found.note) == ("", "Not compared with its surface in Edit Mode")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not verdict(obj, bpy.context).note


def test_points_that_others_avoid_may_be_edited():
    """Their places are not known then: that is said, and known again afterward."""
    surface = scenes.tail(frames=3)
    first = scenes.scattered(surface)
    second = scenes.scattered(surface)
    second.dapple.density.avoid_collection = scenes.collection_of(first)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    scenes.activate(first)
    bpy.ops.object.mode_set(mode="EDIT")
    verdict = addon_host.part("blender.freshness.staleness").verdict
    assert "is in Edit Mode: leave it first" in verdict(second, bpy.context).reason
    bpy.ops.object.mode_set(mode="OBJECT")
    assert "Edit Mode" not in verdict(second, bpy.context).reason
