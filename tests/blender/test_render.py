# SPDX-License-Identifier: GPL-3.0-or-later
"""The render's own evaluation, read by a render engine of the tests."""

import addon_host
import bpy
import numpy as np
import probe
import pytest
import scenes


@pytest.fixture(autouse=True)
def engine():
    with probe.registered():
        yield


def test_the_copy_that_is_evaluated_has_the_faces_that_a_render_gets():
    topology = addon_host.part("blender.topology")
    obj = scenes.tail(levels=1, render_levels=2)
    render = bpy.context.scene.render
    for simplify, expected in ((False, 1634), (True, 410)):
        render.use_simplify, render.simplify_subdivision_render = simplify, 1
        with topology._render_mesh(obj, bpy.context) as mesh:
            count = len(mesh.vertices)
        assert count == probe.render(obj, 1)["surface_vertices"] == expected


@pytest.mark.parametrize(("frame", "subframe"), [(1, 0.0), (4, 0.0), (4, 0.5), (9, 0.0)])
def test_a_render_shows_the_points_that_the_viewport_shows(frame, subframe):
    surface = scenes.tail(frames=5)
    obj = scenes.scattered(surface)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    seen = probe.render(obj, frame, subframe)
    assert seen["mode"] == "RENDER"
    bpy.context.scene.frame_set(frame, subframe=subframe)
    expected = scenes.positions(obj)
    assert len(expected) == 60
    tolerance = 1e-5 * scenes.size(scenes.world_vertices(surface))
    assert np.abs(seen["positions"] - expected).max() < tolerance


def test_levels_made_unequal_after_the_bake_show_no_points_in_the_render():
    surface = scenes.tail(frames=3)
    obj = scenes.scattered(surface)
    surface.modifiers["Subdivision"].render_levels = 2
    assert len(probe.render(obj, 2)["positions"]) == 0
    assert len(scenes.positions(obj)) == 60
