# SPDX-License-Identifier: GPL-3.0-or-later
"""The mask Material: points on the faces of chosen materials."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
import test_panels
from face_scenes import FLAT, choose, cube, on_top, optimized, with_materials


def inside_bottom(points):
    """Which points (n,) are on the bottom of a cube, and not on its edges."""
    inside = np.abs(points[:, :2]).max(axis=1) < 1.0 - FLAT
    return inside & (points[:, 2] < -1.0 + FLAT)


def sides(center):
    """Soil on the walls, grass on top, stone below."""
    return 1 if center[2] > 0.9 else 2 if center[2] < -0.9 else 0


def test_points_are_on_the_faces_of_one_material():
    obj = scenes.scattered(with_materials(cube(), sides), count=300)
    choose(obj, "Grass")
    assert on_top(optimized(obj, use_material=True)) == 300
    assert on_top(optimized(obj, material_invert=True)) == 0
    found = optimized(obj, material_invert=False, material_strength=0.5)
    assert on_top(found) == pytest.approx(300 * 4.0 / (4.0 + 0.5 * 20.0), abs=8)


def test_points_are_on_the_faces_of_several_materials():
    obj = scenes.scattered(with_materials(cube(), sides), count=300)
    choose(obj, "Grass", "Stone", "Grass")
    assert len(obj.dapple.density.materials) == 2
    found = optimized(obj, use_material=True)
    assert (np.abs(found[:, 2]) > 1.0 - FLAT).all()
    assert bpy.ops.dapple.remove_material(index=0) == {"FINISHED"}
    assert (optimized(obj)[:, 2] < -1.0 + FLAT).all()


def test_a_material_mask_without_a_material_has_no_effect():
    obj = scenes.scattered(with_materials(cube(), sides), count=300)
    before = scenes.positions(obj)
    assert np.array_equal(optimized(obj, use_material=True), before)


def test_a_renamed_material_is_the_same():
    surface = with_materials(cube(), sides)
    obj = scenes.scattered(surface, count=100)
    choose(obj, "Grass")
    optimized(obj, use_material=True)
    stale = addon_host.part("blender.freshness.staleness").stale_reason
    bpy.data.materials["Grass"].name = "Meadow"
    assert stale(obj, bpy.context) == ""
    assert on_top(optimized(obj)) == 100


def test_a_material_that_is_gone_is_named():
    surface = with_materials(cube(), sides)
    obj = scenes.scattered(surface, count=100)
    choose(obj, "Grass")
    optimized(obj, use_material=True)
    surface.data.materials[1] = bpy.data.materials.new("Snow")
    with pytest.raises(RuntimeError, match=r"none of the materials .* asks for: 'Grass'"):
        bpy.ops.dapple.optimize()
    bpy.data.materials.remove(bpy.data.materials["Grass"])
    with pytest.raises(RuntimeError, match=r"none of the materials .* asks for: 'Grass'"):
        bpy.ops.dapple.optimize()
    choose(obj, "Snow")
    assert on_top(optimized(obj)) == 100


def test_the_panel_names_a_material_that_is_gone_and_offers_what_is_there():
    surface = with_materials(cube(), sides)
    obj = scenes.scattered(surface, count=50)
    obj.dapple.density.use_material = True
    assert "No effect yet: choose a material" in " ".join(test_panels.drawn())
    choose(obj, "Grass", "Stone")
    text = " ".join(test_panels.drawn())
    assert "has no material" not in text
    assert text.count("Grass") == text.count("Stone") == 1, "the menu offers others"
    assert text.count("dapple.add_material") == 1
    surface.data.materials.pop(index=1)
    assert "The surface has no material 'Grass'" in " ".join(test_panels.drawn())
    bpy.data.materials.remove(bpy.data.materials["Stone"])
    assert "The surface has no material 'Stone'" in " ".join(test_panels.drawn())


def test_a_material_of_the_object_takes_the_place_of_that_of_its_mesh():
    surface = with_materials(cube(), sides)
    surface.material_slots[0].link = "OBJECT"
    surface.material_slots[0].material = bpy.data.materials.new("Paint")
    obj = scenes.scattered(surface, count=100)
    choose(obj, "Paint")
    assert (np.abs(optimized(obj, use_material=True)[:, 2]) < 1.0 - FLAT).all()


def test_materials_of_modifiers_count():
    surface = cube()
    surface.data.materials.append(bpy.data.materials.new("Wall"))
    surface.data.materials.append(bpy.data.materials.new("Rim"))
    modifier = surface.modifiers.new("Solidify", "SOLIDIFY")
    modifier.thickness, modifier.offset, modifier.material_offset = 0.2, 1.0, 1
    obj = scenes.scattered(surface, count=100)
    choose(obj, "Rim")
    found = optimized(obj, use_material=True)
    inner = np.abs(found).max(axis=1)
    choose(obj, "Wall")
    bpy.ops.dapple.remove_material(index=0)
    outer = np.abs(optimized(obj)).max(axis=1)
    assert np.ptp(inner) < FLAT
    assert np.ptp(outer) < FLAT
    assert abs(inner[0] - outer[0]) > 0.1


def test_materials_that_nodes_set_count():
    surface = cube()
    builder = addon_host.part("nodes.builder")
    geometry = [("Geometry", "NodeSocketGeometry")]
    tree = builder.new_group("Cover", geometry, geometry)
    b = builder.Builder(tree)
    up = b.node("ShaderNodeSeparateXYZ", b.out("GeometryNodeInputNormal")).outputs["Z"]
    node = tree.nodes.new("GeometryNodeSetMaterial")
    node.inputs["Material"].default_value = bpy.data.materials.new("Snow")
    tree.links.new(b.input("Geometry"), node.inputs["Geometry"])
    tree.links.new(b.compare("GREATER_THAN", up, 0.5, "FLOAT"), node.inputs["Selection"])
    b.output("Geometry", node.outputs[0])
    surface.modifiers.new("Cover", "NODES").node_group = tree
    obj = scenes.scattered(surface, count=100)
    shown = addon_host.part("blender.density.panel")
    assert "Snow" in shown.MATERIALS.of(obj)
    choose(obj, "Snow")
    assert on_top(optimized(obj, use_material=True)) == 100


def test_materials_of_parts_count_on_a_joined_surface():
    first = with_materials(cube(), sides)
    bpy.ops.mesh.primitive_cube_add(location=(5.0, 0.0, 0.0))
    second = with_materials(bpy.context.object, sides, ("Brick", "Stone", "Grass"))
    first.select_set(True)
    bpy.context.view_layer.objects.active = first
    assert bpy.ops.dapple.add_scatter(count=200) == {"FINISHED"}
    obj = bpy.context.object
    shown = addon_host.part("blender.density.panel")
    assert shown.MATERIALS.of(obj) == ("Soil", "Grass", "Stone", "Brick")
    choose(obj, "Grass")
    found = optimized(obj, use_material=True)
    on_first, on_second = found[found[:, 0] < 2.5], found[found[:, 0] > 2.5]
    assert on_top(on_first) == len(on_first) == 100
    assert (on_second[:, 2] < -1.0 + FLAT).all()
    assert second.data.materials[1].name == "Stone"


def test_an_assignment_to_other_faces_is_noticed(live):
    surface = with_materials(cube(), sides)
    obj = scenes.scattered(surface, count=100)
    choose(obj, "Grass")
    optimized(obj, use_material=True)
    stale = addon_host.part("blender.freshness.staleness").stale_reason
    assert stale(obj, bpy.context) == ""
    for one in surface.data.polygons:
        one.material_index = 1 - sides(one.center) // 2
    surface.data.update()
    said = "Materials of 'Cube' were assigned to other faces: optimize again"
    assert stale(obj, bpy.context) == said
    obj.dapple.auto_update_mode = "ON"
    assert live.settle() > 0
    found = scenes.positions(obj)
    assert not inside_bottom(found).any()


def test_other_materials_in_the_slots_are_followed(live):
    surface = with_materials(cube(), sides)
    obj = scenes.scattered(surface, count=100)
    choose(obj, "Grass")
    optimized(obj, use_material=True)
    obj.dapple.auto_update_mode = "ON"
    live.settle()
    surface.data.materials[0] = bpy.data.materials["Grass"]
    assert live.settle() > 0
    assert on_top(scenes.positions(obj)) < 50
    surface.material_slots[0].link = "OBJECT"
    surface.material_slots[0].material = bpy.data.materials["Stone"]
    assert live.settle() > 0
    assert on_top(scenes.positions(obj)) == 100
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.remove_material(index=0) == {"FINISHED"}
    assert live.settle() > 0
    assert on_top(scenes.positions(obj)) < 50
