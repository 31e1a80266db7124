# SPDX-License-Identifier: GPL-3.0-or-later
"""What the density reads moves during a bake: objects, scatters, the camera, values."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import linked, note, reason

FRAMES, COUNT = 6, 300


def ground(size=4.0, cuts=24):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cuts, y_subdivisions=cuts, size=size)
    bpy.context.scene.frame_end = FRAMES
    return bpy.context.object


def keyed(obj, begin, end):
    """An object that goes from one place to another in all frames."""
    for frame, place in ((1, begin), (FRAMES, end)):
        obj.location = place
        obj.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    return obj


def cube(collection="Avoided", size=0.8):
    bpy.ops.mesh.primitive_cube_add(size=size)
    made = bpy.context.object
    bpy.context.scene.collection.objects.unlink(made)
    found = bpy.data.collections.get(collection)
    if found is None:
        found = bpy.data.collections.new(collection)
        bpy.context.scene.collection.children.link(found)
    found.objects.link(made)
    return made


def scatter_on(surface, count=COUNT, **density):
    scenes._activate(surface)
    obj = scenes.scattered(surface, count)
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def baked(surface, population="KEEP_COUNT", **density):
    obj = scatter_on(surface, **density)
    obj.dapple.count_over_time = population
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


def each_frame(obj):
    """Places of the points that are there, frame by frame."""
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        yield scenes.positions(obj)


def inside(points, box):
    """How many points are in a cube, as it is now."""
    local = (np.array(box.matrix_world.inverted()) @ np.c_[points, np.ones(len(points))].T)[:3]
    half = np.abs(np.array(box.bound_box)).max(axis=0)[:, None] * (1.0 - 1e-5)
    return int((np.abs(local) < half).all(axis=0).sum())


def moving_cube():
    box = keyed(cube(), (-1.5, 0.0, 0.0), (0.5, 0.3, 0.0))
    avoided = bpy.data.collections["Avoided"]
    return {"obstacles": avoided}, lambda points: inside(points, box)


def moving_camera():
    made = linked(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    bpy.context.scene.camera = made
    bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 100
    keyed(made, (-1.0, 0.0, 2.0), (0.5, 0.0, 2.0))
    half = 2.0 * np.tan(0.5 * made.data.angle) * 1.02

    def outside(points):
        return int((np.abs(points[:, :2] - np.array(made.location)[:2]) > half).any(axis=1).sum())

    return {"use_camera": True, "camera_margin": 0.0}, outside


def moving_values():
    surface = bpy.data.objects["Grid"]
    surface.vertex_groups.new(name="Near").add(range(len(surface.data.vertices)), 1.0, "REPLACE")
    mesh = bpy.data.meshes.new("Target")
    mesh.from_pydata([(0.0, 0.0, 0.0)], [], [])
    target = keyed(linked(bpy.data.objects.new("Target", mesh)), (-1.5, 0, 0), (0.5, 0.3, 0))
    changed = surface.modifiers.new("Proximity", "VERTEX_WEIGHT_PROXIMITY")
    changed.vertex_group, changed.target = "Near", target
    changed.proximity_mode, changed.proximity_geometry = "GEOMETRY", {"VERTEX"}
    changed.min_dist, changed.max_dist = 0.8, 1.0

    def at_zero(points):
        away = np.linalg.norm(points - np.array(target.matrix_world.translation), axis=1)
        return int((away < 0.55).sum())  # faces at the border reach in by less

    return {"attribute": "Near"}, at_zero


MOVING = {"cube": moving_cube, "camera": moving_camera, "values": moving_values}


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
@pytest.mark.parametrize("what", MOVING)
def test_points_leave_what_moves_over_them(what, population):
    surface = ground()
    density, wrong = MOVING[what]()
    obj = baked(surface, population, **density)
    counts = [(wrong(points), len(points)) for points in each_frame(obj)]
    assert [one for one, _ in counts] == [0] * FRAMES
    if population == "KEEP_COUNT":
        assert {count for _, count in counts} == {COUNT}
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        assert reason(obj) == note(obj) == ""


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_points_leave_a_scatter_that_moves_as_it_was_baked(population):
    other = ground(size=1.0, cuts=4)
    other.name = "Raft"
    keyed(other, (-1.2, 0.0, 0.0), (0.4, 0.2, 0.0))
    avoided = baked(other)
    surface = ground()
    collection = bpy.data.collections.new("Avoided")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(avoided)
    obj = baked(surface, population, obstacles=collection, obstacle_margin=0.1)
    for points in each_frame(obj):
        there = scenes.positions(avoided)
        apart = np.linalg.norm(points[:, None] - there[None], axis=2).min(axis=1)
        assert apart.min() > 0.1 - 1e-4
