# SPDX-License-Identifier: GPL-3.0-or-later
"""New objects in Local View: a Blender without windows shows there whatever is new, so the calls
are compared.
"""

import addon_host
import bpy
import pytest
import scenes


def scatter():
    return scenes.scattered(scenes.sphere(), 40)


def text():
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.1
    return bpy.context.object


SEQUENCE = {"animation": "SEQUENCE", "count": 100, "frame_start": 1, "frame_end": 2}
CASES = {
    "add_scatter": ("add.operators", scenes.sphere, {"count": 20}, "Sphere Scatter"),
    "make_tiles": ("tiles.operators", scatter, {}, "Sphere Scatter Tiles"),
    "add_hair_guides": ("hair.operators", scatter, {}, "Sphere Scatter Hair"),
    "remesh": ("remesh.new_object", text, {"count": 300}, "Text Remeshed"),
    "remesh a sequence": ("remesh.new_object", scenes.sphere, SEQUENCE, "Sphere Remeshed"),
}


@pytest.mark.parametrize("name", CASES)
def test_new_objects_are_shown_with_those_they_belong_to(name, monkeypatch):
    module, make, given, new = CASES[name]
    obj, called = make(), []
    monkeypatch.setattr(
        addon_host.part(f"blender.{module}"),
        "into_local_views",
        lambda seen, made: called.append((seen.name, seen.visible_get(), made.name)),
    )
    assert getattr(bpy.ops.dapple, name.split()[0])(**given) == {"FINISHED"}
    assert called == [(obj.name, True, new)]


def test_a_local_view_gets_the_new_object():
    obj, lone = scenes.sphere(), scenes.sphere()
    scenes.activate(obj)
    (window,) = bpy.context.window_manager.windows
    area = next(one for one in window.screen.areas if one.type == "VIEW_3D")
    region = next(one for one in area.regions if one.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        assert bpy.ops.view3d.localview() == {"FINISHED"}
        space = area.spaces.active
        assert not lone.visible_get(viewport=space)
        addon_host.part("blender.scatter.local_views").into_local_views(obj, lone)
        assert lone.visible_get(viewport=space)
        assert bpy.ops.view3d.localview() == {"FINISHED"}
