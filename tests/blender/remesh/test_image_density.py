# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple by an image: vertices are closer together where it is brighter."""

import functools
import types

import addon_host
import bpy
import dapple3d as dapple
import numpy as np
import pytest
import scenes
import test_panels

GIVEN = {"count": 600, "image": "Halves"}


def image_of(pixels, name="Halves"):
    """An image with these colors (rows, columns, 4), row 0 at the bottom."""
    rows, columns, _ = pixels.shape
    image = bpy.data.images.new(name, columns, rows, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    return image


def halves(name="Halves", low=(0.0, 0.0, 0.0, 1.0), high=(1.0, 1.0, 1.0, 1.0)):
    """An image that is dark below v = 0.5 and bright above."""
    pixels = np.empty((16, 16, 4))
    pixels[:8], pixels[8:] = low, high
    return image_of(pixels, name)


def plate(cuts=1):
    """A square plate from -1 to 1 whose UV map fills the unit square."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, size=2.0)
    return bpy.context.object


def places_of(mesh):
    found = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def bright_share(obj):
    """The share of vertices on the bright half of a plate."""
    return (places_of(obj.data)[:, 1] > 0.0).mean()


@pytest.mark.parametrize("cuts", [1, 20])
def test_vertices_are_closer_where_the_image_is_brighter(cuts):
    """Also within the faces of a mesh that has only one."""
    obj = plate(cuts)
    halves()
    assert bpy.ops.dapple.remesh(**GIVEN) == {"FINISHED"}
    assert not obj.data.validate()
    assert len(obj.data.vertices) == 600
    assert bright_share(obj) > 0.9
    assert places_of(obj.data)[:, 1].min() == pytest.approx(-1.0)  # there is something everywhere


def test_the_other_data_stay_in_place():
    """Faces are cut by the image, but values come from those of the old mesh."""
    obj = plate(2)
    halves()
    height = obj.data.attributes.new("height", "FLOAT", "POINT")
    height.data.foreach_set("value", places_of(obj.data)[:, 1].copy())
    for edge in obj.data.edges:  # two of them, from one side to the other
        edge.use_seam = all(obj.data.vertices[k].co.x == 0.0 for k in edge.vertices)
    assert bpy.ops.dapple.remesh(**GIVEN) == {"FINISHED"}
    mesh, places = obj.data, places_of(obj.data)
    found = np.empty(len(mesh.vertices), np.float32)
    mesh.attributes["height"].data.foreach_get("value", found)
    np.testing.assert_allclose(found, places[:, 1], atol=1e-5)
    uv = np.empty((len(mesh.loops), 2), np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", uv.ravel())
    corners = np.array([one.vertex_index for one in mesh.loops])
    np.testing.assert_allclose(2.0 * uv - 1.0, places[corners][:, :2], atol=1e-4)
    ends = [one.vertices for one in mesh.edges if one.use_seam]
    seam = sum(np.linalg.norm(places[a] - places[b]) for a, b in ends)
    assert seam == pytest.approx(2.0, rel=1e-4)


def test_creases_of_a_cube_stay():
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    obj = bpy.context.object
    halves()
    assert bpy.ops.dapple.remesh(**GIVEN) == {"FINISHED"}
    places, faces = scenes.shown(obj)
    assert dapple.Surface(places, faces).area == pytest.approx(24.0, rel=1e-5)
    assert (np.abs(places).min(axis=1) > 1 - 1e-5).sum() == 8


@pytest.mark.parametrize(("channel", "bright"), [("RED", False), ("GREEN", True), ("ALPHA", False)])
def test_one_channel_can_be_chosen(channel, bright):
    obj = plate()
    halves(low=(1.0, 0.0, 0.0, 1.0), high=(0.0, 1.0, 0.0, 0.0))
    assert bpy.ops.dapple.remesh(**GIVEN, image_channel=channel) == {"FINISHED"}
    assert (bright_share(obj) > 0.9) == bright


def test_another_uv_map_can_be_chosen():
    obj = plate(20)
    halves()
    turned = obj.data.uv_layers.new(name="Turned")
    for one in turned.uv:
        one.vector = (one.vector.x, 1.0 - one.vector.y)
    assert bpy.ops.dapple.remesh(**GIVEN, uv_map="Turned") == {"FINISHED"}
    assert bright_share(obj) < 0.1


def test_it_multiplies_painted_weights():
    obj = plate(20)
    halves()
    left = [one.index for one in obj.data.vertices if one.co.x < 0.0]
    obj.vertex_groups.new(name="Left").add(left, 1.0, "REPLACE")
    assert bpy.ops.dapple.remesh(**GIVEN, density="Left") == {"FINISHED"}
    x, y, _ = places_of(obj.data).T
    assert ((x < 0.06) & (y > -0.06)).mean() > 0.85


def test_tiles_are_used():
    obj = plate(20)
    image = bpy.data.images.new("Tiles", 8, 8, tiled=True)
    image.pixels.foreach_set(np.ones(8 * 8 * 4, np.float32))
    for one in obj.data.uv_layers.active.uv:  # the upper half is in a tile that there is not
        one.vector = (one.vector.x, 2.0 * one.vector.y)
    assert bpy.ops.dapple.remesh(count=600, image="Tiles") == {"FINISHED"}
    assert bright_share(obj) < 0.1


BAKED = {**GIVEN, "count": 200, "frame_start": 1, "frame_end": 3}


@pytest.mark.parametrize("animation", ["SHAPE_KEYS", "SEQUENCE"])
def test_baked_meshes_follow_it(animation):
    obj = plate(8)
    halves()
    wave = obj.modifiers.new("Wave", "WAVE")
    wave.height, wave.width, wave.time_offset = 0.2, 0.6, -20.0
    bpy.context.scene.frame_set(3)
    old = dapple.Surface(*scenes.shown(obj))
    bpy.context.scene.frame_set(1)
    assert bpy.ops.dapple.remesh(**BAKED, animation=animation) == {"FINISHED"}
    bpy.context.scene.frame_set(3)
    places, _ = scenes.shown(bpy.context.object)
    assert dapple.project(old, places).distances.max() < 1e-4
    assert (places[:, 1] > 0.0).mean() > 0.8


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"image": "Gone"}, "There is no image 'Gone'"),
        ({"image": "Empty"}, "Image 'Empty' has no pixels"),
        ({"image": "Black"}, "Image 'Black' is black everywhere"),
        ({"uv_map": "Gone"}, "Surface 'Grid' has no UV map 'Gone'"),
    ],
)
def test_an_image_that_is_no_density_is_told(given, message):
    obj = plate(3)
    halves()
    image_of(np.zeros((2, 2, 4)), "Black")
    missing = bpy.data.images.new("Empty", 1, 1)
    missing.source, missing.filepath = "FILE", "//gone.png"
    before = len(obj.data.vertices)
    for animation in ("KEEP", "SHAPE_KEYS", "SEQUENCE"):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.dapple.remesh(**{**BAKED, **given}, animation=animation)
    assert len(obj.data.vertices) == before


def test_a_mesh_without_a_uv_map_is_told():
    obj = plate(3)
    halves()
    obj.data.uv_layers.remove(obj.data.uv_layers[0])
    with pytest.raises(RuntimeError, match="Surface 'Grid' has no UV map, which an image needs"):
        bpy.ops.dapple.remesh(**GIVEN)
    assert len(obj.data.vertices) == 16


class Dialog(test_panels.Layout):
    """Shows icons in searches, too."""

    def prop_search(self, data, name, source, listed, icon="NONE"):
        super().prop_search(data, name, source, listed)
        assert icon in test_panels.ICONS


def asked(**chosen):
    """What the dialog shows once these are chosen."""
    kind = addon_host.registered("DAPPLE_OT_remesh")
    names = {"bl_rna": bpy.ops.dapple.remesh.get_rna_type(), "animation": "KEEP", "image": ""}
    shown: list[str] = []
    dialog = types.SimpleNamespace(layout=Dialog(shown), **(names | chosen))
    dialog.draw_image = functools.partial(kind.draw_image, dialog)
    kind.draw(dialog, bpy.context)
    return shown


def test_the_dialog_asks_where_the_image_lies_once_there_is_one():
    plate()
    assert not {"image_channel", "uv_map"} & set(asked())
    assert {"image", "image_channel", "uv_map"} <= set(asked(image="Halves"))
