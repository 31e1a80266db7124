# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie on each other count as one, the panel says how many, and a setting keeps them."""

import bmesh
import bpy
import numpy as np
import pytest
import scenes


def shown(obj, make):
    """The object with a mesh that `make` changes in bmesh."""
    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    make(mesh)
    mesh.to_mesh(obj.data)
    mesh.free()
    return obj


def double(mesh):
    bmesh.ops.duplicate(mesh, geom=[*mesh.verts, *mesh.edges, *mesh.faces])


def double_turned(mesh):
    found = bmesh.ops.duplicate(mesh, geom=[*mesh.verts, *mesh.edges, *mesh.faces])
    faces = [item for item in found["geom"] if isinstance(item, bmesh.types.BMFace)]
    bmesh.ops.reverse_faces(mesh, faces=faces)


def scattered(obj, count):
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.ops.dapple.add_scatter(count=count)
    return bpy.context.object


@pytest.mark.parametrize("again", [double, double_turned])
def test_a_doubled_cube_gets_as_many_points_as_another(addon, again):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    shown(cube, again)
    bpy.ops.mesh.primitive_cube_add(location=(5, 0, 0))
    cube.select_set(True)
    bpy.context.view_layer.objects.active = cube
    bpy.ops.object.join()
    scatter = scattered(cube, 1200)
    assert scatter.dapple.report.doubled_faces == 12
    lines = addon.blender.solve.results_panel.result_lines(scatter, bpy.context)
    assert ("12 doubled faces count once", "INFO") in lines
    assert abs(np.count_nonzero(scenes.positions(scatter)[:, 0] < 2.5) - 600) <= 1


def test_a_ground_doubled_with_turned_normals_is_one_ground(addon):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=10, y_subdivisions=10)
    ground = shown(bpy.context.object, double_turned)
    scatter = scattered(ground, 500)
    report = scatter.dapple.report
    assert report.doubled_faces == 200
    assert report.alpha_mean > 0.75
    scatter.dapple.merge_doubled = False
    bpy.context.view_layer.objects.active = scatter
    bpy.ops.dapple.optimize()
    assert scatter.dapple.report.doubled_faces == 0
