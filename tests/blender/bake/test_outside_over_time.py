# SPDX-License-Identifier: GPL-3.0-or-later
"""Outside Only while a body moves: decided on the first frame, on all frames or on each."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from contents import note, reason

FRAMES, COUNT = 6, 200
SLACK = 0.02  # faces are flat


def moving_balls():
    """A ball that goes into another one, both selected."""
    balls = [scenes.sphere(), scenes.sphere(location=(1.5, 0.1, 0.05))]
    for frame, x in ((1, 1.5), (FRAMES, 0.7)):
        balls[1].location.x = x
        balls[1].keyframe_insert("location", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.frame_set(1)
    for ball in balls:
        ball.select_set(True)
    return balls


def scattered(over_time, **settings):
    balls = moving_balls()
    assert bpy.ops.dapple.add_scatter(count=COUNT) == {"FINISHED"}
    obj = bpy.context.object
    assert obj.dapple.density.use_outside
    obj.dapple.density.outside_over_time = over_time
    for name, value in settings.items():
        setattr(obj.dapple, name, value)
    return obj, balls


def bake(obj):
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.bake() == {"FINISHED"}


def each_frame(obj, balls):
    """Places of the points that are there, and how many of them are in a ball, frame by frame."""
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        points = scenes.positions(obj)
        centers = [np.array(ball.matrix_world.translation) for ball in balls]
        away = np.min([np.linalg.norm(points - center, axis=1) for center in centers], axis=0)
        yield points, int((away < 1.0 - SLACK).sum())


def keys(obj):
    return addon_host.part("blender.scatter.key_stores").read_baked(obj).keys


def test_a_bake_decides_on_its_first_frame_unless_told_otherwise():
    obj, balls = scattered("FIRST_FRAME")
    assert type(obj.dapple.density).bl_rna.properties["outside_over_time"].default == "FIRST_FRAME"
    bake(obj)
    hidden = [count for _, count in each_frame(obj, balls)]
    assert hidden[0] == 0
    assert hidden[-1] > 10


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
@pytest.mark.parametrize("over_time", ["ALL_FRAMES", "EACH_FRAME"])
def test_no_point_is_hidden_on_any_frame(over_time, population):
    obj, balls = scattered(over_time, population=population, fade_duration=1)
    bake(obj)
    found = list(each_frame(obj, balls))
    assert [hidden for _, hidden in found] == [0] * FRAMES
    counts = [len(points) for points, _ in found]
    if population == "KEEP_COUNT":
        assert counts == [COUNT] * FRAMES
    elif over_time == "EACH_FRAME":
        assert counts[-1] < COUNT  # less is seen at the end
    assert obj.dapple.report.capacity_variation < 0.1
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        assert reason(obj) == note(obj) == ""


def test_points_stay_in_their_places_if_all_frames_decide():
    obj, balls = scattered("ALL_FRAMES")
    bake(obj)
    spacing = obj.dapple.report.spacing
    own = [points for points, _ in each_frame(obj, balls)]
    carried = own[-1] - own[0]
    still = np.linalg.norm(carried, axis=1)
    moved = np.linalg.norm(carried - [0.7 - 1.5, 0.0, 0.0], axis=1)
    assert np.minimum(still, moved).max() < 0.1 * spacing


def test_places_that_come_to_light_get_points_if_each_frame_decides():
    obj, balls = scattered("EACH_FRAME")
    scene = bpy.context.scene
    balls[1].animation_data_clear()
    for frame, x in ((1, 0.7), (FRAMES, 1.5)):
        balls[1].location.x = x
        balls[1].keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    bake(obj)
    *_, (points, hidden) = each_frame(obj, balls)
    assert hidden == 0
    # The side of the first ball that the second one left.
    middle = np.array(balls[1].location) / 2
    near = np.linalg.norm(points - middle, axis=1).min()
    assert near < np.sqrt(1.0 - (middle**2).sum()) + obj.dapple.report.spacing


def test_the_points_are_optimized_first_once_if_all_frames_decide():
    obj, _ = scattered("ALL_FRAMES")
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    before = scenes.positions(obj)
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    first = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
    assert "seen on all frames" in first.reoptimized_reason
    assert reason(obj) == ""
    found = keys(obj)
    bpy.context.scene.frame_set(1)
    assert np.abs(scenes.positions(obj) - before).max() > 0.01
    again = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
    assert again.reoptimized_reason == ""
    for name, values in keys(obj).items():
        assert found[name].tobytes() == values.tobytes()
    obj.dapple.density.outside_over_time = "FIRST_FRAME"
    assert reason(obj) == "Settings were changed (Density): bake again"


def test_a_change_of_the_motion_asks_for_another_bake():
    obj, balls = scattered("ALL_FRAMES")
    bake(obj)
    balls[1].location.x = 0.3
    balls[1].keyframe_insert("location", frame=FRAMES)
    bpy.context.scene.frame_set(FRAMES)
    assert reason(obj) != ""
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    again = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
    assert "seen on all frames" in again.reoptimized_reason
    assert [hidden for _, hidden in each_frame(obj, balls)] == [0] * FRAMES


@pytest.mark.parametrize("over_time", ["ALL_FRAMES", "EACH_FRAME"])
def test_a_stopped_bake_goes_on_to_the_same_bytes(over_time):
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    package = addon_host.part("core.base.native").package()
    obj, _ = scattered(over_time)
    found = []
    for stopped in (False, True):
        bpy.context.view_layer.objects.active = obj
        assert bpy.ops.dapple.optimize() == {"FINISHED"}
        if stopped:
            going, solved = baking.bake_steps(bpy.context, 1, FRAMES), 0
            task = next(going)
            while solved < 3:
                solved += getattr(task.call, "__name__", "") == "advance"
                task = going.send(task.call(package.Context()))
            going.close()
        baker = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
        assert baker.taken == (3 if stopped else 0)
        found.append(keys(obj))
        assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    for name, values in found[0].items():
        assert found[1][name].tobytes() == values.tobytes()


@pytest.mark.parametrize("smoothing", ["BOTH_WAYS", "LOOP"])
def test_frames_that_are_solved_together_see_all_frames(smoothing):
    obj, balls = scattered("ALL_FRAMES", smoothing=smoothing)
    bake(obj)
    assert [hidden for _, hidden in each_frame(obj, balls)] == [0] * FRAMES


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
@pytest.mark.parametrize("over_time", ["ALL_FRAMES", "EACH_FRAME"])
def test_no_point_is_hidden_where_faces_change(over_time, population):
    obj, balls = scattered(over_time, population=population, new_topology="REATTACH")
    finer = balls[0].modifiers.new("Finer", "SUBSURF")
    finer.subdivision_type = "SIMPLE"
    for frame, levels in ((1, 0), (4, 1)):
        finer.levels = finer.render_levels = levels
        for name in ("levels", "render_levels"):
            finer.keyframe_insert(name, frame=frame)
    for curve in scenes.curves(balls[0]):
        for key in curve.keyframe_points:
            key.interpolation = "CONSTANT"
    bpy.context.scene.frame_set(1)
    obj.dapple.attach_to, obj.dapple.fade_duration = "FACES", 1
    bake(obj)
    assert len(obj.dapple.surface_topology.split()) == 2
    assert [hidden for _, hidden in each_frame(obj, balls)] == [0] * FRAMES


@pytest.mark.parametrize(("name", "value"), [("masks", "FIRST_FRAME"), ("smoothing", "BOTH_WAYS")])
def test_it_is_said_where_each_frame_has_no_effect(name, value):
    obj, _ = scattered("EACH_FRAME", **{name: value})
    bake(obj)
    frozen = addon_host.part("blender.freshness.content_changes").frozen_note
    assert "shape of the surface" in frozen(obj)
    panel = addon_host.part("blender.density.panel")
    assert not panel.follows_outside(obj)
    setattr(obj.dapple, name, "EACH_FRAME" if name == "masks" else "FORWARD")
    assert panel.follows_outside(obj)


def test_another_mask_keeps_what_all_frames_decide():
    obj, balls = scattered("ALL_FRAMES")
    obj.dapple.density.use_height, obj.dapple.density.height_min = True, 0.0
    bake(obj)
    found = list(each_frame(obj, balls))
    assert [hidden for _, hidden in found] == [0] * FRAMES
    assert min(points[:, 2].min() for points, _ in found) > -0.05


def test_points_leave_an_edge_that_folds_on_a_later_frame():
    """On the edge itself they would be seen or not by rounding."""
    masked_surfaces = addon_host.part("core.bake.masked_surfaces").MaskedSurfaces
    values, arrays = addon_host.part("core.settings.values"), addon_host.part("core.surface.arrays")
    package = addon_host.part("core.base.native").package()
    flat = np.array([(0, 0, 0), (0, 1, 0), (-1, 0.5, 0), (1, 0.5, 0)], dtype=np.float64)
    folded = flat.copy()
    folded[2:] = [(-0.2, 0.5, 1.0), (0.2, 0.5, 1.0)]
    faces = np.array([(0, 1, 2), (1, 0, 3)], dtype=np.int32)
    first = arrays.SurfaceArrays("Book", flat, faces, "", poses=(folded,))
    for over_time, leaves in (("ALL_FRAMES", True), ("FIRST_FRAME", False)):
        density = values.DensitySettings(use_outside=True, outside_over_time=over_time)
        known = masked_surfaces(first, values.Settings(count=100, density=density))
        masked = known.first
        fold = masked.from_original(
            package.Samples(masked.original, [0], [[0.5, 0.5, 0.0]], ids=[0], classes=[0])
        )
        found = known.on_original(masked, fold, folded)
        assert (found.barycentric[0, 2] > 0.0) == leaves
