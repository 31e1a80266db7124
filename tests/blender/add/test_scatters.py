# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of a surface's scatters: select, show alone, copy, remove."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
import test_panels

pytestmark = pytest.mark.empty_file  # the node groups are built here


@pytest.fixture
def pair():
    """Two scatters on one sphere, the surface active."""
    surface = scenes.sphere()
    first, second = (scenes.scattered(surface, count=count) for count in (40, 60))
    bpy.context.view_layer.objects.active = surface
    return surface, first, second


def names_of(surface):
    found = addon_host.part("blender.surface.scatters").scatters_of(surface)
    return [obj.name for obj in found]


def test_a_surface_lists_its_scatters_alone(pair):
    surface, first, second = pair
    other = scenes.sphere()
    third = scenes.scattered(other, count=30)
    assert names_of(surface) == [first.name, second.name]
    assert names_of(other) == [third.name]
    bpy.context.view_layer.objects.active = surface
    shown = test_panels.drawn()
    assert shown.count("dapple.select_scatter") == 2
    assert {"40", "60", "hide_viewport", "hide_render", "dapple.add_scatter"} <= set(shown)
    assert "30" not in shown


def test_what_tells_scatters_apart_is_not_cut_off_in_the_list(pair):
    """In the default sidebar, both were 'Sphere Scatter...'."""

    class Buttons(test_panels.Layout):
        def operator(self, name, text="", **options):
            if name == "dapple.select_scatter":
                listed.append(text)
            return super().operator(name, text, **options)

    _, first, second = pair
    listed = []
    test_panels.drawn(Buttons)
    assert listed == ["Scatter", "Scatter.001"]
    first.name, second.name = "Moss", "Stones"
    listed.clear()
    test_panels.drawn(Buttons)
    assert listed == ["Moss", "Stones"]


def test_from_a_surface_to_a_scatter_and_back(pair):
    surface, _, second = pair
    assert bpy.ops.dapple.select_scatter(name=second.name) == {"FINISHED"}
    assert bpy.context.object == second
    assert bpy.context.selected_objects == [second]
    assert "dapple.select_surface" in test_panels.drawn()
    assert bpy.ops.dapple.select_surface() == {"FINISHED"}
    assert bpy.context.object == surface


def test_solo_hides_the_others_and_shows_them_again(pair):
    _, first, second = pair
    bpy.ops.dapple.solo_scatter(name=first.name)
    assert (first.hide_viewport, second.hide_viewport) == (False, True)
    bpy.ops.dapple.solo_scatter(name=second.name)
    assert (first.hide_viewport, second.hide_viewport) == (True, False)
    bpy.ops.dapple.solo_scatter(name=second.name)
    assert not first.hide_viewport
    assert not second.hide_viewport
    assert not first.hide_render


def test_a_copy_has_everything_of_its_own():
    tail = scenes.tail(frames=3)
    obj = scenes.scattered(tail, count=30)
    bpy.ops.dapple.bake()
    obj.dapple.scale = 0.3
    assert bpy.ops.dapple.copy_scatter() == {"FINISHED"}
    (copy,) = (one for one in bpy.data.objects if one.name == f"{obj.name}.001")
    assert copy.data != obj.data
    assert copy.dapple.scale == pytest.approx(0.3)
    assert copy.dapple.bake_key != obj.dapple.bake_key
    bpy.context.scene.frame_set(2)
    before = scenes.positions(copy)
    np.testing.assert_array_equal(before, scenes.positions(obj))
    stale = addon_host.part("blender.freshness.staleness").stale_reason
    assert stale(copy, bpy.context) == ""
    bpy.ops.dapple.clear_bake()  # clears the bake of the original
    assert copy.dapple.baked_keys == 3
    np.testing.assert_array_equal(before, scenes.positions(copy))


def test_remove_takes_the_bake_along():
    obj = scenes.scattered(scenes.tail(frames=3), count=30)
    before = {one.name for one in bpy.data.objects} - {obj.name}
    bpy.ops.dapple.bake()
    assert len(bpy.data.objects) == len(before) + 4
    assert bpy.ops.dapple.remove_scatter() == {"FINISHED"}
    assert {one.name for one in bpy.data.objects} == before
    assert not [mesh for mesh in bpy.data.meshes if not mesh.users]


def test_what_is_no_scatter_is_left_alone(pair):
    surface, *_ = pair
    for verb in ("select_scatter", "solo_scatter", "copy_scatter", "remove_scatter"):
        with pytest.raises(RuntimeError, match=f"'{surface.name}' is not a Dapple scatter"):
            getattr(bpy.ops.dapple, verb)(name=surface.name)
    with pytest.raises(RuntimeError, match="The active object is not a Dapple scatter"):
        bpy.ops.dapple.remove_scatter()
    assert len(names_of(surface)) == 2
