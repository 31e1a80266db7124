# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a surface that are too small for a whole point: counted, named and selected."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def bolts(count=3, size=0.05):
    """Small cubes in a row, away from everything else."""
    found = []
    for k in range(count):
        bpy.ops.mesh.primitive_cube_add(size=size, location=(2.0 + 0.3 * k, 0.0, 0.0))
        found.append(bpy.context.object)
        found[-1].name = f"Bolt {k}"
    return found


def over(*objects, count=100):
    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    assert bpy.ops.dapple.add_scatter(count=count) == {"FINISHED"}
    return bpy.context.object


def line(obj):
    lines = addon_host.part("blender.solve.results_panel").figure_lines(obj)
    return [text for text, _ in lines if "too small" in text]


def joined(material=None):
    """A ball and bolts as one mesh."""
    ball, small = scenes.sphere(), bolts()
    for one in small if material else ():
        one.data.materials.append(bpy.data.materials.new("Steel"))
    for one in small:
        one.select_set(True)
    ball.select_set(True)
    bpy.context.view_layer.objects.active = ball
    bpy.ops.object.join()
    return ball


def select():
    assert bpy.ops.dapple.select_small_parts() == {"FINISHED"}
    return {obj.name for obj in bpy.context.selected_objects}


def test_small_objects_of_a_surface_are_counted_and_selected():
    ball, small = scenes.sphere(), bolts()
    obj = over(ball, *small)
    assert obj.dapple.report.small_parts == 3
    assert line(obj) == ["3 parts are too small for a whole point"]
    assert select() == {"Bolt 0", "Bolt 1", "Bolt 2"}
    assert bpy.context.object in small


def test_they_are_named():
    ball, small = scenes.sphere(), bolts(5)
    obj = over(ball, *small)
    module = addon_host.part("blender.solve.small_parts")
    found = module.small_parts_of(obj)
    assert [part.object for part in found] == small
    assert [len(part.polygons) for part in found] == [6] * 5
    assert module.names_of(found) == "Bolt 0 (1), Bolt 1 (1), Bolt 2 (1), ..."


def test_faces_of_one_mesh_are_selected_and_named_after_their_material():
    ball = joined(material="Steel")
    faces = len(ball.data.polygons)
    obj = over(ball)
    assert obj.dapple.report.small_parts == 3
    module = addon_host.part("blender.solve.small_parts")
    assert module.names_of(module.small_parts_of(obj)) == "Steel (1), Steel.001 (1), Steel.002 (1)"
    assert select() == {"Sphere"}
    chosen = np.zeros(faces, dtype=bool)
    ball.data.polygons.foreach_get("select", chosen)
    assert chosen.sum() == 18
    centers = np.array([polygon.center[:] for polygon in ball.data.polygons])
    assert (centers[chosen, 0] > 1.5).all()
    ends = np.zeros(len(ball.data.vertices), dtype=bool)
    ball.data.vertices.foreach_get("select", ends)
    assert ends.sum() == 24
    bpy.ops.object.mode_set(mode="EDIT")
    assert ball.data.total_face_sel == 18
    bpy.ops.object.mode_set(mode="OBJECT")


def test_where_modifiers_change_the_faces_the_object_alone_is_selected():
    ball = joined()
    ball.modifiers.new("Finer", "SUBSURF")
    ball.modifiers["Finer"].levels = ball.modifiers["Finer"].render_levels = 1
    over(ball)
    assert select() == {"Sphere"}
    chosen = np.ones(len(ball.data.polygons), dtype=bool)
    ball.data.polygons.foreach_get("select", chosen)
    assert not chosen.any()


def test_with_more_points_no_part_is_too_small():
    ball, small = scenes.sphere(), bolts(1, size=0.3)
    obj = over(ball, *small, count=1500)
    assert obj.dapple.report.small_parts == 0
    assert line(obj) == []
    before = {one.name for one in bpy.context.selected_objects}
    assert select() == before
    obj.dapple.count = 4
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert line(obj) == ["1 part is too small for a whole point"]


def test_what_is_hidden_or_blocked_is_no_part():
    ball, inner = scenes.sphere(), bolts(1)[0]
    inner.location = (0.0, 0.0, 0.0)
    obj = over(ball, inner)
    obj.dapple.density.use_outside = True
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.report.small_parts == 0


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_a_bake_knows_them_too(population):
    ball, small = scenes.sphere(), bolts()
    obj = over(ball, *small)
    obj.dapple.population = population
    bpy.context.scene.frame_end = 2
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.report.small_parts == 3
