# SPDX-License-Identifier: GPL-3.0-or-later
"""The render's own evaluation, read by a render engine of the tests."""

import addon_host
import bpy
import numpy as np
import probe
import pytest
import scenes

pytestmark = pytest.mark.usefixtures("engine")


def test_the_copy_that_is_evaluated_has_the_faces_that_a_render_gets():
    topology = addon_host.part("blender.surface.subdivision")
    obj = scenes.tail(levels=1, render_levels=2)
    render = bpy.context.scene.render
    for simplify, expected in ((False, 1634), (True, 410)):
        render.use_simplify, render.simplify_subdivision_render = simplify, 1
        with topology.render_mesh(obj, bpy.context) as mesh:
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


def test_a_frame_looks_the_same_whether_it_was_played_or_jumped_to():
    obj = scenes.scattered(scenes.tail(frames=6))
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in range(1, 5):
        played = probe.render(obj, frame, 0.25)["positions"]
    for elsewhere in (30, 1):
        bpy.context.scene.frame_set(elsewhere)
    jumped = probe.render(obj, 4, 0.25)["positions"]
    assert len(played) == 60
    assert (played == jumped).all()


def sheet():
    """A plane that a shape key shifts by one along x from frame 1 to 3, and its scatter."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=1.0)
    surface = bpy.context.object
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Shifted")
    for point in key.data:
        point.co.x += 1.0
    for frame, value in ((1, 0.0), (3, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    for curve in scenes.curves(surface.data.shape_keys):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    surface.hide_render = True
    return surface


def glowing_ball():
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.05, location=(50, 0, 0))  # out of the picture
    ball = bpy.context.object
    material = bpy.data.materials.new("Glow")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    glow, out = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(glow.outputs[0], out.inputs[0])
    ball.data.materials.append(material)
    return ball


def picture(path):
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(4 * image.size[0] * image.size[1], dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(image_size(), image_size(), 4)[:, :, 0].astype(np.float64)


def open_shutter(render):
    """Blur over a whole frame; the shutter is open from its start to its end."""
    render.use_motion_blur, render.motion_blur_shutter = True, 1.0
    curve = render.motion_blur_shutter_curve
    for point in curve.curves[0].points:
        point.location.y = 1.0
    curve.update()


def image_size():
    return bpy.context.scene.render.resolution_x


def spread(light):
    """Standard deviation of the light along x and y, in pixels."""
    y, x = np.indices(light.shape)
    total = light.sum()
    return tuple(
        np.sqrt((light * (at - (light * at).sum() / total) ** 2).sum() / total) for at in (x, y)
    )


def test_motion_blur_smears_instances_along_their_way_and_equal_renders_are_equal(tmp_path):
    surface = sheet()
    obj = scenes.scattered(surface, count=1)
    scene = bpy.context.scene
    scene.frame_end = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    obj.dapple.instance = glowing_ball()
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.location, camera.data.type, camera.data.ortho_scale = (0.5, 0, 5), "ORTHO", 2.0
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 16, False
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.frame_set(2)
    sharp = spread(picture(tmp_path / "sharp.exr"))
    open_shutter(scene.render)
    light = picture(tmp_path / "blurred.exr")
    blurred = spread(light)
    # Half a unit of motion within a frame is 16 pixels; evenly distributed, its standard deviation
    # is 16 / sqrt(12).
    assert np.sqrt(blurred[0] ** 2 - sharp[0] ** 2) == pytest.approx(16 / np.sqrt(12), rel=0.15)
    assert blurred[1] == pytest.approx(sharp[1], abs=0.3)
    for elsewhere in (3, 1):
        scene.frame_set(elsewhere)
    scene.frame_set(2)
    assert (picture(tmp_path / "again.exr") == light).all()
