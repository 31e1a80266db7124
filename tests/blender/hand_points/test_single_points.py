# SPDX-License-Identifier: GPL-3.0-or-later
"""Single points that are added, moved and removed; the others are evened out around them."""

import importlib
from functools import partial
from types import SimpleNamespace

import addon_host
import bmesh
import bpy
import numpy as np
import pressing
import pytest
import scenes
from contents import reason
from test_keep_points import stored


def columns(obj):
    return addon_host.part("blender.scatter.points").point_columns_of(obj)


def ids(obj):
    return columns(obj)["id"]


def place(obj, identity):
    return scenes.positions(obj)[np.flatnonzero(ids(obj) == identity)[0]]


def locked(obj):
    values = np.empty(len(obj.data.vertices), dtype=np.bool_)
    obj.data.attributes["dapple_locked"].data.foreach_get("value", values)
    return set(ids(obj)[values].tolist())


def clear_cut(obj):
    """All stored data is consistent: no unbound or duplicate points, none off the surface."""
    assert len(np.unique(ids(obj))) == len(ids(obj)) == obj.dapple.report.count
    assert obj.dapple.locked_count == len(locked(obj))
    assert np.linalg.norm(scenes.positions(obj), axis=1).min() > 0.95
    assert not scenes.node_warnings(obj) or reason(obj)


@pytest.fixture
def obj():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32)
    made = scenes.scattered(bpy.context.object, count=600)
    made.dapple.auto_update_mode = "OFF"
    return made


def off_surface(direction, by=1.3):
    return by * np.array(direction, float) / np.linalg.norm(direction)


def test_a_point_is_added_moved_and_removed_by_scripts(obj):
    before = stored(obj)
    assert bpy.ops.dapple.add_point(location=off_surface((1, 2, 3))) == {"FINISHED"}
    clear_cut(obj)
    assert obj.dapple.count == len(ids(obj)) == 601
    assert locked(obj) == {600}
    apart = np.linalg.norm(place(obj, 600) - off_surface((1, 2, 3), 1.0))
    assert apart < 0.01
    assert bpy.ops.dapple.move_point(id=7, location=off_surface((-1, 0, 1))) == {"FINISHED"}
    clear_cut(obj)
    assert locked(obj) == {7, 600}
    assert np.linalg.norm(place(obj, 7) - off_surface((-1, 0, 1), 1.0)) < 0.01
    assert bpy.ops.dapple.remove_point(id=9) == {"FINISHED"}
    clear_cut(obj)
    assert obj.dapple.count == 600
    assert 9 not in ids(obj)
    after = stored(obj)
    assert all(before[key] == after[key] for key in before.keys() - {7, 9})
    assert "Points were placed by hand" in reason(obj)


def test_what_cannot_be_placed_is_reported_and_nothing_changes(obj):
    before = scenes.snapshot()
    for name in ("move_point", "remove_point"):
        with pytest.raises(RuntimeError, match="'Sphere Scatter' has no point 4000"):
            getattr(bpy.ops.dapple, name)(id=4000)
    obj.dapple.surface.modifiers.new("Subdivision", "SUBSURF").render_levels = 1
    for name, options in (
        ("add_point", {}),
        ("move_point", {"id": 3}),
        ("remove_point", {"id": 3}),
    ):
        with pytest.raises(RuntimeError, match="is out of date: attached to"):
            getattr(bpy.ops.dapple, name)(**options)
    obj.dapple.surface.modifiers.clear()
    assert scenes.snapshot() == before
    assert reason(obj) == ""
    bpy.context.scene.frame_end = 2
    bpy.ops.dapple.bake()
    for name in ("add_point", "edit_points"):
        with pytest.raises(RuntimeError, match="clear the bake to edit points"):
            getattr(bpy.ops.dapple, name)()


def change_points(obj, moved=(), removed=(), added=(), copied=()):
    """Change points as an artist does in Edit Mode."""
    mesh = bmesh.from_edit_mesh(obj.data)
    mesh.verts.ensure_lookup_table()
    verts = list(mesh.verts)
    for row, where in moved:
        verts[row].co = where
    for row, where in copied:
        (copy,) = bmesh.ops.duplicate(mesh, geom=[verts[row]])["geom"]
        copy.co = where
    for where in added:
        mesh.verts.new(where)
    bmesh.ops.delete(mesh, geom=[verts[row] for row in removed], context="VERTS")
    bmesh.update_edit_mesh(obj.data)


def edited(obj, **changes):
    assert bpy.ops.dapple.edit_points() == {"FINISHED"}
    assert obj.mode == "EDIT"
    assert bpy.context.tool_settings.mesh_select_mode[:] == (True, False, False)
    change_points(obj, **changes)
    assert bpy.ops.dapple.finish_editing_points() == {"FINISHED"}
    assert obj.mode == "OBJECT"


def test_points_are_edited_in_edit_mode(obj):
    before = stored(obj)
    edited(
        obj,
        moved=[(3, off_surface((0, 0, 1))), (5, off_surface((0, 0.3, 1)))],
        removed=[10, 11, 12],
        added=[off_surface((1, 0, 0.2))],
        copied=[(20, off_surface((1, 0.2, 0.4)))],
    )
    clear_cut(obj)
    after = stored(obj)
    assert obj.dapple.count == len(after) == 599
    assert before.keys() - after.keys() == {10, 11, 12}
    assert after.keys() - before.keys() == {600, 601}
    assert locked(obj) == {3, 5, 600, 601}
    assert all(before[key] == after[key] for key in before.keys() & after.keys() - {3, 5})
    assert np.linalg.norm(place(obj, 3) - [0, 0, 1]) < 0.01
    assert "dapple_placed" not in obj.data.attributes
    assert not bpy.ops.dapple.finish_editing_points.poll()


def test_what_extruding_and_a_click_make_are_points(obj):
    bpy.ops.dapple.edit_points()
    mesh = bmesh.from_edit_mesh(obj.data)
    mesh.verts.ensure_lookup_table()
    made = bmesh.ops.extrude_vert_indiv(mesh, verts=[mesh.verts[4]])
    made["verts"][0].co = off_surface((0, 0.1, 1))
    bmesh.update_edit_mesh(obj.data)
    assert bpy.ops.dapple.place_point(location=off_surface((1, 0.1, 0), 1.0)) == {"FINISHED"}
    assert obj.mode == "EDIT"
    assert [vertex.select for vertex in bmesh.from_edit_mesh(obj.data).verts].count(True) == 1
    assert bpy.ops.dapple.finish_editing_points() == {"FINISHED"}
    assert not obj.data.edges
    clear_cut(obj)
    assert locked(obj) == {600, 601}


def test_a_ray_meets_the_surface_alone(obj):
    rays = addon_host.part("blender.hand_points.picking").Rays
    down, surface = np.array((0.0, 0.0, -1.0)), obj.dapple.surface
    surface.location.x = 1.0
    bpy.context.view_layer.update()
    there = rays(surface).first(np.array((1.01, 0.02, 5.0)), down)
    np.testing.assert_allclose(there.place, [1.01, 0.02, 1.0], atol=0.01)
    np.testing.assert_allclose(there.normal, [0.0, 0.0, 1.0], atol=0.1)
    assert rays(surface).first(np.array((3.0, 0.0, 5.0)), down) is None
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    ball = rays(bpy.context.object)
    assert ball.first(np.array((0.1, 0.1, 5.0)), down).place[2] > 0.5


def test_nothing_edited_changes_nothing(obj):
    before, settings = stored(obj), obj.dapple.solved_settings
    edited(obj)
    assert stored(obj) == before
    assert obj.dapple.solved_settings == settings
    assert reason(obj) == ""
    assert not obj.dapple.locked_count


def test_the_way_back_is_open_after_edit_mode_was_left_otherwise(obj):
    assert bpy.ops.dapple.edit_points() == {"FINISHED"}
    change_points(obj, moved=[(3, off_surface((0, 0, 1)))])
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.dapple.finish_editing_points() == {"FINISHED"}
    assert locked(obj) == {3}


def test_what_cannot_be_attached_stays_in_edit_mode(obj):
    bpy.ops.dapple.edit_points()
    change_points(obj, moved=[(3, off_surface((0, 0, 1)))])
    obj.dapple.surface.modifiers.new("Subdivision", "SUBSURF").render_levels = 1
    with pytest.raises(RuntimeError, match="is out of date: attached to"):
        bpy.ops.dapple.finish_editing_points()
    assert obj.mode == "EDIT"
    obj.dapple.surface.modifiers.clear()
    assert bpy.ops.dapple.finish_editing_points() == {"FINISHED"}
    assert locked(obj) == {3}


def test_points_edited_otherwise_are_not_taken_for_unchanged(obj):
    obj.data.vertices[3].co.z += 0.1
    obj.data.update()
    with pytest.raises(RuntimeError, match="were edited by hand: reattach them"):
        bpy.ops.dapple.edit_points()
    assert obj.mode == "OBJECT"


def test_on_a_posed_surface_the_points_are_shown_where_it_is():
    obj = scenes.scattered(scenes.tail())
    bpy.context.scene.frame_set(6)
    there = scenes.positions(obj)
    bpy.ops.dapple.edit_points()
    bpy.ops.object.mode_set(mode="OBJECT")
    meshio = addon_host.part("blender.base.mesh_arrays")
    np.testing.assert_allclose(meshio.read_points(obj.data), there, atol=1e-4)
    bpy.ops.object.mode_set(mode="EDIT")
    change_points(obj, moved=[(4, there[5] + 0.02)])
    bpy.ops.dapple.finish_editing_points()
    assert locked(obj) == {4}
    assert np.linalg.norm(scenes.positions(obj)[4] - there[5]) < 0.05
    np.testing.assert_allclose(np.delete(scenes.positions(obj), 4, 0), np.delete(there, 4, 0), 1e-5)


def test_points_at_rest_are_placed_too():
    obj = scenes.scattered(scenes.tail(levels=1, render_levels=2))
    assert obj.dapple.attached_to == "REST"
    there = scenes.positions(obj)
    edited(obj, moved=[(4, there[5] + 0.02)], removed=[9])
    assert obj.dapple.attached_to == "REST"
    found = scenes.positions(obj)
    assert np.linalg.norm(found[4] - there[5]) < 0.06
    np.testing.assert_allclose(np.delete(found, 4, 0), np.delete(there, [4, 9], 0), atol=1e-4)


def test_placed_points_keep_their_direction_and_follow_the_forward_axis(obj):
    obj.dapple.random_turn = 0.0
    obj.dapple.forward = "X"
    bpy.ops.dapple.optimize()
    bpy.ops.dapple.add_point(location=off_surface((0, 0.2, 1)))
    row = np.flatnonzero(ids(obj) == 600)[0]
    assert scenes.rotations(obj)[row][:, 0] @ [1, 0, 0] > 0.9


def test_exact_counts_of_object_types_follow(obj):
    for _ in range(2):
        bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[1].use_count, obj.dapple.object_types[1].count = True, 50
    bpy.ops.dapple.optimize()
    bpy.ops.dapple.add_point(location=off_surface((0, 0.2, 1)), object_type=1)
    assert obj.dapple.object_types[1].count == 51
    assert obj.dapple.count == 601
    assert np.bincount(columns(obj)["dapple_object_type"]).tolist() == [550, 51]
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 601
    assert obj.dapple.locked_count == 1


@pytest.mark.parametrize("amount", ["COUNT", "PER_AREA"])
def test_auto_update_evens_the_others_around_them(live, obj, amount):
    obj.dapple.auto_update_mode = "ON"
    obj.dapple.count, obj.dapple.points_per_area, obj.dapple.amount = 2000, 160.0, amount
    live.settle()
    bpy.ops.dapple.optimize()
    live.settle()
    there, count = scenes.positions(obj), len(ids(obj))
    top, side = off_surface((0, 0.01, 1), 1.0), off_surface((1, 0.01, 0.3), 1.0)
    reach, before = 10.0 * obj.dapple.report.spacing, stored(obj)
    away = np.array([np.linalg.norm(there - one, axis=1) for one in (top, side)])
    far = set(ids(obj)[away.min(axis=0) > reach].tolist())
    hole = np.argsort(away[1])[:3].tolist()
    crowd = [(x, 0.01, 1.2) for x in (0.0, 0.04)]
    edited(obj, removed=hole, added=crowd)
    assert len(ids(obj)) == count - 1
    assert live.settle() == 1
    assert reason(obj) == ""
    after = stored(obj)
    assert len(after) == len(scenes.positions(obj)) == obj.dapple.report.count == count - 1
    assert obj.dapple.report.measured
    assert len(locked(obj)) == 2
    assert len(far) > 1000
    assert np.mean([before[key] == after.get(key) for key in far]) >= 0.99
    apart = np.linalg.norm(scenes.positions(obj) - side, axis=1)
    assert apart.min() < 0.75 * obj.dapple.report.spacing  # the hole is closed
    assert obj.dapple.report.capacity_variation < 0.02
    assert live.settle() == 0


def test_undo_is_one_step(live, obj):
    obj.dapple.auto_update_mode = "ON"
    name = obj.name
    live.settle()
    before = stored(obj)
    bpy.ops.ed.undo_push(message="Before")
    assert bpy.ops.dapple.add_point("EXEC_DEFAULT", True, location=off_surface((1, 2, 3)))
    live.settle()
    evened = stored(bpy.data.objects[name])
    assert len(evened) == 601
    bpy.ops.ed.undo()
    live.settle()
    obj = bpy.data.objects[name]
    assert obj.dapple.count == len(stored(obj)) == 600
    assert stored(obj) == before
    assert reason(obj) == ""
    bpy.ops.ed.redo()
    live.settle()
    obj = bpy.data.objects[name]
    assert stored(obj).keys() == evened.keys()
    assert reason(obj) == ""
    assert len(locked(obj)) == 1


def test_done_is_undone_into_edit_mode_and_redone(obj):
    name = obj.name
    bpy.ops.ed.undo_push(message="Before")
    assert bpy.ops.dapple.edit_points("EXEC_DEFAULT", True) == {"FINISHED"}
    change_points(obj, moved=[(3, off_surface((0, 0, 1)))])
    bpy.ops.ed.undo_push(message="Move")
    assert bpy.ops.dapple.finish_editing_points("EXEC_DEFAULT", True) == {"FINISHED"}
    assert locked(bpy.data.objects[name]) == {3}
    bpy.ops.ed.undo()
    assert bpy.data.objects[name].mode == "EDIT"
    assert bpy.ops.dapple.finish_editing_points.poll()
    bpy.ops.ed.redo()
    assert bpy.data.objects[name].mode == "OBJECT"
    assert locked(bpy.data.objects[name]) == {3}
    for _ in range(3):
        bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    assert obj.mode == "OBJECT"
    assert "dapple_placed" not in obj.data.attributes
    assert not obj.dapple.locked_count


class Pulled:
    """A line to the mouse, that notes where it ends while it is there."""

    def __init__(self, lines, start):
        self.lines = lines
        self.to(start)

    def to(self, end):
        self.lines[:] = [end]

    def remove(self):
        self.lines.clear()


class Mouse:
    """Events over a place, in a window that records its calls."""

    def __init__(self, monkeypatch):
        self.tool = addon_host.part("blender.hand_points.tool")
        self.reported, self.cursor, self.lines = [], [], []
        monkeypatch.setattr(self.tool, "Line", lambda _, start: Pulled(self.lines, start))
        monkeypatch.setattr(self.tool, "place_under_mouse", lambda _, event: event.place)

    def event(self, kind, value, place, at):
        return SimpleNamespace(
            type=kind,
            value=value,
            place=place,
            mouse_x=at,
            mouse_y=0,
            mouse_region_x=at,
            mouse_region_y=0,
        )

    def press(self, place, remove=False):
        kind = self.tool.DAPPLE_OT_pull_point
        self.button = SimpleNamespace(
            remove=remove,
            bl_label=kind.bl_label,
            report=lambda kinds, text: self.reported.append((*kinds, text)),
        )
        for name in pressing.own_methods(kind):
            setattr(self.button, name, partial(getattr(kind, name), self.button))
        return kind.invoke(self.button, self.context(), self.event("LEFTMOUSE", "PRESS", place, 0))

    def to(self, kind, value, place, at=50):
        return self.button.modal(self.context(), self.event(kind, value, place, at))

    def context(self):
        cursor = SimpleNamespace(
            cursor_modal_set=self.cursor.append, cursor_modal_restore=self.cursor.clear
        )
        manager = SimpleNamespace(modal_handler_add=lambda _: None)
        return SimpleNamespace(object=bpy.context.object, window=cursor, window_manager=manager)


def test_the_tool_adds_pulls_and_removes_points(obj, monkeypatch):
    mouse = Mouse(monkeypatch)
    there, before = scenes.positions(obj), stored(obj)
    between = off_surface(there[3] + 0.3 * there[9], 1.0)
    gap = max(
        (off_surface(one, 1.0) for one in np.random.default_rng(0).normal(size=(300, 3))),
        key=lambda one: np.linalg.norm(there - one, axis=1).min(),
    )
    assert mouse.press(gap) == {"FINISHED"}
    assert locked(obj) == {600}
    assert mouse.press(there[3]) == {"RUNNING_MODAL"}
    assert mouse.cursor == ["SCROLL_XY"]
    assert mouse.to("MOUSEMOVE", "NOTHING", between) == {"RUNNING_MODAL"}
    assert mouse.lines == [(50, 0)]
    assert mouse.to("LEFTMOUSE", "RELEASE", between) == {"FINISHED"}
    assert mouse.cursor == mouse.lines == []
    assert locked(obj) == {3, 600}
    assert np.linalg.norm(place(obj, 3) - between) < 0.01
    assert mouse.press(there[9], remove=True) == {"FINISHED"}
    assert 9 not in ids(obj)
    after = stored(obj)
    assert all(before[key] == after[key] for key in before.keys() - {3, 9})
    clear_cut(obj)


def test_the_tool_leaves_what_is_not_meant(obj, monkeypatch):
    mouse = Mouse(monkeypatch)
    there, before = scenes.positions(obj), stored(obj)
    assert mouse.press(None) == {"CANCELLED"}
    assert mouse.reported == [("WARNING", "The surface is not under the mouse")]
    for kind, value, at in (("ESC", "PRESS", 50), ("LEFTMOUSE", "RELEASE", 2)):
        assert mouse.press(there[3]) == {"RUNNING_MODAL"}
        assert mouse.to(kind, value, there[30], at) == {"CANCELLED"}
        assert mouse.cursor == mouse.lines == []
    assert mouse.press(there[3]) == {"RUNNING_MODAL"}
    assert mouse.to("LEFTMOUSE", "RELEASE", None) == {"CANCELLED"}
    assert mouse.press(off_surface((0, 0, 1), 3.0), remove=True) == {"CANCELLED"}
    assert stored(obj) == before
    assert reason(obj) == ""


def test_the_tool_is_added_and_taken_back():
    tools = importlib.import_module("bl_ui.space_toolsystem_toolbar").VIEW3D_PT_tools_active
    tool = addon_host.part("blender.hand_points.tool")
    before = list(tools._tools["OBJECT"])
    tool.add_tool()
    assert "dapple.points" in [getattr(one, "idname", "") for one in flat(tools._tools["OBJECT"])]
    tool.unregister()
    assert tools._tools["OBJECT"] == before


def flat(tools):
    for one in tools:
        yield from one if isinstance(one, tuple) and not hasattr(one, "idname") else (one,)
