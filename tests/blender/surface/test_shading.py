# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances follow the shading of a surface: flat faces, sharp edges, custom normals, smooth."""

import itertools

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from mathutils.geometry import barycentric_transform


def degrees_off(obj, surface, offset=0.0):
    """Angles (n,) between the instances and the surface's shading normals where they stand."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    matrices = scenes.instance_matrices(obj, depsgraph)
    axes = matrices[:, :3, 2] / np.linalg.norm(matrices[:, :3, 2], axis=1, keepdims=True)
    places = matrices[:, :3, 3] - offset * axes
    evaluated = surface.evaluated_get(depsgraph)
    matrix, mesh = evaluated.matrix_world, evaluated.to_mesh()
    mesh.calc_loop_triangles()
    vertices = [matrix @ vertex.co for vertex in mesh.vertices]
    triangles = [list(triangle.vertices) for triangle in mesh.loop_triangles]
    turned = matrix.to_3x3().inverted().transposed()
    normals = [turned @ normal.vector for normal in mesh.corner_normals]
    loops = [triangle.loops[:] for triangle in mesh.loop_triangles]
    tree, found = BVHTree.FromPolygons(vertices, triangles), []
    for place, axis in zip(places, axes, strict=True):
        near = tree.find_nearest_range(Vector(place), 2e-4)
        assert near, f"an instance at {place} is off the surface"
        angles = []
        for *_, index, _ in near:
            where = [vertices[v] for v in triangles[index]]
            normal = barycentric_transform(
                Vector(place), *where, *(normals[k] for k in loops[index])
            )
            cosine = np.clip(np.dot(normal.normalized(), axis), -1.0, 1.0)
            angles.append(np.degrees(np.arccos(cosine)))
        found.append(min(angles))
    evaluated.to_mesh_clear()
    return np.array(found)


def cube():
    bpy.ops.mesh.primitive_cube_add()
    return bpy.context.object


def smooth_cube_with_sharp_edges():
    obj = cube()
    bpy.ops.object.shade_smooth()
    for edge in obj.data.edges:
        edge.use_edge_sharp = True
    return obj


def cube_with_one_flat_face():
    obj = cube()
    bpy.ops.object.shade_smooth()
    obj.data.polygons[3].use_smooth = False
    return obj


def beveled_cube():
    obj = cube()
    bevel = obj.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.05, 2
    return obj


def flat_cylinder():
    bpy.ops.mesh.primitive_cylinder_add(vertices=12)
    return bpy.context.object


def cylinder_smooth_by_angle():
    obj = flat_cylinder()
    bpy.ops.object.shade_smooth()
    obj.data.set_sharp_from_angle(angle=0.6)
    return obj


def smooth_monkey():
    bpy.ops.mesh.primitive_monkey_add()
    bpy.ops.object.shade_smooth()
    return bpy.context.object


def flat_monkey():
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.object


def text():
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.2
    return bpy.context.object


def cube_with_custom_normals():
    obj = cube()
    bpy.ops.object.shade_smooth()
    random = np.random.default_rng(4)
    own = random.normal(size=(len(obj.data.loops), 3)) * 0.3
    own += [polygon.normal for polygon in obj.data.polygons for _ in polygon.loop_indices]
    obj.data.normals_split_custom_set((own / np.linalg.norm(own, axis=1)[:, None]).tolist())
    return obj


def subdivided_cube():
    obj = smooth_cube_with_sharp_edges()
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type, modifier.render_levels = "SIMPLE", 1
    return obj


SURFACES = [
    cube,
    smooth_cube_with_sharp_edges,
    cube_with_one_flat_face,
    beveled_cube,
    flat_cylinder,
    cylinder_smooth_by_angle,
    smooth_monkey,
    flat_monkey,
    text,
    subdivided_cube,
]
if bpy.app.version >= (4, 4):  # nodes of older versions ignore custom normals
    SURFACES.append(cube_with_custom_normals)


@pytest.mark.parametrize("make", SURFACES, ids=lambda make: make.__name__)
@pytest.mark.parametrize("bound", ["FACES", "REST"])
def test_instances_stand_along_the_shading_normal(make, bound):
    surface = make()
    if bound == "REST" and surface.type != "MESH":
        pytest.skip("only meshes have rest positions")
    assert bpy.ops.dapple.add_scatter(count=150, attach_to=bound) == {"FINISHED"}
    obj = bpy.context.object
    assert obj.dapple.attached_to == bound
    assert degrees_off(obj, surface).max() < 0.5


@pytest.mark.parametrize("scale", [(1, 2, 0.5), (-1, 1, 1), (-1, -2, -0.5)])
@pytest.mark.parametrize("make", SURFACES, ids=lambda make: make.__name__)
def test_on_a_scaled_or_mirrored_surface_they_stand_as_it_is_shaded(make, scale):
    surface = make()
    surface.scale, surface.rotation_euler, surface.location = scale, (0.3, 0.5, 0.7), (1, 2, 3)
    bpy.context.view_layer.update()
    obj = scenes.scattered(surface, count=60)
    assert degrees_off(obj, surface).max() < 0.5
    check_as_python_says(obj, surface)


def check_as_python_says(obj, surface):
    """Instances without a turn of their own have the axes of core/surface/frames.py."""
    obj.dapple.random_turn = 0.0
    part = addon_host.part
    reading, frames = part("blender.surface.mesh"), part("core.surface.frames")
    arrays = reading.read_mesh(surface)
    binding, _ = part("blender.scatter.points").read_binding(obj, len(arrays.vertices))
    expected = frames.frames(binding, arrays.vertices, frames.shading(arrays)).axes(binding.angle)
    assert np.einsum("nij,nij->nj", scenes.rotations(obj), expected).min() > 0.9999


def test_shading_may_change_later():
    surface = cube()
    obj = scenes.scattered(surface, count=60)
    for change in (bpy.ops.object.shade_smooth, bpy.ops.object.shade_flat):
        bpy.context.view_layer.objects.active = surface
        surface.select_set(True)
        change()
        assert degrees_off(obj, surface).max() < 0.5
    assert np.abs(np.abs(scenes.rotations(obj)[:, :, 2]).max(axis=1) - 1.0).max() < 1e-5


def test_with_an_offset_instances_hang_over_their_own_face():
    obj = scenes.scattered(cube(), count=300)
    obj.dapple.offset = 0.5
    places = np.sort(np.abs(scenes.positions(obj)), axis=1)
    np.testing.assert_allclose(places[:, 2], 1.5, atol=1e-5)
    assert places[:, 1].max() <= 1.0 + 1e-5


def stretched(surface, factors=(3.0, 1.0, 1.0), frames=12):
    """The surface, stretched over these frames by a shape key."""
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Long")
    for point in key.data:
        point.co = [x * factor for x, factor in zip(point.co, factors, strict=True)]
    for frame, value in ((1, 0.0), (frames, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_end = frames
    bpy.context.scene.frame_set(1)
    return surface


def turns(obj, frames):
    """Angles (frames - 1, n) in degrees of the instances from frame to frame."""
    shown = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        shown.append(scenes.rotations(obj))
    traces = [np.einsum("nij,nij->n", *pair) for pair in itertools.pairwise(shown)]
    return np.degrees(np.arccos(np.clip((np.array(traces) - 1.0) / 2.0, -1.0, 1.0)))


@pytest.mark.parametrize("every", [1, 4])
def test_over_a_hard_edge_an_instance_turns_over_some_frames(every):
    surface = stretched(cube())
    obj = scenes.scattered(surface, count=200)
    obj.dapple.keyframe_step, obj.dapple.forward = every, "X"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    found = turns(obj, range(1, 13))
    assert found.max() < 12.0
    assert found.sum(axis=0).max() > 60.0  # some points cross an edge
    bpy.context.scene.frame_set(1)
    assert degrees_off(obj, surface).max() < 0.5


def test_a_bake_stands_along_the_shading_normal():
    surface = stretched(smooth_cube_with_sharp_edges(), factors=(1.3, 1.3, 1.3), frames=4)
    obj = scenes.scattered(surface, count=200)
    obj.dapple.random_turn = 0.0
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame, part in ((1, 0.0), (2, 0.5), (4, 0.0)):
        bpy.context.scene.frame_set(frame, subframe=part)
        assert degrees_off(obj, surface).max() < 0.5


def test_an_export_has_the_shading_normals(tmp_path):
    scenes.scattered(cube(), count=100)
    path = tmp_path / "cones.npz"
    assert bpy.ops.dapple.export_points(filepath=str(path)) == {"FINISHED"}
    with np.load(path) as stored:
        w, x, y, z = stored["orientations"].T
    up = np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    assert np.abs(np.abs(up).max(axis=1) - 1.0).max() < 1e-4


@pytest.mark.parametrize("make", [cube, smooth_monkey, cylinder_smooth_by_angle])
def test_the_package_is_reported_the_shading_normals(make):
    surface = make()
    part = addon_host.part
    reading, settings = part("blender.surface.mesh"), part("core.settings.values")
    arrays = reading.read_mesh(surface)
    ground = part("core.density.masked_surface").masked_surface_of(arrays, settings.Settings())
    told, own = ground.surface.corner_normals, part("core.surface.frames").corner_normals(arrays)
    # equal where the surface is smooth, with other triangles
    np.testing.assert_allclose(told, own, atol=2e-3)


def test_a_preview_stands_along_the_shading_normal():
    surface = flat_cylinder()
    obj = scenes.scattered(surface, count=80)
    part = addon_host.part
    other = scenes.scattered(surface, count=80)
    other.dapple.seed = 5
    bpy.context.view_layer.objects.active = other
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    binding, _ = part("blender.scatter.points").read_binding(other, len(surface.data.vertices))
    before = scenes.positions(obj)
    part("blender.display.preview_steps").show_binding(obj, binding)
    bpy.context.view_layer.update()
    assert np.abs(scenes.positions(obj) - before).max() > 0.1
    assert degrees_off(obj, surface).max() < 0.5


@pytest.mark.parametrize("changed", [cube_with_one_flat_face, subdivided_cube])
def test_reattached_points_stand_along_the_normal_of_their_new_place(changed):
    surface = cube()
    obj = scenes.scattered(surface, count=80)
    surface.data = changed().data
    bpy.data.objects.remove(bpy.context.object)
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.reattach() == {"FINISHED"}
    assert degrees_off(obj, surface).max() < 0.5
