# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of the density that move during a bake: objects, scatters, the camera, values."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import linked, note, reason
from stopped_bakes import stop_after

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
    scenes.activate(surface)
    obj = scenes.scattered(surface, count)
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def baked(surface, population="KEEP_COUNT", **density):
    obj = scatter_on(surface, **density)
    obj.dapple.population = population
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


def each_frame(obj):
    """Places of the points that are there, frame by frame."""
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        yield scenes.positions(obj)


def inside(points, box):
    """Number of points in the current cube."""
    local = (np.array(box.matrix_world.inverted()) @ np.c_[points, np.ones(len(points))].T)[:3]
    half = np.abs(np.array(box.bound_box)).max(axis=0)[:, None] * (1.0 - 1e-5)
    return int((np.abs(local) < half).all(axis=0).sum())


def moving_cube():
    box = keyed(cube(), (-1.5, 0.0, 0.0), (0.5, 0.3, 0.0))
    avoided = bpy.data.collections["Avoided"]
    return {"avoid_collection": avoided}, lambda points: inside(points, box)


def moving_camera():
    made = linked(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    bpy.context.scene.camera = made
    bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 100
    keyed(made, (-1.0, 0.0, 2.0), (0.5, 0.0, 2.0))
    half = 2.0 * np.tan(0.5 * made.data.angle) * 1.02

    def outside(points):
        return int((np.abs(points[:, :2] - np.array(made.location)[:2]) > half).any(axis=1).sum())

    return {"use_camera_view": True, "camera_margin": 0.0}, outside


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
        return int((away < 0.55).sum())  # faces at the border extend inward by less

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
    obj = baked(surface, population, avoid_collection=collection, avoid_margin=0.1)
    for points in each_frame(obj):
        there = scenes.positions(avoided)
        apart = np.linalg.norm(points[:, None] - there[None], axis=2).min(axis=1)
        assert apart.min() > 0.1 - 1e-4


def panel_note(obj):
    return addon_host.part("blender.freshness.content_changes").frozen_note(obj)


@pytest.mark.parametrize(("name", "value"), [("masks", "FIRST_FRAME"), ("smoothing", "BOTH_WAYS")])
def test_what_moves_and_is_not_followed_is_said(name, value):
    surface = ground()
    density, wrong = moving_cube()
    obj = scatter_on(surface, **density)
    setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert max(wrong(points) for points in each_frame(obj)) > 0
    said = "The density is that of frame 1, although these move: avoided objects"
    assert panel_note(obj) == said
    setattr(obj.dapple, name, "EACH_FRAME" if name == "masks" else "FORWARD")
    assert reason(obj).startswith("Settings were changed (")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert max(wrong(points) for points in each_frame(obj)) == 0
    assert panel_note(obj) == ""


def test_a_density_that_does_not_move_is_baked_as_on_the_first_frame():
    surface = scenes.tail(frames=FRAMES)
    surface.vertex_groups.new(name="Some").add(range(40), 1.0, "REPLACE")
    obj = scatter_on(surface, attribute="Some")
    found = []
    for masks in ("FIRST_FRAME", "EACH_FRAME"):
        obj.dapple.masks = masks
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert panel_note(obj) == ""
        found.append(addon_host.part("blender.scatter.key_stores").read_baked(obj).keys)
    for name, values in found[0].items():
        assert found[1][name].tobytes() == values.tobytes()


def test_points_stay_even_beside_what_moves():
    surface = ground()
    density, _ = moving_cube()
    obj = baked(surface, **density)
    report = obj.dapple.report
    assert report.alpha_min > 0.4
    assert report.capacity_variation < 0.1


def test_noise_rides_with_a_surface_that_is_masked_anew_on_each_frame():
    surface = keyed(ground(), (0.0, 0.0, 0.0), (0.0, 7.0, 0.0))
    keyed(cube(), (9.0, 9.0, 0.0), (9.0, 9.0, 5.0))  # far away
    avoided = bpy.data.collections["Avoided"]
    noise = {"use_noise": True, "noise_size": 0.5, "noise_min": 0.5}
    obj = baked(surface, avoid_collection=avoided, **noise)
    local = [points - np.array(surface.location) for points in each_frame(obj)]
    assert np.linalg.norm(local[-1] - local[0], axis=1).max() < 0.5 * obj.dapple.report.spacing


def test_a_stopped_bake_of_moving_masks_goes_on_to_the_same_bytes():
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    surface, found = ground(), []
    density, _ = moving_cube()
    for population in ("KEEP_COUNT", "KEEP_DENSITY"):
        for stopped in (False, True):
            obj = scatter_on(surface, **density)
            obj.dapple.population = population
            if stopped:
                stop_after(6, FRAMES)
            baker = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
            assert baker.taken == (3 if stopped else 0)
            found.append(addon_host.part("blender.scatter.key_stores").read_baked(obj).keys)
        for name, values in found[-2].items():
            assert found[-1][name].tobytes() == values.tobytes()


def test_a_bake_that_was_stopped_after_its_masks_came_to_rest_goes_on_to_the_same_bytes():
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    surface, found = ground(), []
    box = cube()
    for frame, place in ((1, -1.0), (3, -0.5)):
        box.location.x = place
        box.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    for stopped in (False, True):
        obj = scatter_on(surface, avoid_collection=bpy.data.collections["Avoided"])
        if stopped:
            stop_after(8, FRAMES)
        baker = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
        assert baker.taken == (4 if stopped else 0)
        found.append(addon_host.part("blender.scatter.key_stores").read_baked(obj).keys)
    for name, values in found[0].items():
        assert found[1][name].tobytes() == values.tobytes()


def test_points_stay_even_where_faces_change():
    surface = ground(size=2.0, cuts=20)
    surface.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.5
    box = keyed(cube(size=0.5), (-0.3, 0.0, 0.0), (0.3, 0.0, 0.0))
    joined = surface.modifiers.new("Boolean", "BOOLEAN")
    joined.object, joined.solver, joined.operation = box, "FAST", "UNION"
    bpy.context.scene.frame_set(1)
    variations = []
    for seed in range(4):
        obj = scatter_on(surface, 200)
        obj.dapple.seed = seed
        assert bpy.ops.dapple.optimize() == {"FINISHED"}
        obj.dapple.new_topology = "REATTACH"
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert obj.dapple.report.alpha_min > 0.35
        variations.append(obj.dapple.report.capacity_variation)
    assert np.mean(variations) < 0.08
