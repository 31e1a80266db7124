# SPDX-License-Identifier: GPL-3.0-or-later
"""Color of instances from an attribute or an image of the surface, as dapple_color."""

import bpy
import numpy as np
import pytest
import scenes
import test_panels


def plate(cuts=8):
    """A square from -1 to 1 with a UV map."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, size=2.0)
    return bpy.context.object


def ramp(surface, name="Tint", domain="POINT", kind="FLOAT_COLOR"):
    """A color attribute: red by x, green by y, from 0 to 1."""
    attribute = surface.data.attributes.new(name, kind, domain)
    mesh = surface.data
    places = np.array([vertex.co for vertex in mesh.vertices])
    if domain == "CORNER":
        places = places[[loop.vertex_index for loop in mesh.loops]]
    elif domain == "FACE":
        places = np.array([face.center for face in mesh.polygons])
    colors = np.column_stack([0.5 + 0.5 * places[:, :2], np.zeros(len(places)), places[:, 0] ** 0])
    attribute.data.foreach_set("color", colors.astype(np.float32).ravel())
    return attribute


def checks():
    """An image whose left half is red and right half green, as floats without a color space."""
    image = bpy.data.images.new("Checks", 8, 1, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.array(4 * [1, 0, 0, 1] + 4 * [0, 1, 0, 1], dtype=np.float32))
    image.pack()
    return image


def shown(obj):
    """Places (n, 3) and colors (n, 4) of the instances, as a modifier after it sees them."""
    tree = bpy.data.node_groups.new("Realize", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    begin, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    points = tree.nodes.new("GeometryNodeInstancesToPoints")
    vertices = tree.nodes.new("GeometryNodePointsToVertices")
    for one, other in ((begin, points), (points, vertices), (vertices, end)):
        tree.links.new(one.outputs[0], other.inputs[0])
    modifier = obj.modifiers.new("Realize", "NODES")
    modifier.node_group = tree
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    places = np.array([vertex.co for vertex in mesh.vertices])
    attribute = mesh.attributes.get("dapple_color")
    colors = None
    if attribute is not None:
        colors = np.empty(4 * len(places), dtype=np.float32)
        attribute.data.foreach_get("color", colors)
        colors = colors.reshape(-1, 4)
    obj.modifiers.remove(modifier)
    return places, colors


def by_place(places):
    ones, zeros = np.ones(len(places)), np.zeros(len(places))
    return np.column_stack([0.5 + 0.5 * places[:, 0], 0.5 + 0.5 * places[:, 1], zeros, ones])


@pytest.mark.parametrize("domain", ["POINT", "CORNER", "FACE"])
def test_instances_have_the_color_of_the_attribute_below_them(domain):
    surface = plate()
    ramp(surface, domain=domain)
    obj = scenes.scattered(surface, count=50)
    assert shown(obj)[1] is None, "there is none unless it is chosen"
    obj.dapple.color_attribute = "Tint"
    places, colors = shown(obj)
    assert np.abs(colors - by_place(places)).max() < (0.13 if domain == "FACE" else 1e-3)


def test_it_is_that_below_them_with_an_offset_on_a_moved_surface():
    surface = plate()
    ramp(surface)
    obj = scenes.scattered(surface, count=50)
    surface.location, surface.rotation_euler = (3.0, 1.0, 0.0), (0.3, 0.0, 0.0)
    obj.dapple.color_attribute, obj.dapple.offset = "Tint", 0.4
    places, colors = shown(obj)
    local = (places - np.array([3.0, 1.0, 0.0])) @ np.array(surface.matrix_world)[:3, :3]
    assert np.abs(colors - by_place(local)).max() < 1e-3


def test_an_image_colors_them_and_multiplies_the_attribute():
    surface = plate()
    obj = scenes.scattered(surface, count=50)
    obj.dapple.color_image = checks()
    places, colors = shown(obj)
    inside = np.abs(places[:, 0]) < 0.85  # the image repeats beyond
    left, right = inside & (places[:, 0] < -0.3), inside & (places[:, 0] > 0.3)
    assert left.any()
    assert np.allclose(colors[left], (1.0, 0.0, 0.0, 1.0), atol=1e-3)
    assert np.allclose(colors[right], (0.0, 1.0, 0.0, 1.0), atol=1e-3)
    ramp(surface)
    obj.dapple.color_attribute = "Tint"
    places, colors = shown(obj)
    assert np.allclose(colors[left], by_place(places)[left] * [1.0, 0.0, 0.0, 1.0], atol=1e-3)
    second = surface.data.uv_layers.new(name="Flipped")
    flipped = np.array([one.vector for one in surface.data.uv_layers[0].uv]) * [-1, 1] + [1, 0]
    second.uv.foreach_set("vector", flipped.astype(np.float32).ravel())
    obj.dapple.color_uv_map, obj.dapple.color_attribute = "Flipped", ""
    _, colors = shown(obj)
    assert np.allclose(colors[left], (0.0, 1.0, 0.0, 1.0), atol=1e-3)


def test_weights_are_gray_and_a_missing_attribute_is_white():
    surface = plate()
    group = surface.vertex_groups.new(name="Wet")
    group.add(range(len(surface.data.vertices)), 0.25, "REPLACE")
    obj = scenes.scattered(surface, count=20)
    obj.dapple.color_attribute = "Wet"
    assert np.allclose(shown(obj)[1][:, :3], 0.25, atol=1e-3)
    obj.dapple.color_attribute = "Nothing"
    assert np.allclose(shown(obj)[1], 1.0)


def stores(surface, name):
    """A modifier that stores an attribute."""
    tree = bpy.data.node_groups.new("Store", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    begin, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    store = tree.nodes.new("GeometryNodeStoreNamedAttribute")
    store.inputs["Name"].default_value = name
    tree.links.new(begin.outputs[0], store.inputs[0])
    tree.links.new(store.outputs[0], end.inputs[0])
    surface.modifiers.new("Store", "NODES").node_group = tree


def test_the_panel_names_an_attribute_that_the_surface_lacks():
    surface = plate()
    ramp(surface)
    surface.vertex_groups.new(name="Wet")
    obj = scenes.scattered(surface, count=20)
    missing = "The surface has no attribute or vertex group"
    for name in ("", "Tint", "Wet"):
        obj.dapple.color_attribute = name
        assert missing not in " ".join(test_panels.drawn())
    obj.dapple.color_attribute = "Made"
    assert f"{missing} 'Made'" in " ".join(test_panels.drawn())
    stores(surface, "Made")
    assert missing not in " ".join(test_panels.drawn())
    surface.data.attributes.remove(surface.data.attributes["Tint"])
    obj.dapple.color_attribute = "Tint"
    assert f"{missing} 'Tint'" in " ".join(test_panels.drawn())


def test_the_panel_names_an_image_of_which_tiles_do_not_count():
    obj = scenes.scattered(plate(), count=20)
    image = obj.dapple.color_image = bpy.data.images.new("Tinted", 4, 4, tiled=True)
    said = "Of the UDIM tiles of 'Tinted' only the first one counts"
    assert said not in " ".join(test_panels.drawn())  # there is one
    image.tiles.new(tile_number=1002)
    assert said in " ".join(test_panels.drawn())


def test_each_object_type_and_each_frame_of_a_bake_has_it():
    surface = scenes.tail(levels=0, render_levels=0)
    ramp(surface)
    obj = scenes.scattered(surface, count=40)
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    obj.dapple.color_attribute = "Tint"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    seen = []
    for frame in (1, 6):
        bpy.context.scene.frame_set(frame)
        _, colors = shown(obj)
        assert len(colors) == 40
        assert np.ptp(colors[:, 0]) > 0.2
        seen.append(colors)
    assert np.abs(seen[0] - seen[1]).max() < 0.35, "the color goes with the surface"


def test_several_objects_as_one_surface_have_it():
    for x in (0.0, 3.0):
        surface = plate()
        surface.location.x = x
        ramp(surface)
    for one in bpy.data.objects:
        one.select_set(True)
    assert bpy.ops.dapple.add_scatter(count=60) == {"FINISHED"}
    obj = bpy.context.object
    obj.dapple.color_attribute, obj.dapple.color_image = "Tint", checks()
    assert "has no attribute" not in " ".join(test_panels.drawn())
    places, colors = shown(obj)
    assert (places[:, 0] > 1.5).sum() > 20
    assert np.ptp(colors[places[:, 0] > 1.5, 0]) > 0.2
