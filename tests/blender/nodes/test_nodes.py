# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group alone, on bindings made by hand: one point in the middle of every triangle."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.empty_file  # the node groups are built here


def bound_to_every_triangle(surface):
    """Scatter object with a point in each triangle of a mesh without modifiers; its corners."""
    surface.data.calc_loop_triangles()
    corners = np.array([tri.vertices[:] for tri in surface.data.loop_triangles], dtype=np.int32)
    loops = np.array([tri.loops[:] for tri in surface.data.loop_triangles], dtype=np.int32)
    records, solve = addon_host.part("core.surface.records"), addon_host.part("core.solve.solve")
    store = addon_host.part("blender.scatter.store")
    reading = addon_host.part("blender.surface.mesh")
    count = len(corners)
    binding = records.Binding(corners, np.full((count, 3), 1.0 / 3.0), np.zeros(count), loops)
    ids = np.arange(count, dtype=np.int32)
    columns = solve.point_columns(ids, np.zeros_like(ids), seed=0)
    arrays = reading.read_mesh(surface)
    obj = store.new_scatter(surface, bpy.context.scene.collection)
    solved = solve.Scattered(
        binding.positions(arrays.vertices), binding, columns, solve.Report(spacing=0.1)
    )
    store.write_scattered(obj, arrays, solved)
    obj.dapple.random_turn = 0.0
    return obj, corners


def smooth_sphere(scale=(1, 1, 1)):
    """Sphere whose normals are those of its vertices."""
    surface = scenes.sphere(scale)
    bpy.ops.object.shade_smooth()
    return surface


def centers(surface, corners):
    return scenes.world_vertices(surface)[corners].mean(axis=1)


@pytest.mark.parametrize("scale", [(1, 1, 1), (0.5, 1, 2), (-1, 1, 1), (-1, -2, -0.5)])
def test_points_ride_on_a_moved_turned_and_scaled_surface(scale):
    surface = scenes.sphere(scale, location=(1, 2, 3), rotation=(0.1, 0.2, 0.3))
    obj, corners = bound_to_every_triangle(surface)
    found = scenes.positions(obj)
    assert np.allclose(found, centers(surface, corners), rtol=0, atol=1e-5)
    outward = np.einsum("nd,nd->n", found - (1, 2, 3), scenes.rotations(obj)[:, :, 2])
    assert outward.min() > 0.0


def test_the_scatter_object_may_be_moved_and_parented():
    surface = scenes.sphere()
    obj, corners = bound_to_every_triangle(surface)
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    parent.location, parent.scale = (3, 0, 1), (2, 2, 2)
    obj.parent, obj.location = parent, (0, 5, 0)
    assert np.allclose(scenes.positions(obj), centers(surface, corners), rtol=0, atol=1e-5)


def test_x_runs_along_the_first_edge_and_z_along_the_interpolated_normal():
    surface = smooth_sphere((1, 1, 1.5))
    obj, corners = bound_to_every_triangle(surface)
    frames, records = (
        addon_host.part("core.surface.frames"),
        addon_host.part("core.surface.records"),
    )
    vertices, count = scenes.world_vertices(surface), len(corners)
    binding = records.Binding(corners, np.full((count, 3), 1.0 / 3.0), np.zeros(count))
    expected = frames.frames(binding, vertices, frames.smooth(vertices, corners))
    axes = scenes.rotations(obj)
    assert np.einsum("nd,nd->n", axes[:, :, 0], expected.tangent).min() > 0.999
    assert np.einsum("nd,nd->n", axes[:, :, 2], expected.normal).min() > 0.999


def placed(surface, case):
    """A surface that is scaled, and its parent, which may shear it."""
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    surface.parent = parent
    parent.location, surface.rotation_euler = (1, 2, 3), (0.5, 0.6, 0.7)
    parent.scale = {"alike": (3, 3, 3), "sheared": (1, 1, 3), "nearly": (1, 1, 1.2)}[case]
    return parent


@pytest.mark.parametrize("case", ["alike", "sheared", "nearly"])
@pytest.mark.parametrize("moved", [False, True])
def test_instances_stand_on_a_surface_that_is_turned_scaled_or_sheared(case, moved):
    """Where it is neither sheared nor mirrored, they are placed in its own space and moved."""
    surface = smooth_sphere()
    parent = placed(surface, case)
    obj, corners = bound_to_every_triangle(surface)
    if moved:
        obj.location, obj.rotation_euler = (-1, 0, 2), (0.3, 0.2, 0.1)
    parent.rotation_euler = (0.2, 0.4, -0.6)
    frames = addon_host.part("core.surface.frames")
    reading = addon_host.part("blender.surface.mesh")
    bpy.context.view_layer.update()
    arrays = reading.read_mesh(surface)
    binding, _ = addon_host.part("blender.scatter.points").read_binding(obj, len(arrays.vertices))
    expected = frames.frames(binding, arrays.vertices, frames.shading(arrays))
    axes = scenes.rotations(obj)
    assert np.allclose(scenes.positions(obj), centers(surface, corners), rtol=0, atol=1e-5)
    assert np.einsum("nd,nd->n", axes[:, :, 0], expected.tangent).min() > 0.9999
    assert np.einsum("nd,nd->n", axes[:, :, 2], expected.normal).min() > 0.9999


def test_a_change_of_topology_shows_a_warning_and_no_points():
    surface = scenes.sphere()
    obj, corners = bound_to_every_triangle(surface)
    assert len(scenes.positions(obj)) == len(corners)
    assert scenes.node_warnings(obj) == []
    surface.modifiers.new("Subdivision", "SUBSURF")
    assert len(scenes.positions(obj)) == 0
    assert scenes.node_warnings(obj) == [
        "The number of vertices of the surface has changed: optimize the scatter"
    ]


def test_a_removed_surface_shows_a_warning_and_no_points():
    surface = scenes.sphere()
    obj, _ = bound_to_every_triangle(surface)
    bpy.data.objects.remove(surface)
    assert len(scenes.positions(obj)) == 0
    assert len(scenes.node_warnings(obj)) == 1


def test_the_chosen_instance_replaces_the_cone():
    surface = scenes.sphere()
    obj, corners = bound_to_every_triangle(surface)
    bpy.ops.mesh.primitive_cube_add(size=0.1, location=(9, 9, 9))
    cube = bpy.context.object
    obj.dapple.instance = cube
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = [i.object.original for i in depsgraph.object_instances if i.is_instance]
    assert shown == [cube] * len(corners)
    assert np.allclose(scenes.positions(obj), centers(surface, corners), rtol=0, atol=1e-5)


def test_scale_and_its_randomness():
    obj, _ = bound_to_every_triangle(scenes.sphere())
    obj.dapple.scale = 2.0
    lengths = np.linalg.norm(scenes.instance_matrices(obj)[:, :3, 0], axis=1)
    assert np.allclose(lengths, 2.0, atol=1e-5)
    obj.dapple.random_scale_down = 0.5
    lengths = np.linalg.norm(scenes.instance_matrices(obj)[:, :3, 0], axis=1)
    assert lengths.min() >= 1.0 - 1e-5
    assert lengths.max() <= 2.0 + 1e-5
    assert np.ptp(lengths) > 0.8


def test_groups_are_built_once_and_have_no_broken_link():
    nodes = addon_host.part("nodes")
    group = nodes.ensure_group()
    assert nodes.ensure_group() == group
    parts = sorted(tree.name for tree in bpy.data.node_groups if tree != group)
    assert parts == [
        f"Dapple {part}"
        for part in (
            "Alignment",
            "Bound Place",
            "Check",
            "Color",
            "Fit to Spacing",
            "Frame Keys",
            "Instances",
            "Key Point",
            "Orientation",
            "Points",
            "Rest Place",
            "Rest Shape",
            "Shading",
            "Surface",
            "Viewport",
            "Weighted Objects",
        )
    ]
    others = [nodes.ensure_group(classes) for classes in (1, 2, 5)]
    assert len(bpy.data.node_groups) == 1 + len(parts) + len(others) + 1, "parts are shared"
    links = [link for tree in bpy.data.node_groups for link in tree.links]
    assert links
    assert all(link.is_valid for link in links)


def test_a_scatter_of_an_older_version_gets_the_group_of_this_one():
    nodes, builder = addon_host.part("nodes"), addon_host.part("nodes.builder")
    obj = scenes.scattered(scenes.sphere())
    geometry = [("Geometry", "NodeSocketGeometry")]
    old = builder.new_group("Old", [*geometry, ("Keys", "NodeSocketObject")], geometry)
    old[nodes.VERSION_KEY] = 1
    obj.modifiers[0].node_group = old
    assert len(scenes.positions(obj)) == 0
    bpy.context.scene.frame_end = 2
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.modifiers[0].node_group == nodes.ensure_group()
    assert obj.dapple.baked_keys == 2
    assert len(scenes.positions(obj)) == 60


def test_a_bake_with_the_group_of_version_4_is_handed_on_to_the_group_of_this_one():
    nodes = addon_host.part("nodes")
    obj = scenes.scattered(scenes.tail(frames=3))
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(2)
    baked = scenes.positions(obj)
    old = obj.modifiers[0].node_group
    old[nodes.VERSION_KEY] = 4
    old.interface.remove(old.interface.items_tree["Hidden"])  # older versions lack this input
    bpy.ops.dapple.edit_object_types(action="ADD")
    assert obj.modifiers[0].node_group != old
    assert np.allclose(scenes.positions(obj), baked, atol=1e-6)


def rotations_with(obj, **placement):
    for name, value in placement.items():
        setattr(obj.dapple, name, value)
    return scenes.rotations(obj)


def test_things_stand_on_the_surface_or_upright_in_the_world():
    obj, _ = bound_to_every_triangle(scenes.sphere())
    outward = scenes.positions(obj) / np.linalg.norm(scenes.positions(obj), axis=1)[:, None]
    found = rotations_with(obj, random_turn=0.0)
    assert np.einsum("nd,nd->n", found[:, :, 2], outward).min() > 0.99
    found = rotations_with(obj, align_to_normal=0.0)
    assert np.allclose(found[:, :, 2], (0.0, 0.0, 1.0), atol=1e-5)
    found = rotations_with(obj, align_to_normal=0.5)
    to_up = np.arccos(np.clip(found[:, 2, 2], -1, 1))
    whole = np.arccos(np.clip(outward[:, 2], -1, 1))
    side = whole < 0.9 * math.pi  # at the lower pole every direction is equally close to up
    assert np.allclose(to_up[side], 0.5 * whole[side], atol=0.05)


@pytest.mark.parametrize("align", [1.0, 1.0 - 1e-6])
def test_a_thing_is_turned_by_the_angle_of_its_key_and_its_own(align):
    surface = smooth_sphere((1, 1, 1.5))
    obj, corners = bound_to_every_triangle(surface)
    frames, records = (
        addon_host.part("core.surface.frames"),
        addon_host.part("core.surface.records"),
    )
    vertices, count = scenes.world_vertices(surface), len(corners)
    carry = np.linspace(-3.0, 3.0, count)
    obj.data.attributes["dapple_angle"].data.foreach_set("value", carry.astype(np.float32))
    own = np.empty(count, dtype=np.float32)
    obj.data.attributes["dapple_turn"].data.foreach_get("value", own)
    binding = records.Binding(corners, np.full((count, 3), 1.0 / 3.0), carry)
    normals = frames.smooth(vertices, corners)
    expected = frames.frames(binding, vertices, normals).direction(carry + 0.5 * own)
    found = rotations_with(obj, align_to_normal=align, random_turn=0.5)
    assert np.einsum("nd,nd->n", found[:, :, 0], expected).min() > 0.999


def test_things_lean_as_far_as_they_may_each_its_own_way():
    obj, _ = bound_to_every_triangle(scenes.sphere())
    straight = rotations_with(obj, random_turn=1.0)
    leaning = rotations_with(obj, random_tilt=0.5)
    angle = np.arccos(np.clip(np.einsum("nd,nd->n", straight[:, :, 2], leaning[:, :, 2]), -1, 1))
    assert 0.45 < angle.max() <= 0.5 + 1e-4
    assert angle.min() < 0.1
    way = np.einsum("nda,nd->na", straight[:, :, :2], leaning[:, :, 2])
    turn = np.arctan2(way[:, 1], way[:, 0])
    assert abs(np.exp(1j * turn).mean()) < 0.15


def test_things_are_smaller_where_the_density_is_less():
    obj, _ = bound_to_every_triangle(scenes.sphere())
    density = np.linspace(0.2, 1.0, len(obj.data.vertices)).astype(np.float32)
    obj.data.attributes["dapple_density"].data.foreach_set("value", density)
    obj.dapple.density_scale = 0.5
    sizes = np.linalg.norm(scenes.instance_matrices(obj)[:, :3, 0], axis=1)
    assert np.allclose(sizes, 1.0 - 0.5 * (1.0 - density), atol=1e-5)


def test_a_tick_of_a_slider_does_not_build_the_relations_of_the_scene():
    """That takes longer the more objects there are; the scene is listed only then."""
    obj = scenes.scattered(scenes.sphere())
    bpy.ops.dapple.edit_object_types(action="ADD")
    bpy.ops.dapple.edit_object_types(action="ADD")
    bpy.context.view_layer.update()
    kinds = []

    def updated(_scene, depsgraph):
        kinds.extend(type(one.id).__name__ for one in depsgraph.updates)

    bpy.app.handlers.depsgraph_update_post.append(updated)
    try:
        obj.dapple.object_types[1].scale = 2.0
        bpy.context.view_layer.update()
        assert "Object" in kinds
        assert "Scene" not in kinds
        kinds.clear()
        obj.dapple.object_types[1].instance = obj.dapple.surface
        bpy.context.view_layer.update()
        assert "Scene" in kinds
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(updated)
