# SPDX-License-Identifier: GPL-3.0-or-later
"""Births and deaths in a bake: a body that grows and shrinks keeps its density, nothing pops."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes

FRAMES, FADE = 12, 3


@pytest.fixture
def breathing():
    return breathing_ball()


def breathing_ball():
    """A scatter on a ball that grows to 1.3 times its size and shrinks to 0.8 times."""
    surface = scenes.sphere()
    for frame, size in ((1, 1.0), (5, 1.3), (12, 0.8)):
        surface.scale = (size, size, size)
        surface.keyframe_insert("scale", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    scene.frame_set(1)
    obj = scenes.scattered(surface, count=80)
    obj.dapple.population = "KEEP_DENSITY"
    obj.dapple.fade_duration = FADE
    return surface, obj


def shown(obj, frame, subframe=0.0):
    """Ids and sizes of the instances."""
    bpy.context.scene.frame_set(frame, subframe=subframe)
    found = {}
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        if instance.is_instance and instance.parent.original == obj:
            found[instance.random_id] = np.cbrt(abs(instance.matrix_world.to_3x3().determinant()))
    return found


def fades(obj, frame, subframe=0.0):
    """1 - dapple_faded, of each row, from the keys."""
    scene = bpy.context.scene
    scene.frame_set(frame, subframe=subframe)
    stored = addon_host.part("blender.scatter.key_stores").stored_object(obj, "Keys").data
    values = np.empty(len(stored.vertices), dtype=np.float32)
    stored.attributes["dapple_faded"].data.foreach_get("value", values)
    return 1.0 - values.reshape(-1, len(obj.data.vertices))[frame - 1]


def test_other_scatters_avoid_only_points_that_exist(breathing):
    _, obj = breathing
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    playback = addon_host.part("blender.surface.playback")
    for frame in (1, 6, FRAMES):
        there = (fades(obj, frame) > 0.0) | (fades(obj, min(frame + 1, FRAMES)) > 0.0)
        assert frame == 6 or not there.all()  # at 6 the ball is largest
        bpy.context.scene.frame_set(frame)
        np.testing.assert_array_equal(playback.points_now(obj, {})[1], there)


def test_the_count_follows_the_area(breathing):
    _, obj = breathing
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame, size in ((1, 1.0), (5, 1.3), (FRAMES, 0.8)):
        # On the frame of its birth the fade of a point is still 0.
        there = (fades(obj, frame) > 0.0) | (fades(obj, min(frame + 1, FRAMES)) > 0.0)
        wanted = 80 * size**2
        # some points still fade out
        assert 0.97 * wanted <= there.sum() <= 1.03 * wanted + 80 * 0.35


def test_points_fade_in_and_out_and_never_pop(breathing):
    _, obj = breathing
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    table = np.stack([fades(obj, frame) for frame in range(1, FRAMES + 1)])
    assert (np.abs(np.diff(table, axis=0)) <= 1.0 / FADE + 1e-5).all()
    assert (table[0, :80] == 1.0).all()
    assert (table[0, 80:] == 0.0).all()
    assert (table[-1] == 0.0).any()
    born_again = (np.diff((table > 0.0).astype(int), axis=0) == 1).sum(axis=0)
    assert (born_again <= 1).all()


def test_instances_are_those_that_are_there_and_as_large_as_they_are(breathing):
    _, obj = breathing
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame, subframe in ((1, 0.0), (4, 0.0), (4, 0.5), (FRAMES, 0.0)):
        now = fades(obj, frame)
        if subframe:
            now = (1.0 - subframe) * now + subframe * fades(obj, frame + 1)
        sizes = np.sort(list(shown(obj, frame, subframe).values()))
        assert len(sizes) == (now > 0.0).sum()
        assert np.allclose(sizes, np.sort(now[now > 0.0]), atol=1e-4)


def test_ids_stay_and_are_new(breathing):
    _, obj = breathing
    before = ids(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    after = ids(obj)
    assert after[:80] == before
    assert len(set(after)) == len(after)


@pytest.mark.parametrize("attach_to", ["FACES", "REST"])
def test_each_object_type_keeps_its_density(breathing, attach_to):
    _, obj = breathing
    obj.dapple.attach_to = attach_to
    for share in (3.0, 1.0):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        obj.dapple.object_types[-1].weight = share
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    before = classes_of(obj)
    assert np.bincount(before).tolist() == [60, 20]
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.attached_to == attach_to
    kinds = classes_of(obj)
    assert (kinds[:80] == before).all()
    assert set(kinds[80:].tolist()) == {0, 1}
    for frame, size in ((1, 1.0), (5, 1.3), (FRAMES, 0.8)):
        there = (fades(obj, frame) > 0.0) | (fades(obj, min(frame + 1, FRAMES)) > 0.0)
        for kind, first in ((0, 60), (1, 20)):
            wanted = first * size**2
            found = (there & (kinds == kind)).sum()
            assert 0.97 * wanted - 1 <= found <= 1.03 * wanted + 1 + first * 0.35
        assert len(shown(obj, frame)) == (fades(obj, frame) > 0.0).sum()


def classes_of(obj):
    return np.array([one.value for one in obj.data.attributes["dapple_object_type"].data])


def ids(obj):
    values = np.empty(len(obj.data.vertices), dtype=np.int32)
    obj.data.attributes["id"].data.foreach_get("value", values)
    return values.tolist()


def test_clearing_and_baking_again_leaves_the_points_as_they_were(breathing):
    _, obj = breathing
    before = scenes.positions(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    first = [fades(obj, frame) for frame in (1, 5, FRAMES)]
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for old, new in zip(first, (fades(obj, frame) for frame in (1, 5, FRAMES)), strict=True):
        assert (old == new).all()
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    bpy.context.scene.frame_set(1)
    assert len(obj.data.vertices) == 80
    assert np.abs(scenes.positions(obj) - before).max() < 1e-6


def test_a_bake_of_a_constant_count_after_it_has_the_first_points(breathing):
    _, obj = breathing
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    obj.dapple.population = "KEEP_COUNT"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(obj.data.vertices) == 80
    assert len(shown(obj, 5)) == 80


def test_every_third_frame_as_a_key(breathing):
    _, obj = breathing
    obj.dapple.keyframe_step = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.baked_keys == 5
    assert len(shown(obj, 1)) == 80


def test_the_preview_says_why_it_does_not_start(breathing):
    assert breathing
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="clear the bake to preview"):
        bpy.ops.dapple.live_preview()


def test_a_cleared_bake_leaves_the_figures_and_locks_of_the_solution(breathing):
    _, obj = breathing
    names = ("count", "spacing", "alpha_min", "capacity_variation", "evaluations", "converged")
    before = [getattr(obj.dapple.report, name) for name in names]
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(obj.data.vertices) > obj.dapple.solved.count == 80
    assert bpy.ops.dapple.lock_points(every=True) == {"FINISHED"}
    assert obj.dapple.locked_count == len(obj.data.vertices)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert [getattr(obj.dapple.report, name) for name in names] == before
    assert obj.dapple.locked_count == len(obj.data.vertices) == 80
    assert obj.dapple.baked_settings == obj.dapple.baked_from == ""


def remeshed():
    """A ball that grows through the voxels of a Remesh modifier: other faces in every frame."""
    surface = scenes.sphere()
    modifier = surface.modifiers.new("Remesh", "REMESH")
    modifier.mode, modifier.voxel_size = "VOXEL", 0.12
    surface.shape_key_add(name="Basis")
    grown = surface.shape_key_add(name="Grown")
    for point in grown.data:
        point.co.x = 1.6 * point.co.x + 0.3
    for frame, share in ((1, 0.0), (8, 1.0)):
        grown.value = share
        grown.keyframe_insert("value", frame=frame)
    return surface


def balls():
    """Two metaballs that part: other faces in every frame, and no rest position."""
    bpy.ops.object.metaball_add()
    surface = bpy.context.object
    surface.data.resolution = 0.25
    other = surface.data.elements.new()
    for frame, x in ((1, 1.5), (8, 3.6)):
        other.co.x = x
        other.keyframe_insert("co", frame=frame)
    return surface


def following(made):
    surface = made()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 8
    scene.frame_set(1)
    obj = scenes.scattered(surface, count=300)
    obj.dapple.population, obj.dapple.fade_duration = "KEEP_DENSITY", FADE
    return surface, obj


def read_now(surface):
    reading = addon_host.part("blender.surface.mesh")
    return reading.read_mesh(surface)


@pytest.mark.parametrize("made", [remeshed, balls])
def test_faces_that_change_are_followed_at_a_constant_density(made):
    surface, obj = following(made)
    dapple, before = addon_host.part("core.base.native").package(), ids(obj)
    obj.dapple.new_topology = "REATTACH"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert ids(obj)[:300] == before
    assert len(set(ids(obj))) == len(obj.data.vertices) > 300
    staleness = addon_host.part("blender.freshness.staleness")
    first_area, counts = None, set()
    for frame in range(1, 9):
        bpy.context.scene.frame_set(frame)
        assert staleness.stale_reason(obj, bpy.context) == ""
        arrays = read_now(surface)
        counts.add(len(arrays.vertices))
        native = dapple.Surface(arrays.vertices, arrays.faces)
        first_area = first_area or native.area
        places = scenes.positions(obj)
        apart = np.linalg.norm(dapple.project(native, places).positions - places, axis=1)
        assert apart.max() < 1e-3
        there = fades(obj, frame) > 0.0
        if frame < 8:
            there |= fades(obj, frame + 1) > 0.0  # born, but its size is still 0
        wanted = 300 * native.area / first_area
        assert 0.98 * wanted - 2 <= there.sum() <= 1.02 * wanted + 30  # some points still fade out
    assert len(counts) > 4
    table = np.stack([fades(obj, frame) for frame in range(1, 9)])
    born_again = (np.diff((table > 0.0).astype(int), axis=0) == 1).sum(axis=0)
    assert (born_again <= 1).all()
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert len(obj.data.vertices) == 300


def test_faces_that_change_are_refused_unless_asked_for():
    _, obj = following(remeshed)
    obj.dapple.attach_to = "FACES"
    with pytest.raises(RuntimeError, match=r"changes its topology at frame 2.*New Topology"):
        bpy.ops.dapple.bake()
    assert len(obj.data.vertices) == 300


def two_types(made):
    surface, obj = made()
    for share in (3.0, 1.0):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        obj.dapple.object_types[-1].weight = share
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return surface, obj


def around_an_obstacle(made):
    """A scatter on faces that are refined where the density changes inside them."""
    surface, obj = made()
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    stone = scenes.sphere(location=(1.0, 0.0, 0.0), scale=(0.2, 0.2, 0.2))
    stones.objects.link(stone)
    obj.dapple.density.avoid_collection = stones
    scenes.activate(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return surface, obj


def packed(obj):
    stored = addon_host.part("blender.scatter.key_stores").read_baked(obj)
    columns = {**stored.keys, **stored.triangles, **stored.frames}
    return {name: values.tobytes() for name, values in columns.items()} | {"ids": ids(obj)}


def baked(obj):
    """Keyframes of a bake, and the numbers of frames that were loaded and solved."""
    baking = addon_host.part("blender.bake.steps")
    bakers = []
    new = baking.new_baker
    baking.new_baker = lambda *arguments: bakers.append(new(*arguments)) or bakers[-1]
    try:
        assert bpy.ops.dapple.bake() == {"FINISHED"}
    finally:
        baking.new_baker = new
    (baker,) = bakers
    return packed(obj), baker.taken, baker.done - baker.taken


MADE = {
    "ball": lambda: breathing_ball(),
    "types": lambda: two_types(breathing_ball),
    "cut": lambda: around_an_obstacle(breathing_ball),
    "remeshed": lambda: following(remeshed),
    "balls": lambda: following(balls),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("made", MADE)
@pytest.mark.parametrize("kept", [1, 5, 7])
def test_a_bake_goes_on_from_its_frames_to_the_same_bytes(made, kept, tmp_path):
    _, obj = MADE[made]()
    obj.dapple.new_topology = "REATTACH"
    work_files = addon_host.part("blender.freshness.unfinished_bakes")
    files = work_files.work_files(obj)
    whole, taken, solved = baked(obj)
    assert (taken, solved) == (0, bpy.context.scene.frame_end)
    assert files.frames() == solved
    for path in sorted(files.folder.iterdir())[:kept]:
        (tmp_path / path.name).write_bytes(path.read_bytes())
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert files.frames() == 0
    addon_host.part("core.bake.sidecar").Sidecar(tmp_path).move(files.folder)
    assert work_files.unfinished(obj) == kept
    assert baked(obj) == (whole, kept, solved - kept)


def test_frames_of_another_fade_are_not_taken():
    _, obj = breathing_ball()
    _, _, solved = baked(obj)
    obj.dapple.fade_duration = FADE + 1
    assert baked(obj)[1:] == (0, solved)
    obj.dapple.population = "KEEP_COUNT"
    assert baked(obj)[1:] == (0, solved)


def test_files_that_are_not_of_a_population_are_not_taken(tmp_path):
    _, obj = breathing_ball()
    files = addon_host.part("blender.freshness.unfinished_bakes").work_files(obj)
    whole, _, solved = baked(obj)
    with np.load(files.path(2)) as stored:
        arrays = dict(stored)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    files.folder.mkdir(parents=True)
    for name in ("more_ids", "more_classes", "more_fades"):
        np.savez(files.path(2), **{key: one for key, one in arrays.items() if key != name})
        np.savez(files.path(3), **(arrays | {name: arrays[name][:-1]}))
        assert baked(obj) == (whole, 0, solved)
        assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
        files.folder.mkdir(parents=True, exist_ok=True)
