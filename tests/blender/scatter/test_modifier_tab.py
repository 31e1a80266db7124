# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits in the modifier tab stay, and the panel shows them."""

import addon_host
import bpy
import pytest
import scenes


def edit(obj, name, value):
    """Set an input as the modifier tab does."""
    modifier = addon_host.part("blender.scatter.modifier").scatter_modifier(obj)
    bpy.context.view_layer.update()
    addon_host.part("nodes").set_input(modifier, name, value)
    obj.update_tag()
    bpy.context.view_layer.update()


def shown(obj, name):
    modifier = addon_host.part("blender.scatter.modifier").scatter_modifier(obj)
    return addon_host.part("nodes").get_input(modifier, name)


@pytest.fixture
def obj():
    return scenes.scattered(scenes.sphere(), count=40)


def test_a_number_is_taken_over_and_not_overwritten(obj):
    edit(obj, "Scale", 0.25)
    assert obj.dapple.scale == pytest.approx(0.25)
    obj.dapple.random_tilt = 0.5
    bpy.context.view_layer.update()
    assert shown(obj, "Scale") == pytest.approx(0.25)
    assert shown(obj, "Random Tilt") == pytest.approx(0.5)
    bpy.ops.dapple.optimize()
    assert shown(obj, "Scale") == pytest.approx(0.25)


def test_an_object_is_taken_over(obj):
    thing = bpy.data.objects.new("Thing", bpy.data.meshes.new("Thing"))
    edit(obj, "Instance", thing)
    assert obj.dapple.instance == thing
    edit(obj, "Instance", None)
    assert obj.dapple.instance is None


def test_so_is_what_the_viewport_shows(obj):
    edit(obj, "Hidden", 0.75)
    assert obj.dapple.viewport_share == pytest.approx(0.25)
    edit(obj, "Display", 1)
    assert obj.dapple.display_as == "BOUNDS"
    assert shown(obj, "Hidden") == pytest.approx(0.75)


def test_of_several_types_each_has_its_own(obj):
    for _ in range(2):
        bpy.ops.dapple.edit_object_types(action="ADD")
    edit(obj, "Scale 2", 3.0)
    assert [kind.scale for kind in obj.dapple.object_types] == pytest.approx([1.0, 3.0])


def test_the_panel_goes_before_what_was_not_edited(obj):
    bpy.context.view_layer.update()
    group = obj.dapple
    if hasattr(group, "bl_system_properties_get"):  # Blender 5.0 stores values outside the group
        group = group.bl_system_properties_get(do_create=True)
    group["scale"] = 2.0  # no update handler is called
    obj.update_tag()
    bpy.context.view_layer.update()
    assert obj.dapple.scale == pytest.approx(2.0)
    obj.dapple.random_tilt = 0.1
    assert shown(obj, "Scale") == pytest.approx(2.0)
