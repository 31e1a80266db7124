# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake: keys that follow the tracker, playback that equals them, ids that stay."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes

FRAMES = 6


@pytest.fixture
def tracked(monkeypatch):
    """Every result of the tracker during the test's bakes."""
    seen = []
    baker = addon_host.part("core.bake.baker").Baker
    advance = baker.advance

    def noting(self, context):
        advance(self, context)
        seen.append(self.tracker.samples)

    monkeypatch.setattr(baker, "advance", noting)
    return seen


def baked(frames=FRAMES, **options):
    surface = scenes.tail(frames=frames, **options)
    obj = scenes.scattered(surface)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return surface, obj


def tolerance(surface):
    return 1e-5 * scenes.size(scenes.world_vertices(surface))


def at(frame, subframe=0.0):
    bpy.context.scene.frame_set(frame, subframe=subframe)


def read_baked(obj):
    return addon_host.part("blender.scatter.key_stores").read_baked(obj)


def key_rows(obj):
    """Stored keys: corners (F, n, 3), barycentric (F, n, 3)."""
    stored, count = read_baked(obj), len(obj.data.vertices)
    bindings = [stored.binding(frame, count)[0] for frame in range(stored.frame_count)]
    corners = np.stack([binding.corners for binding in bindings])
    return corners, np.stack([binding.barycentric for binding in bindings])


def test_playback_equals_the_tracker_at_whole_frames(tracked):
    surface, obj = baked()
    assert len(tracked) == FRAMES
    for frame, samples in enumerate(tracked, start=1):
        at(frame)
        error = np.abs(scenes.positions(obj) - samples.positions).max()
        assert error < tolerance(surface)


def test_keys_change_faces_and_differ_from_riding_along():
    surface, obj = baked()
    corners, _ = key_rows(obj)
    assert len(corners) == FRAMES
    assert (corners[0] != corners[-1]).any()
    at(FRAMES)
    shown = scenes.positions(obj)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert np.abs(scenes.positions(obj) - shown).max() > 100 * tolerance(surface)


@pytest.mark.parametrize("fraction", [0.25, 0.5])
def test_between_frames_both_keys_are_mixed_on_the_surface_of_that_moment(fraction):
    surface, obj = baked()
    corners, weights = key_rows(obj)
    at(3, fraction)
    vertices = scenes.world_vertices(surface)
    here, there = (np.einsum("nk,nkd->nd", weights[key], vertices[corners[key]]) for key in (2, 3))
    expected = (1.0 - fraction) * here + fraction * there
    assert np.abs(here - there).max() > 100 * tolerance(surface)
    assert np.abs(scenes.positions(obj) - expected).max() < tolerance(surface)


def test_outside_the_range_the_first_and_the_last_key_hold():
    bpy.context.scene.frame_start = 3
    surface, obj = baked()
    corners, weights = key_rows(obj)
    assert len(corners) == FRAMES - 2
    for frame, subframe, key in ((1, 0.0, 0), (-7, 0.5, 0), (2, 0.5, 0), (6, 0.5, -1), (30, 0, -1)):
        at(frame, subframe)
        vertices = scenes.world_vertices(surface)
        expected = np.einsum("nk,nkd->nd", weights[key], vertices[corners[key]])
        assert np.abs(scenes.positions(obj) - expected).max() < tolerance(surface)


def test_keys_every_few_frames_play_and_their_error_is_reported(tracked):
    surface = scenes.tail(frames=FRAMES)
    obj = scenes.scattered(surface)
    obj.dapple.keyframe_step = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert (obj.dapple.baked_keys, obj.dapple.baked_frames) == (3, FRAMES)  # 1, 4, 6
    stored = read_baked(obj)
    apart = []
    for frame, samples in enumerate(tracked, start=1):
        at(frame)
        shown = scenes.positions(obj)
        first, second, share = stored.binding(frame - 1, 60)
        vertices = scenes.world_vertices(surface)
        mixed = (1.0 - share) * first.positions(vertices) + share * second.positions(vertices)
        assert np.abs(shown - mixed).max() < tolerance(surface)
        distance = np.linalg.norm(shown - samples.positions, axis=1)
        if frame in (1, 4, 6):
            assert distance.max() < tolerance(surface)
        else:
            apart.append(distance / samples.report.spacing)
    report = obj.dapple.report
    assert report.key_error_max == pytest.approx(np.max(apart), rel=1e-3)
    assert report.key_error_mean == pytest.approx(np.mean(apart), rel=1e-3)
    assert report.key_error_max > 1e-3
    line = addon_host.part("blender.bake.panel").baked_line(obj)
    assert line.startswith("Baked: frames 1 to 6, 3 keyframes; between them points are off by ")


def test_every_id_is_kept():
    _, obj = baked()
    before = sorted(range(60))
    for frame in range(1, FRAMES + 1):
        at(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        evaluated = obj.evaluated_get(depsgraph)
        assert len(scenes.positions(obj)) == 60
        ids = [item.value for item in obj.data.attributes["id"].data]
        assert sorted(ids) == before
        assert evaluated.is_evaluated


def test_points_move_less_than_half_a_spacing_a_frame(tracked):
    baked()
    assert max(samples.report.slide_max for samples in tracked) < 0.5


def test_orientation_never_pops():
    _, obj = baked(frames=8)
    previous = None
    for step in range(4 * 7 + 1):
        at(1 + step // 4, (step % 4) / 4)
        axes = scenes.rotations(obj)
        if previous is not None:
            trace = np.einsum("nij,nij->n", previous, axes)
            angle = np.degrees(np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0)))
            assert angle.max() < 15.0  # the tip turns by 69 degrees in 28 steps
        previous = axes


def test_the_current_frame_stays():
    surface = scenes.tail()
    scenes.scattered(surface)
    at(4, 0.25)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    scene = bpy.context.scene
    assert (scene.frame_current, scene.frame_subframe) == (4, 0.25)


def test_baking_again_leaves_one_set_of_keys():
    _, obj = baked()
    count = len(bpy.data.objects)
    bpy.context.scene.frame_end = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(bpy.data.objects) == count
    assert len(key_rows(obj)[0]) == obj.dapple.baked_keys == 3


def test_optimize_drops_the_keys():
    _, obj = baked()
    count = len(bpy.data.objects)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(bpy.data.objects) == count - 3  # keys, triangles, frames
    assert obj.dapple.baked_keys == obj.dapple.baked_frames == 0
    assert not bpy.ops.dapple.clear_bake.poll()


def test_undo_and_redo_of_a_bake():
    surface = scenes.tail()
    obj = scenes.scattered(surface)
    name = obj.name
    bpy.ops.ed.undo_push(message="Before")
    at(5)
    riding = scenes.positions(obj)
    bpy.ops.ed.undo_push(message="Frame")
    assert bpy.ops.dapple.bake("EXEC_DEFAULT", True) == {"FINISHED"}
    playing = scenes.positions(bpy.data.objects[name])
    bpy.ops.ed.undo()
    assert np.allclose(scenes.positions(bpy.data.objects[name]), riding, atol=1e-6)
    bpy.ops.ed.redo()
    assert np.allclose(scenes.positions(bpy.data.objects[name]), playing, atol=1e-6)


def test_points_removed_by_hand_after_the_bake_are_reported():
    _, obj = baked()
    obj.data.clear_geometry()
    obj.data.vertices.add(5)
    assert len(scenes.positions(obj)) == 0
    assert scenes.node_warnings(obj) == ["Points were added or removed since the bake: bake again"]


def refused(words):
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.dapple.bake()
    assert scenes.snapshot() == before


def test_a_topology_that_changes_in_the_range_is_refused():
    surface = scenes.tail()
    scenes.scattered(surface)
    modifier = surface.modifiers.new("Mask", "BUILD")
    modifier.frame_start, modifier.frame_duration = -1000, 1
    check = surface.modifiers["Subdivision"]
    for level, frame in ((1, 3), (2, 4)):
        check.levels = check.render_levels = level
        check.keyframe_insert("levels", frame=frame)
        check.keyframe_insert("render_levels", frame=frame)
    at(2)
    surface.modifiers.remove(modifier)
    refused("'Tail' changes its topology at frame 4 .1634 vertices, was 410")


def subdivided_from(surface, frame):
    """Keyframes: one level more from this frame on."""
    modifier = surface.modifiers["Subdivision"]
    for level, at_frame in ((1, frame - 1), (2, frame)):
        modifier.levels = modifier.render_levels = level
        modifier.keyframe_insert("levels", frame=at_frame)
        modifier.keyframe_insert("render_levels", frame=at_frame)
    at(1)


@pytest.mark.parametrize("every", [1, 4])
def test_a_topology_that_changes_is_bound_again_when_asked(every):
    surface = scenes.tail(frames=FRAMES)
    obj = scenes.scattered(surface)
    subdivided_from(surface, 4)
    obj.dapple.new_topology, obj.dapple.keyframe_step = "REATTACH", every
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    table = read_baked(obj).frames
    assert table["dapple_vertices"].tolist() == [410, 410, 410, 1634, 1634, 1634]
    assert table["dapple_span"][2] == 0  # nothing is interpolated across the change
    dapple, before = addon_host.part("core.base.native").package(), None
    reading = addon_host.part("blender.surface.mesh")
    staleness = addon_host.part("blender.freshness.staleness")
    for frame in np.arange(1.0, FRAMES + 0.1, 0.25):
        at(int(frame), frame % 1.0)
        shown = scenes.positions(obj)
        assert len(shown) == 60
        assert staleness.stale_reason(obj, bpy.context) == ""
        arrays = reading.read_mesh(surface)
        native = dapple.Surface(arrays.vertices, arrays.faces)
        apart = np.linalg.norm(dapple.project(native, shown).positions - shown, axis=1)
        assert apart.max() < 0.02 * scenes.size(arrays.vertices)
        if before is not None:  # the tip moves by 0.7 a frame
            assert np.linalg.norm(shown - before, axis=1).max() < 0.4
        before = shown


def test_an_interrupted_bake_over_a_change_of_topology_gives_the_same_bytes(tmp_path):
    surface = scenes.tail(frames=FRAMES)
    obj = scenes.scattered(surface)
    subdivided_from(surface, 3)
    obj.dapple.new_topology = "REATTACH"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    expected = read_baked(obj)
    files = addon_host.part("blender.freshness.unfinished_bakes").work_files(obj)
    for frame in (5, 6):
        files.path(frame).unlink()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    found = read_baked(obj)
    for name in ("keys", "triangles", "frames"):
        for column, values in getattr(expected, name).items():
            assert getattr(found, name)[column].tobytes() == values.tobytes()


def test_faces_that_change_with_the_same_number_of_vertices_are_refused():
    surface = scenes.tail()
    scenes.scattered(surface)
    loops = surface.data.loops
    first, second = loops[0].vertex_index, loops[1].vertex_index
    loops[0].vertex_index, loops[1].vertex_index = second, first
    surface.data.update()
    refused("is out of date: surface 'Tail' has 410 vertices as before, but other faces")


@pytest.mark.parametrize("operator", ["reattach", "bake"])
def test_a_modifier_added_after_binding_is_followed_when_asked(operator):
    surface = scenes.tail()
    obj = scenes.scattered(surface)
    before = scenes.positions(obj)
    array = surface.modifiers.new("Array", "ARRAY")
    array.relative_offset_displace = (3.0, 0.0, 0.0)
    assert len(scenes.positions(obj)) == 0
    if operator == "bake":
        obj.dapple.new_topology = "REATTACH"
    assert getattr(bpy.ops.dapple, operator)() == {"FINISHED"}
    after = scenes.positions(obj)
    assert len(after) == 60
    limit = 1e-5 if operator == "reattach" else 0.5 * obj.dapple.report.spacing
    assert np.linalg.norm(after - before, axis=1).max() < limit


def test_a_stale_scatter_is_refused():
    surface = scenes.tail()
    scenes.scattered(surface)
    modifier = surface.modifiers["Subdivision"]
    modifier.levels = modifier.render_levels = 2
    refused("is out of date: attached to 410 vertices, surface 'Tail' has 1634")


def test_an_empty_range_is_refused():
    scenes.scattered(scenes.tail())
    scene = bpy.context.scene
    scene.frame_end, scene.frame_start = 2, 2
    scene.frame_preview_start = 1
    baking, steps = addon_host.part("blender.bake.steps"), addon_host.part("core.base.steps")
    errors = addon_host.part("core.base.errors")
    with pytest.raises(errors.ScatterError, match="frame range is empty: 5 to 4"):
        steps.run_now(baking.bake_steps(bpy.context, 5, 4))


def test_a_broken_record_is_refused():
    obj = scenes.scattered(scenes.tail())
    obj.data.attributes["dapple_v1"].data[7].value = 99_999
    refused(r"dapple_v1\[7\] is 99999")


def test_a_quad_that_is_cut_the_other_way_keeps_its_points():
    surface = scenes.tail()
    obj = scenes.scattered(surface)
    reading = addon_host.part("blender.surface.mesh")
    binding = addon_host.part("core.surface.binding")
    points = addon_host.part("blender.scatter.points")
    dapple = addon_host.part("core.base.native").package()
    arrays = reading.read_mesh(surface)
    stored, columns = points.read_binding(obj, len(arrays.vertices))
    quads = [polygon.vertices[:] for polygon in evaluated_polygons(surface)]
    other = np.array(
        [t for q in quads for t in ((q[0], q[1], q[3]), (q[1], q[2], q[3]))], dtype=np.int32
    )
    assert (binding.faces_with_corners(stored.corners, other) < 0).any()
    samples = binding.samples_of(
        stored, dapple.Surface(arrays.vertices, other), columns["id"], columns["dapple_object_type"]
    )
    moved = np.abs(samples.positions - stored.positions(arrays.vertices)).max()
    assert moved < 0.02 * scenes.size(arrays.vertices)


def evaluated_polygons(surface):
    return surface.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons


def slides_of(surface, obj):
    """Ways (frame, point, 3) from where the frame before carries each point."""
    corners, weights = key_rows(obj)
    found = []
    for frame in range(1, FRAMES):
        at(frame + 1)
        vertices = scenes.world_vertices(surface)
        here, there = (
            np.einsum("nk,nkd->nd", weights[key], vertices[corners[key]])
            for key in (frame - 1, frame)
        )
        found.append(there - here)
    return np.array(found)


@pytest.mark.parametrize("smoothing", ["BOTH_WAYS", "LOOP"])
def test_frames_solved_together_move_more_smoothly(smoothing):
    jerks = []
    for chosen in ("FORWARD", smoothing):
        surface = scenes.tail(frames=FRAMES)
        obj = scenes.scattered(surface)
        obj.dapple.smoothing = chosen
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert obj.dapple.baked_keys == FRAMES
        assert obj.dapple.report.capacity_variation < 0.05
        slides = slides_of(surface, obj)
        jerks.append(np.linalg.norm(np.diff(slides, axis=0), axis=2).mean())
    assert jerks[1] < jerks[0]


@pytest.mark.parametrize("smoothing", ["BOTH_WAYS", "LOOP"])
def test_frames_solved_in_pieces_move_more_smoothly(smoothing, monkeypatch):
    in_pieces(monkeypatch)
    surface = scenes.tail(frames=FRAMES)
    obj = scenes.scattered(surface)
    jerks = []
    for chosen in ("FORWARD", smoothing):
        obj.dapple.smoothing = chosen
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert obj.dapple.baked_keys == FRAMES
        assert obj.dapple.report.capacity_variation < 0.05
        slides = slides_of(surface, obj)
        jerks.append(np.linalg.norm(np.diff(slides, axis=0), axis=2).mean())
    assert jerks[1] < jerks[0]


def in_pieces(monkeypatch):
    """Solve frames together in pieces of three that overlap by one."""
    together = addon_host.part("core.bake.window_bake")
    monkeypatch.setattr(together, "PIECE", 3)
    monkeypatch.setattr(together, "OVERLAP", 1)


def test_a_bake_in_pieces_holds_no_more_than_two(monkeypatch):
    in_pieces(monkeypatch)
    together, held = addon_host.part("core.bake.window_bake").WindowBaker, []
    take = together.take

    def noting(self):
        done = take(self)
        held.append(len(self.held))
        return done

    monkeypatch.setattr(together, "take", noting)
    frames = 12
    obj = scenes.scattered(scenes.tail(frames=frames))
    obj.dapple.smoothing = "BOTH_WAYS"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.baked_keys == frames == len(held)
    assert max(held) == 5


def test_frames_solved_together_are_those_of_one_topology():
    surface = scenes.tail(frames=FRAMES)
    obj = scenes.scattered(surface)
    obj.dapple.smoothing, obj.dapple.new_topology = "BOTH_WAYS", "REATTACH"
    add_array(surface)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.baked_keys == FRAMES
    counts = addon_host.part("blender.scatter.key_stores").read_baked(obj).frames["dapple_vertices"]
    assert len(set(counts[:3].tolist())) == len(set(counts[3:].tolist())) == 1
    assert counts[2] < counts[3]


@pytest.mark.parametrize(
    ("smoothing", "said"), [("BOTH_WAYS", "New Topology"), ("LOOP", "Set Smoothing to Forward")]
)
def test_a_topology_that_may_not_change_is_named(smoothing, said):
    surface = scenes.tail(frames=FRAMES)
    obj = scenes.scattered(surface)
    obj.dapple.smoothing = smoothing
    add_array(surface)
    with pytest.raises(RuntimeError, match=f"frame 4.*{said}"):
        bpy.ops.dapple.bake()
    assert obj.dapple.baked_keys == 0


def add_array(surface):
    """Twice as many faces from frame 4 on."""
    build = surface.modifiers.new("Array", "ARRAY")
    build.show_viewport = build.show_render = False
    build.keyframe_insert("show_viewport", frame=1)
    build.keyframe_insert("show_render", frame=1)
    build.show_viewport = build.show_render = True
    build.keyframe_insert("show_viewport", frame=4)
    build.keyframe_insert("show_render", frame=4)
    bpy.context.scene.frame_set(1)


def test_stickiness_reaches_the_tracker():
    lengths = []
    for stickiness in (0.0, 100.0):
        surface = scenes.tail(frames=FRAMES)
        obj = scenes.scattered(surface)
        obj.dapple.stickiness = stickiness
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        lengths.append(np.linalg.norm(slides_of(surface, obj), axis=2).mean())
    assert lengths[1] < lengths[0]


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_fitted_instances_just_touch_on_every_frame(population):
    surface = scenes.tail(frames=FRAMES)
    obj = scenes.scattered(surface, count=150)
    ball = scenes.sphere(location=(9.0, 9.0, 9.0))
    obj.dapple.instance, obj.dapple.fit_to_spacing = ball, 1.0
    obj.dapple.population = population
    scenes.activate(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in range(1, FRAMES + 1):
        at(frame)
        matrices = scenes.instance_matrices(obj)
        radii = np.linalg.norm(matrices[:, :3, 0], axis=1)
        places = matrices[:, :3, 3]
        away = np.linalg.norm(places[:, None] - places[None], axis=2)
        np.fill_diagonal(away, np.inf)
        share = 1.0 - away / (radii[:, None] + radii[None])
        assert share.max() < 1e-3, frame
        if population == "KEEP_COUNT":  # fading points are smaller than their space
            assert (1.0 - share.max(axis=1)).min() < 1.001


def test_keys_hold_rooms_only_where_instances_are_fitted():
    _, obj = baked()
    keys = addon_host.part("blender.scatter.key_stores").stored_object(obj, "Keys")
    assert "dapple_clearance" not in keys.data.attributes
    obj.dapple.fit_to_spacing = 0.5
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    keys = addon_host.part("blender.scatter.key_stores").stored_object(obj, "Keys")
    assert "dapple_clearance" in keys.data.attributes
