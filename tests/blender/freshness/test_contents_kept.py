# SPDX-License-Identifier: GPL-3.0-or-later
"""A result stays up to date while the contents of its inputs are the same, also after saving."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import camera, linked, note, obstacle, picture, reason, solved, weighed


def test_names_alone_change_nothing():
    surface, stone, image, made = scenes.sphere(), obstacle(), picture(), camera()
    group = weighed(surface)
    obj = solved(
        surface,
        attribute="Grass",
        image=image,
        use_camera_view=True,
        avoid_collection=bpy.data.collections["Stones"],
    )
    named = (surface, surface.data, stone, image, made, obj, obj.data)
    for one in (*named, bpy.data.collections["Stones"], bpy.context.scene):
        one.name = f"Other {one.name}"
        assert reason(obj) == note(obj) == "", one.name
    surface.data.uv_layers[0].name = "Other map"
    assert reason(obj) == ""
    group.name = "Lawn"
    assert "no attribute or vertex group 'Grass'" in reason(obj)
    obj.dapple.density.attribute = "Lawn"
    assert reason(obj) == ""


def test_settings_without_effect_change_nothing():
    obj = solved(scenes.sphere())
    density = obj.dapple.density
    density.slope_min, density.height_max, density.camera_margin = 0.3, 7.0, 0.5
    density.avoid_margin, density.uv_map = 0.2, "UVMap"
    obj.dapple.stickiness, obj.dapple.keyframe_step, obj.dapple.fade_duration = 4.0, 3, 5
    assert reason(obj) == ""
    assert scenes.node_warnings(obj) == []


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 2, 0.5)])
def test_a_scene_that_is_moved_as_a_whole_fits(scale):
    surface, stone, made = scenes.sphere(scale=scale), obstacle(), camera()
    above = linked(bpy.data.objects.new("Above", None))
    for one in (surface, stone, made):
        one.parent = above
    obj = solved(surface, use_camera_view=True, avoid_collection=bpy.data.collections["Stones"])
    above.location, above.rotation_euler = (3, -40, 5), (1, 2, 3)
    assert reason(obj) == ""
    stone.location.x = 1e-3
    assert "Avoided objects" in reason(obj)


def test_a_scale_that_is_applied_fits():
    surface = scenes.sphere(scale=(1.0, 2.0, 0.5), rotation=(0.3, 0.4, 0.5))
    obj = solved(surface)
    scenes.activate(surface)
    assert bpy.ops.object.transform_apply(location=False, rotation=False) == {"FINISHED"}
    assert reason(obj) == note(obj) == ""
    bpy.ops.object.origin_set(type="GEOMETRY_ORIGIN", center="BOUNDS")
    assert reason(obj) == note(obj) == ""


def test_another_scatter_to_avoid_is_solved_again():
    surface = scenes.sphere()
    other = scenes.scattered(scenes.sphere(location=(0, 0, 1)))
    collection = bpy.data.collections.new("Others")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(other)
    obj = solved(surface, avoid_collection=collection, avoid_margin=0.1)
    other.dapple.seed = 5
    assert reason(obj) == ""
    scenes.activate(other)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == "Avoided objects were moved or changed: optimize again"


def test_contents_are_compared_after_saving_and_opening(tmp_path):
    surface = scenes.sphere()
    weighed(surface)
    image = picture()
    image.pack()
    solved(surface, attribute="Grass", image=image)
    path = str(tmp_path / "solved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Sphere Scatter"]
    assert reason(obj) == note(obj) == ""
    bpy.data.objects["Sphere"].vertex_groups["Grass"].add([3], 0.0, "REPLACE")
    assert "Values of 'Grass'" in reason(obj)


def test_on_another_frame_what_moves_is_no_change():
    surface = scenes.tail(frames=4)
    group = weighed(surface)
    obj = solved(surface, attribute="Grass")
    bpy.context.scene.frame_set(4)
    assert reason(obj) == ""
    assert note(obj) == (
        "Differs from frame 1, where the points were optimized: shape of the surface"
    )
    group.add([100], 0.25, "REPLACE")
    assert "Values of 'Grass'" in reason(obj)


@pytest.mark.parametrize("seen", range(3))
def test_every_vertex_counts_in_a_large_surface(seen):
    sources, surface = (
        addon_host.part("core.surface.sources"),
        addon_host.part("core.surface.arrays"),
    )
    random = np.random.Generator(np.random.PCG64(seen))
    vertices = random.normal(size=(50_001, 3))
    none = np.empty((0, 3), dtype=np.int32)
    settings = addon_host.part("core.settings.values").Settings()
    before = sources.sources_of(surface.SurfaceArrays("Any", vertices, none, "t"), settings)
    before = sources.sources_from(before.text())
    vertices[random.integers(len(vertices))] += 0.01
    now = sources.sources_of(surface.SurfaceArrays("Any", vertices, none, "t"), settings)
    assert sources.differing(before, now) == ["shape"]
