# SPDX-License-Identifier: GPL-3.0-or-later
"""Wires, ropes and ribbons are even along their length, and the panel says no spacing of them."""

import bpy
import numpy as np
import pytest


def strewn(make, count):
    make()
    bpy.ops.dapple.add_scatter(count=count)
    return bpy.context.object


def polyline(paths, radius):
    curve = bpy.data.curves.new("Wires", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.use_fill_caps = "3D", radius, True
    for path in paths:
        spline = curve.splines.new("POLY")
        spline.points.add(len(path) - 1)
        for point, place in zip(spline.points, path, strict=True):
            point.co = (*place, 1)
    obj = bpy.data.objects.new("Wires", curve)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


def fence():
    polyline([[(0, 0.1 * wire, 0), (2, 0.1 * wire, 0)] for wire in range(20)], 0.002)


def rope():
    turns = 2 * np.pi * np.linspace(0, 3, 200)
    polyline([np.column_stack([np.cos(turns), np.sin(turns), turns / 12])], 0.01)


def ribbon():
    bpy.ops.mesh.primitive_plane_add(size=1)
    bpy.context.object.scale = (4, 0.01, 1)


def plate():
    bpy.ops.mesh.primitive_cube_add(size=1, scale=(1, 1, 0.002))


def thick_sheet():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=1)
    modifier = bpy.context.object.modifiers.new("Solidify", "SOLIDIFY")
    modifier.thickness = 0.006


@pytest.mark.parametrize("make", [plate, thick_sheet])
def test_plates_and_solidified_sheets_are_even_on_both_sides(addon, make):
    report = strewn(make, 1000).dapple.report
    assert report.capacity_variation <= 0.01
    assert report.evaluations <= 40
    assert report.alpha_min > 0.6


@pytest.mark.parametrize(("make", "count"), [(fence, 200), (rope, 100), (ribbon, 60)])
def test_thin_bodies_are_even_and_nothing_is_said_of_a_spacing(addon, make, count):
    scatter = strewn(make, count)
    report = scatter.dapple.report
    assert report.capacity_variation <= 0.01
    assert report.evaluations <= 40
    assert report.converged
    assert report.thin_share == 1.0
    results = addon.blender.solve.results_panel
    lines = [text for text, _ in results.result_lines(scatter, bpy.context)]
    figures = [text for text, _ in results.figure_lines(scatter)]
    assert not [line for line in (*lines, *figures) if "of ideal" in line]
    assert "area variation" in lines[0]
    assert "100 % of the points are on parts thinner than the spacing" in figures


def shell_of_a_head(thickness):
    bpy.ops.mesh.primitive_monkey_add()
    head = bpy.context.object
    head.modifiers.new("Subdivision", "SUBSURF").levels = 2
    head.modifiers.new("Solidify", "SOLIDIFY").thickness = thickness


@pytest.mark.parametrize("thickness", [0.03, 0.06])
def test_a_shell_of_a_head_is_as_even_inside_as_outside(thickness):
    obj = strewn(lambda: shell_of_a_head(thickness), 1500)
    assert obj.dapple.report.capacity_variation < 0.05
    assert obj.dapple.report.evaluations < 40
