# SPDX-License-Identifier: GPL-3.0-or-later
"""Ordinary objects and modifiers come out as even as plain ones, or it is said why not."""

import bpy
import numpy as np
import pytest
import scenes


def scattered(count=300):
    bpy.ops.dapple.add_scatter(count=count)
    return bpy.context.object


def monkey(kind=None, **values):
    bpy.ops.mesh.primitive_monkey_add()
    if kind:
        modifier = bpy.context.object.modifiers.new(kind, kind)
        for name, value in values.items():
            setattr(modifier, name, value)
    return bpy.context.object


@pytest.mark.parametrize("angle", [0.0, np.radians(30)])
def test_split_edges_are_no_walls(angle):
    monkey()
    plain = scattered().dapple.report
    monkey("EDGE_SPLIT", split_angle=angle)
    split = scattered().dapple.report
    assert split.capacity_variation <= 1.3 * plain.capacity_variation
    assert split.alpha_min >= plain.alpha_min - 0.03
    assert split.evaluations <= 1.2 * plain.evaluations


def test_split_edges_stay_even_in_a_bake():
    bpy.context.scene.frame_end = 3
    bpy.ops.mesh.primitive_cube_add()
    surface = bpy.context.object
    surface.modifiers.new("Split", "EDGE_SPLIT")
    for frame, scale in ((1, 1.0), (3, 1.1)):
        surface.scale.z = scale
        surface.keyframe_insert("scale", frame=frame)
    scatter = scattered()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert scatter.dapple.report.capacity_variation < 0.02
    assert scatter.dapple.report.alpha_min > 0.6


def test_a_mirror_over_itself_is_like_two_sheets():
    monkey("MIRROR")
    report = scattered().dapple.report
    assert report.capacity_variation < 0.1, "0.36 while steps hopped between the halves"


def test_whole_counts_on_separate_parts_are_said(addon):
    vertices, faces = [], []
    for k in range(60):
        faces.append([len(vertices) + c for c in range(4)])
        size = 0.1 + 0.01 * k
        vertices += [(k, 0, 0), (k + size, 0, 0), (k + size, size, 0), (k, size, 0)]
    mesh = bpy.data.meshes.new("Leaves")
    mesh.from_pydata(vertices, [], faces)
    obj = bpy.data.objects.new("Leaves", mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    scatter = scattered(120)
    assert scatter.dapple.report.whole_count_variation > 0.1
    lines = [text for text, _ in addon.blender.solve.results_panel.figure_lines(scatter)]
    assert any("whole counts" in line for line in lines)


def test_a_double_sided_ground_is_even():
    """Both sides' quads were cut along different lines, so each side got half of the points."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12)
    single = scattered().dapple.report
    ground = bpy.context.object.dapple.surface.data
    vertices = [tuple(vertex.co) for vertex in ground.vertices]
    faces = [tuple(polygon.vertices) for polygon in ground.polygons]
    mesh = bpy.data.meshes.new("Ground")
    mesh.from_pydata(vertices, [], faces + [face[::-1] for face in faces])
    obj = bpy.data.objects.new("Ground", mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    double = scattered()
    assert double.dapple.report.alpha_min == pytest.approx(single.alpha_min, abs=0.05)
    axes = scenes.instance_matrices(double)[:, :3, 2]
    z = axes[:, 2] / np.linalg.norm(axes, axis=1)
    assert min(z) > 0.99, "no instance hangs upside down"
