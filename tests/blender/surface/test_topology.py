# SPDX-License-Identifier: GPL-3.0-or-later
"""Viewport and render must evaluate a surface to the same faces."""

import addon_host
import bpy
import pytest
import scenes


def check(obj):
    addon_host.part("blender.surface.subdivision").check_render_topology(obj, bpy.context)


def refused(obj, words):
    errors = addon_host.part("core.base.errors")
    with pytest.raises(errors.ScatterError, match=words):
        check(obj)


def test_equal_levels_pass():
    check(scenes.tail(levels=1, render_levels=1))


def test_unequal_levels_are_refused_with_both_counts_and_leave_no_trace():
    obj = scenes.tail(levels=1, render_levels=2)
    before = scenes.snapshot()
    refused(
        obj,
        r"'Tail' has 410 vertices in the viewport and 1634 in the render "
        r"\(Subdivision: 1 and 2\)",
    )
    assert scenes.snapshot() == before


def test_a_driven_level_is_refused_too():
    obj = scenes.tail(levels=1, render_levels=2)
    obj.modifiers["Subdivision"].driver_add("levels").driver.expression = "1"
    refused(obj, "Subdivision: 1 and 2")


def test_a_modifier_shown_in_the_render_only_is_refused():
    obj = scenes.tail()
    obj.modifiers["Subdivision"].show_viewport = False
    refused(obj, "shown in the render only")


def test_a_difference_that_leaves_the_faces_alone_passes():
    obj = scenes.tail()
    obj.modifiers["Armature"].show_render = False
    check(obj)


def test_simplify_counts():
    obj = scenes.tail(levels=2, render_levels=2)
    render = bpy.context.scene.render
    render.use_simplify = True
    render.simplify_subdivision, render.simplify_subdivision_render = 1, 2
    refused(obj, "Simplify: 1 and 2")
    render.simplify_subdivision = 2
    check(obj)


@pytest.mark.parametrize(("use", "level"), [("RENDER", 2), ("VIEWPORT", 1)])
def test_match_subdivision_makes_both_equal(use, level):
    obj = scenes.tail(levels=1, render_levels=2)
    assert bpy.ops.dapple.match_subdivision(use=use) == {"FINISHED"}
    modifier = obj.modifiers["Subdivision"]
    assert (modifier.levels, modifier.render_levels) == (level, level)
    check(obj)
    assert not bpy.ops.dapple.match_subdivision.poll()
