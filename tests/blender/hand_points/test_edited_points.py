# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a scatter that an artist deleted, moved, added or copied in Edit Mode."""

import addon_host
import bmesh
import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def obj():
    made = scenes.scattered(scenes.tail(frames=3))
    bpy.context.scene.frame_end = 3
    return made


def edited(obj, change):
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(obj.data)
    change(mesh, list(mesh.verts))
    bmesh.update_edit_mesh(obj.data)
    bpy.ops.object.mode_set(mode="OBJECT")


def deleted(mesh, points):
    bmesh.ops.delete(mesh, geom=points[:7], context="VERTS")


def added(mesh, points):
    for height in (1.0, 2.0, 3.0):
        mesh.verts.new((0.6, 0.0, height))


def copied(mesh, points):
    bmesh.ops.duplicate(mesh, geom=points[:3])


def all_deleted(mesh, points):
    bmesh.ops.delete(mesh, geom=points, context="VERTS")


def reason(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def columns(obj):
    return addon_host.part("blender.scatter.points").point_columns_of(obj)


def test_after_deleting_points_all_goes_on(obj):
    ids = columns(obj)["id"]
    edited(obj, deleted)
    said = "7 points were removed by hand: reattach to keep the others, or optimize"
    assert reason(obj) == said
    for action in (bpy.ops.dapple.make_tiles, bpy.ops.dapple.bake, bpy.ops.dapple.reattach):
        assert action() == {"FINISHED"}
        assert len(scenes.positions(obj)) == 53
        assert scenes.node_warnings(obj) == []
    assert (columns(obj)["id"] == ids[7:]).all()
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 60


@pytest.mark.parametrize("name", ["bake", "make_tiles", "live_preview"])
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            added,
            "point 60 was added by hand and is not attached to the surface: Reattach attaches it",
        ),
        (copied, r"point 60 was copied by hand, its id \d+ is that of another one: Reattach"),
    ],
)
def test_points_that_nothing_binds_are_named_with_the_way_out(obj, change, words, name):
    edited(obj, change)
    assert reason(obj) == "3 points were added by hand: reattach them, or lock them and optimize"
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match=f"Scatter '{obj.name}': {words}"):
        getattr(bpy.ops.dapple, name)()
    assert scenes.snapshot() == before


@pytest.mark.parametrize("change", [added, copied])
def test_re_bind_takes_added_and_copied_points_in(obj, change):
    before = columns(obj)
    edited(obj, change)
    assert bpy.ops.dapple.reattach() == {"FINISHED"}
    assert reason(obj) == ""
    now = columns(obj)
    assert sorted(now["id"]) == list(range(63))
    assert all((now[name][:60] == before[name]).all() for name in before)
    assert len(np.unique(now["dapple_scale"])) == 63
    ranks = [rank.value for rank in obj.data.attributes["dapple_rank"].data]
    assert len(set(ranks)) == 63
    assert (now["dapple_density"] == 1.0).all()
    for action in (bpy.ops.dapple.make_tiles, bpy.ops.dapple.bake):
        assert action() == {"FINISHED"}
        assert len(scenes.positions(obj)) == 63
    assert obj.dapple.report.count == 63


def test_re_bind_takes_moved_points_where_they_were_moved(obj):
    expected = scenes.positions(obj)

    def moved(mesh, points):
        for point in points[:5]:
            point.co.z += 0.3 if point.co.z < 2.0 else -0.3

    edited(obj, moved)
    assert bpy.ops.dapple.reattach() == {"FINISHED"}
    apart = np.linalg.norm(scenes.positions(obj) - expected, axis=1)
    assert apart[:5].min() > 0.05
    assert apart[:5].max() < 0.45
    assert apart[5:].max() < 1e-4


def test_points_added_under_a_bake_are_said_in_the_panel_too(obj):
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    edited(obj, added)
    said = "Points were added or removed since the bake: bake again"
    assert reason(obj) == said
    assert scenes.node_warnings(obj) == [said]
    assert bpy.ops.dapple.reattach() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 63
    assert scenes.node_warnings(obj) == []


@pytest.mark.parametrize("name", ["bake", "make_tiles", "reattach", "optimize"])
def test_without_any_point_left_nothing_is_placed_until_optimized(obj, name):
    edited(obj, all_deleted)
    assert getattr(bpy.ops.dapple, name)() == {"FINISHED"}
    assert len(scenes.positions(obj)) == (60 if name == "optimize" else 0)
    assert scenes.node_warnings(obj) == []


def test_edited_points_are_saved(obj, tmp_path):
    edited(obj, deleted)
    expected = scenes.positions(obj)
    path = str(tmp_path / "edited.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Tail Scatter"]
    assert (scenes.positions(obj) == expected).all()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 53
