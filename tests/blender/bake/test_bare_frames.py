# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces without faces on some frames of a bake have no points there."""

import csv

import addon_host
import bpy
import numpy as np
import pytest
import scenes

FADE = 2


def deleter(surface, everything=True):
    """A modifier at the end that leaves no faces, and no vertices either or all of them."""
    group = bpy.data.node_groups.new("Delete", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    delete = group.nodes.new("GeometryNodeDeleteGeometry")
    if not everything:
        delete.domain, delete.mode = "FACE", "ONLY_FACE"
    group.links.new(group.nodes.new("NodeGroupInput").outputs[0], delete.inputs[0])
    group.links.new(delete.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    modifier = surface.modifiers.new("Delete", "NODES")
    modifier.node_group = group
    return modifier


def without_faces(surface, frames, last, everything=True):
    """Remove the faces of a surface on some frames."""
    modifier = deleter(surface, everything)
    for frame in range(1, last + 1):
        for name in ("show_viewport", "show_render"):
            setattr(modifier, name, frame in frames)
            modifier.keyframe_insert(name, frame=frame)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, last


def grown(surface, last, size=1.5):
    """Let a surface grow by a shape key, with the same faces."""
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Grown")
    for point in key.data:
        point.co *= size
    for frame, share in ((1, 0.0), (last, 1.0)):
        key.value = share
        key.keyframe_insert("value", frame=frame)


def flickering(bare, last=10, count=120, everything=True, start=None):
    """A scatter on a ball that grows and has no faces on the frames bare."""
    surface = scenes.sphere()
    grown(surface, last)
    without_faces(surface, bare, last, everything)
    scene = bpy.context.scene
    start = start or next(frame for frame in range(1, last + 1) if frame not in bare)
    scene.frame_set(start)
    obj = scenes.scattered(surface, count=count)
    obj.dapple.population, obj.dapple.fade_duration = "KEEP_DENSITY", FADE
    obj.dapple.new_topology = "REATTACH"
    return surface, obj


def area(surface):
    reading = addon_host.part("blender.surface.mesh")
    arrays = reading.read_mesh(surface)
    if not len(arrays.faces):
        return 0.0
    return addon_host.part("core.base.native").package().Surface(arrays.vertices, arrays.faces).area


def shown(obj, frame, subframe=0.0):
    """Number of instances."""
    bpy.context.scene.frame_set(frame, subframe=subframe)
    return len(scenes.instance_matrices(obj))


def stale(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def density_kept(surface, obj, bare, last, count=120):
    """Check all frames of a bake: the counts, the places, and that nothing is out of date."""
    scene = bpy.context.scene
    begin = next(frame for frame in range(1, last + 1) if frame not in bare)
    scene.frame_set(begin)
    density = count / area(surface)
    for frame in range(1, last + 1):
        found = shown(obj, frame)
        assert stale(obj) == "", frame
        assert scenes.node_warnings(obj) == [], frame
        if frame in bare:
            assert found == 0, frame
            continue
        wanted = density * area(surface)
        assert 0.85 * wanted <= found <= 1.1 * wanted + 5, frame  # the youngest points have size 0
        radii = np.linalg.norm(scenes.positions(obj), axis=1)
        size = np.linalg.norm(scenes.world_vertices(surface), axis=1).max()
        assert np.abs(radii - size).max() < 0.06 * size, frame


GAPS = {
    "middle": {4, 5},
    "first": {1, 2, 3},
    "last": {9, 10},
    "one": {6},
    "several": {1, 4, 5, 8},
    "both ends": {1, 2, 9, 10},
    "all but one": {1, 2, 3, 4, 6, 7, 8, 9, 10},
}


@pytest.mark.parametrize("attach_to", ["FACES", "REST"])
@pytest.mark.parametrize("everything", [True, False])
@pytest.mark.parametrize("gap", GAPS)
def test_there_are_no_points_on_frames_without_faces(gap, everything, attach_to):
    bare = GAPS[gap]
    surface, obj = flickering(bare, everything=everything)
    obj.dapple.attach_to = attach_to
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    before = bpy.context.scene.frame_current
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert bpy.context.scene.frame_current == before
    assert obj.dapple.attached_to == attach_to
    density_kept(surface, obj, bare, 10)
    assert obj.dapple.report.alpha_min > 0.4
    ids = [one.value for one in obj.data.attributes["id"].data]
    assert len(set(ids)) == len(ids)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert len(obj.data.vertices) == 120


def test_points_of_a_first_gap_begin_in_full_and_later_ones_fade_in():
    _, obj = flickering({1, 2, 5})
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    sizes = {}
    for frame in (3, 6, 7):
        bpy.context.scene.frame_set(frame)
        linear = scenes.instance_matrices(obj)[:, :3, :3]
        sizes[frame] = np.cbrt(np.linalg.det(linear))
    assert np.allclose(sizes[3], 1.0, atol=1e-4)
    assert np.allclose(sizes[6], 1.0 / FADE, atol=1e-4)
    assert sizes[7].max() > 0.99


@pytest.mark.parametrize("smoothing", ["BOTH_WAYS", "LOOP", "FORWARD"])
def test_smoothing_makes_no_difference(smoothing):
    surface, obj = flickering({4, 5})
    obj.dapple.smoothing = smoothing
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    density_kept(surface, obj, {4, 5}, 10)


@pytest.mark.parametrize("attach_to", ["FACES", "REST"])
def test_between_two_frames_there_are_points_only_where_there_are_faces(attach_to):
    surface, obj = flickering({4, 5})
    obj.dapple.attach_to = attach_to
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame, part in ((3, 0.5), (3, 0.9), (4, 0.0), (4, 0.5), (5, 0.5), (5, 0.9), (6, 0.0)):
        found = shown(obj, frame, part)
        assert found == 0 or area(surface) > 0.0, (frame, part)
        if found:
            radii = np.linalg.norm(scenes.positions(obj), axis=1)
            assert radii.min() > 0.9, (frame, part)


def test_every_third_frame_as_a_key():
    surface, obj = flickering({1, 5, 6})
    obj.dapple.keyframe_step = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    density_kept(surface, obj, {1, 5, 6}, 10)
    assert obj.dapple.baked_keys == 6  # 1; 2, 4; 5 and 6; 7, 10


@pytest.mark.parametrize("gap", ["middle", "first", "last", "several"])
@pytest.mark.parametrize("kept", [1, 4, 6, 9])
def test_a_stopped_bake_goes_on_to_the_same_bytes(gap, kept, tmp_path):
    _, obj = flickering(GAPS[gap])
    files = addon_host.part("blender.freshness.unfinished_bakes").work_files(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    whole = packed(obj)
    assert files.frames() == 10
    for path in sorted(files.folder.iterdir())[:kept]:
        (tmp_path / path.name).write_bytes(path.read_bytes())
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert files.frames() == 0
    addon_host.part("core.bake.sidecar").Sidecar(tmp_path).move(files.folder)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert packed(obj) == whole


def packed(obj):
    stored = addon_host.part("blender.scatter.key_stores").read_baked(obj)
    columns = {**stored.keys, **stored.triangles, **stored.frames}
    ids = [one.value for one in obj.data.attributes["id"].data]
    return {name: values.tobytes() for name, values in columns.items()} | {"ids": ids}


def test_the_files_of_a_bake_that_ends_without_faces_are_finished():
    _, obj = flickering(GAPS["last"])
    workfiles = addon_host.part("blender.freshness.unfinished_bakes")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(workfiles.finished_files(obj)) == 1
    assert workfiles.unfinished(obj) == 0


def test_metaballs_that_vanish_and_come_back():
    bpy.ops.object.metaball_add()
    surface = bpy.context.object
    surface.data.resolution = 0.25
    element = surface.data.elements[0]
    for frame, radius in ((1, 2.0), (3, 1.5), (4, 0.01), (5, 0.01), (6, 1.5), (8, 2.2)):
        element.radius = radius
        element.keyframe_insert("radius", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 8
    scene.frame_set(1)
    obj = scenes.scattered(surface, count=100)
    obj.dapple.population, obj.dapple.fade_duration = "KEEP_DENSITY", FADE
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    density = 100 / 1.0
    for frame in range(1, 9):
        found = shown(obj, frame)
        assert stale(obj) == ""
        now = area(surface)
        density = found / now if frame == 1 else density
        assert (found == 0) == (now == 0.0), frame
        if frame == 8:
            assert 0.85 * density * now <= found <= 1.15 * density * now
    scene.frame_start = 4  # a frame without a key
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert shown(obj, 4) == 0
    assert shown(obj, 6) > 0


REFUSED = {
    "count": ("KEEP_COUNT", "REATTACH", r"has no faces at frame 4$"),
    "stop": (
        "KEEP_DENSITY",
        "STOP",
        r"has no faces at frame 4: set New Topology to Reattach to have no points there$",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
@pytest.mark.parametrize("smoothing", ["BOTH_WAYS", "FORWARD"])
def test_other_bakes_name_the_frame(case, smoothing):
    over_time, topology, words = REFUSED[case]
    _, obj = flickering({4})
    obj.dapple.population, obj.dapple.new_topology = over_time, topology
    obj.dapple.smoothing = smoothing
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match=words.replace("$", r"\n?$")):
        bpy.ops.dapple.bake()
    assert scenes.snapshot() == before
    bpy.context.scene.frame_start = 4
    with pytest.raises(RuntimeError, match=words.replace("$", r"\n?$")):
        bpy.ops.dapple.bake()


def test_object_types_say_why_they_stop():
    assert flickering({4})
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    words = "has no faces at frame 4: points of object types cannot appear again behind it"
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.dapple.bake()


def test_a_range_without_any_faces_is_named():
    _, obj = flickering({4, 5, 6})
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 4, 6
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match="'Sphere' has no faces from frame 4 to 6"):
        bpy.ops.dapple.bake()
    assert scenes.snapshot() == before
    assert obj.dapple.baked_keys == 0


@pytest.mark.parametrize("attach_to", ["FACES", "REST"])
def test_a_bake_is_out_of_date_where_faces_come_or_go(attach_to):
    surface, obj = flickering({4, 5})
    obj.dapple.attach_to = attach_to
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    modifier = surface.modifiers["Delete"]
    surface.animation_data_clear()
    for frame, bare in ((2, True), (4, False)):
        modifier.show_viewport = bare
        bpy.context.scene.frame_set(frame)
        assert stale(obj) != ""
        assert len(scenes.instance_matrices(obj)) == 0


def test_what_moves_is_noted_where_there_are_faces():
    """Contents of the middle and last frame are those of the frames before, if these are bare."""
    _, obj = flickering({5, 6, 10})
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    stone = scenes.sphere(location=(1.0, 0.0, 0.0), scale=(0.2, 0.2, 0.2))
    bpy.context.collection.objects.unlink(stone)
    stones.objects.link(stone)
    for frame, x in ((1, 1.0), (10, 1.5)):
        stone.location.x = x
        stone.keyframe_insert("location", frame=frame)
    scenes.activate(obj)
    obj.dapple.density.avoid_collection = stones
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in range(1, 11):
        bpy.context.scene.frame_set(frame)
        assert stale(obj) == "", frame
    image = bpy.data.images.new("Picture", 4, 4)
    obj.dapple.density.image = image
    assert "settings" in stale(obj).lower() or stale(obj) != ""


def test_a_bake_over_bare_frames_is_exported(tmp_path, needs_exporter):
    bare = {1, 4, 5, 10}
    _, obj = flickering(bare)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    counts = {frame: shown(obj, frame) for frame in range(1, 11)}
    table = tmp_path / "points.csv"
    assert bpy.ops.dapple.export_points(filepath=str(table), animation=True) == {"FINISHED"}
    with table.open() as file:
        frames = [int(float(row["frame"])) for row in csv.DictReader(file)]
    assert {frame: frames.count(frame) for frame in counts} == counts
    arrays = tmp_path / "points.npz"
    with pytest.raises(RuntimeError, match=r"ids of frames.1. are others than before: CSV can"):
        bpy.ops.dapple.export_points(filepath=str(arrays), animation=True)
    assert not arrays.exists()
    bpy.context.scene.frame_set(6)
    assert bpy.ops.dapple.export_points(filepath=str(arrays)) == {"FINISHED"}
    with np.load(arrays) as stored:
        assert len(stored["ids"].ravel()) == counts[6]
    needs_exporter(".usda")
    text = tmp_path / "points.usda"
    assert bpy.ops.dapple.export_points(filepath=str(text), animation=True) == {"FINISHED"}
    usd = pytest.importorskip("pxr.Usd")
    geom = pytest.importorskip("pxr.UsdGeom")
    stage = usd.Stage.Open(str(text))
    (found,) = [prim for prim in stage.Traverse() if prim.IsA(geom.PointInstancer)]
    instancer = geom.PointInstancer(found)
    for frame, count in counts.items():
        assert len(instancer.GetPositionsAttr().Get(frame) or ()) == count
        assert len(instancer.GetProtoIndicesAttr().Get(frame) or ()) == count


def test_a_frame_without_faces_is_exported_alone_as_what_it_is(tmp_path):
    assert flickering({4})
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(4)
    with pytest.raises(RuntimeError, match="shows no instances"):
        bpy.ops.dapple.export_points(filepath=str(tmp_path / "points.csv"))
    assert list(tmp_path.iterdir()) == []


def test_a_stopped_bake_goes_on_where_faces_are_cut():
    _, obj = flickering({3, 4, 8})
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    stone = scenes.sphere(location=(1.0, 0.0, 0.0), scale=(0.2, 0.2, 0.2))
    stones.objects.link(stone)
    obj.dapple.density.avoid_collection = stones
    scenes.activate(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    files = addon_host.part("blender.freshness.unfinished_bakes").work_files(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    whole = packed(obj)
    for kept in (4, 5, 6, 9):
        for path in sorted(files.folder.iterdir())[kept:]:
            path.unlink()
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert packed(obj) == whole
