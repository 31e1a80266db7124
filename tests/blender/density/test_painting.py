# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting on the surface of a scatter: there with one click, back with another."""

from types import SimpleNamespace

import addon_host
import bpy
import following
import pytest
import scenes
import test_panels
from test_failures import everything
from test_undo import state

OPERATORS = ("paint_density", "paint_blocked_areas")


@pytest.fixture
def obj():
    return scenes.scattered(scenes.sphere())


def paint(name, **options):
    return getattr(bpy.ops.dapple, name)("EXEC_DEFAULT", True, **options)


def weights(surface, name):
    group = surface.vertex_groups[name].index
    return [
        next((one.weight for one in vertex.groups if one.group == group), 0.0)
        for vertex in surface.data.vertices
    ]


def upper_half(surface, weight):
    """Change weights as a stroke over the upper half does."""
    upper = [vertex.index for vertex in surface.data.vertices if vertex.co.z > 0.0]
    surface.vertex_groups.active.add(upper, weight, "REPLACE")
    surface.data.update()


def above(obj):
    return int((scenes.positions(obj)[:, 2] > 0.27).sum())


def situation():
    """What a panel and an undo must agree on."""
    found = state()
    surface = bpy.data.objects["Sphere"]
    found["mode"] = (bpy.context.mode, bpy.context.object.name)
    found["groups"] = {one.name: weights(surface, one.name) for one in surface.vertex_groups}
    found["painted"] = bpy.context.scene.dapple_painted
    return found


def test_one_click_is_there_and_another_is_back(obj):
    surface = obj.dapple.surface
    assert "dapple.paint_density" in test_panels.drawn()
    assert paint("paint_density") == {"FINISHED"}
    assert (bpy.context.mode, bpy.context.object) == ("PAINT_WEIGHT", surface)
    assert bpy.context.selected_objects == [surface]
    name = obj.dapple.density.attribute
    assert surface.vertex_groups.active.name == name == f"{obj.name} Density"
    assert set(weights(surface, name)) == {0.5}
    assert paint("finish_painting") == {"FINISHED"}
    assert (bpy.context.mode, bpy.context.object) == ("OBJECT", obj)
    assert bpy.context.selected_objects == [obj]
    assert not bpy.ops.dapple.finish_painting.poll()


def test_a_new_group_takes_nothing_from_an_amount_by_area(obj):
    obj.dapple.amount = "PER_AREA"
    paint("paint_density")
    assert set(weights(obj.dapple.surface, obj.dapple.density.attribute)) == {1.0}


def test_the_first_stroke_can_gather_points(obj):
    obj.dapple.auto_update_mode = "ON"
    with following.driven() as live:
        paint("paint_density")
        live.settle()
        before = above(obj)
        upper_half(obj.dapple.surface, 1.0)
        live.settle()
        assert above(obj) > 1.2 * before


def test_the_group_in_use_is_taken_as_it_is(obj):
    surface = obj.dapple.surface
    for name in ("Other", "Grass", "Last"):
        surface.vertex_groups.new(name=name).add([3, 4], 0.5, "REPLACE")
    obj.dapple.density.attribute = "Grass"
    for _ in range(2):
        paint("paint_density")
        assert surface.vertex_groups.active.name == obj.dapple.density.attribute == "Grass"
        paint("finish_painting")
    assert len(surface.vertex_groups) == 3
    assert sum(weights(surface, "Grass")) == 1.0


def test_the_group_of_another_scatter_is_left_alone(obj):
    surface = obj.dapple.surface
    paint("paint_density")
    paint("finish_painting")
    second = scenes.scattered(surface)
    paint("paint_density")
    assert second.dapple.density.attribute != obj.dapple.density.attribute
    assert len(surface.vertex_groups) == 2


def test_a_result_is_compared_while_its_surface_is_painted(obj, monkeypatch):
    """A sidebar shows the scatter then, though another object is active."""
    sidebars = addon_host.part("blender.base.sidebars")
    monkeypatch.setattr(sidebars, "bpy", one_window())
    assert sidebars.is_shown(obj)
    paint("paint_density")
    assert sidebars.is_shown(obj)
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not sidebars.is_shown(obj)


def one_window():
    """Replaces bpy with one that has a 3D View with a sidebar."""
    sidebar = SimpleNamespace(active=SimpleNamespace(show_region_ui=True))
    area = SimpleNamespace(type="VIEW_3D", spaces=sidebar, regions=[SimpleNamespace(type="UI")])
    window = SimpleNamespace(
        screen=SimpleNamespace(areas=[area]),
        scene=bpy.context.scene,
        view_layer=bpy.context.view_layer,
    )
    managers = [SimpleNamespace(windows=[window])]
    return SimpleNamespace(data=SimpleNamespace(window_managers=managers), types=bpy.types)


def test_points_follow_a_stroke_while_one_paints(obj):
    obj.dapple.auto_update_mode = "ON"
    with following.driven() as live:
        paint("paint_density")
        live.settle()
        assert above(obj) > 10
        upper_half(obj.dapple.surface, 0.0)
        assert live.settle() == 1
        assert above(obj) == 0
        assert bpy.context.mode == "PAINT_WEIGHT"
        assert "% of ideal, up to date" in " ".join(test_panels.drawn())


def test_pen_pressure_and_airbrush_stay_as_they_are(obj):
    """Painting enters and leaves the mode; what the brush does is the artist's."""
    brush = bpy.data.brushes.new("Own", mode="WEIGHT_PAINT")
    brush.use_pressure_strength, brush.stroke_method, brush.strength = True, "AIRBRUSH", 0.3
    paint("paint_density")
    used = bpy.context.tool_settings.weight_paint.brush or brush
    for one in (used, brush):
        one.use_pressure_strength, one.stroke_method = True, "AIRBRUSH"
    paint("finish_painting")
    paint("paint_density")
    for one in (used, brush):
        assert (one.use_pressure_strength, one.stroke_method) == (True, "AIRBRUSH")
    assert brush.strength == pytest.approx(0.3)


def test_points_wait_for_the_end_of_an_airbrush_stroke(obj, monkeypatch):
    """It goes on changing weights while the mouse rests, in one running stroke."""
    activity = addon_host.part("blender.base.activity")
    obj.dapple.auto_update_mode = "ON"
    with following.driven() as live:
        paint("paint_density")
        live.settle()
        before = above(obj)
        monkeypatch.setattr(activity, "is_painting", lambda: True)
        for weight in (0.4, 0.2, 0.0):
            upper_half(obj.dapple.surface, weight)
            for _ in range(3):
                live.look()
                live.clock.rest()
            assert above(obj) == before
        monkeypatch.undo()
        assert live.settle() >= 1
        assert above(obj) == 0


def test_what_was_asked_for_is_called_so_while_one_paints(live, obj):
    paint("paint_density")
    live.watcher.request(obj)
    assert "Optimizing: 0%" in test_panels.drawn()


def test_what_is_blocked_stays_free_whatever_the_density_is(obj):
    obj.dapple.auto_update_mode = "ON"
    surface = obj.dapple.surface
    with following.driven() as live:
        paint("paint_density")
        paint("finish_painting")
        paint("paint_blocked_areas")
        name = obj.dapple.density.blocked_areas
        assert surface.vertex_groups.active.name == name == f"{obj.name} Blocked"
        assert set(weights(surface, name)) == {0.0}
        live.settle()
        assert above(obj) > 10
        assert "has no points" in " ".join(test_panels.drawn())
        upper_half(surface, 1.0)
        assert live.settle() == 1
        assert above(obj) == 0
        surface.vertex_groups.active_index = 0
        assert "Painting the density" in " ".join(test_panels.drawn())


def test_the_panel_goes_on_showing_the_scatter(obj):
    paint("paint_density")
    shown = test_panels.drawn()
    assert {"dapple.finish_painting", "count", "auto_update"} <= set(shown)
    # some versions of Blender have no brush
    if bpy.context.tool_settings.weight_paint.brush is not None:
        assert {"weight", "strength", "use_pressure_strength"} <= set(shown)
    assert "dapple.add_scatter" not in shown
    assert f"Painting the density of '{obj.name}'" in " ".join(shown)
    obj.dapple.surface.vertex_groups.new(name="Else")
    obj.dapple.surface.vertex_groups.active_index = 1
    assert f"'{obj.name}' does not use the active vertex group" in " ".join(test_panels.drawn())


def test_the_panel_does_not_lie_after_leaving_by_hand(obj):
    surface = obj.dapple.surface
    paint("paint_density")
    bpy.ops.object.mode_set(mode="OBJECT")
    shown = test_panels.drawn()
    assert {"dapple.add_scatter", "dapple.select_scatter"} <= set(shown)
    assert "dapple.finish_painting" not in shown
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    assert "dapple.finish_painting" in test_panels.drawn()
    bpy.ops.object.mode_set(mode="OBJECT")
    other = scenes.sphere()
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    assert bpy.context.object == other != surface
    assert "dapple.finish_painting" not in test_panels.drawn()


@pytest.mark.parametrize("gone", ["scatter", "surface", "unlinked"])
def test_what_is_deleted_meanwhile_is_missed_by_nobody(obj, gone):
    surface = obj.dapple.surface
    paint("paint_density")
    if gone == "unlinked":
        bpy.context.collection.objects.unlink(obj)
    else:
        bpy.data.objects.remove(obj if gone == "scatter" else surface)
    assert not bpy.ops.dapple.finish_painting.poll()
    test_panels.drawn()
    if gone == "surface":
        scenes.activate(obj)
        with pytest.raises(RuntimeError, match="has no surface"):
            paint("paint_density")


def test_a_hidden_scatter_is_come_back_to(obj):
    paint("paint_density")
    obj.hide_set(True)
    assert paint("finish_painting") == {"FINISHED"}
    assert (bpy.context.mode, bpy.context.object) == ("OBJECT", obj)


@pytest.mark.parametrize("name", OPERATORS)
def test_undo_of_entering_and_of_leaving(obj, name):
    bpy.ops.ed.undo_push(message="Before")
    before = situation()
    paint(name)
    painting = situation()
    assert painting["mode"] == ("PAINT_WEIGHT", "Sphere")
    paint("finish_painting")
    after = situation()
    for _ in range(2):
        bpy.ops.ed.undo()
        assert situation() == painting
        assert "dapple.finish_painting" in test_panels.drawn()
        bpy.ops.ed.undo()
        assert situation() == before
        bpy.ops.ed.redo()
        assert situation() == painting
        bpy.ops.ed.redo()
        assert situation() == after


def test_a_file_saved_while_painting_knows_the_scatter(obj, tmp_path):
    path, name = str(tmp_path / "painting.blend"), obj.name
    paint("paint_density")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.context.mode == "PAINT_WEIGHT"
    assert paint("finish_painting") == {"FINISHED"}
    assert bpy.context.object.name == name


def shared(obj, surface):
    bpy.context.collection.objects.link(bpy.data.objects.new("Twin", surface.data))


def hidden(obj, surface):
    surface.hide_set(True)


def away(obj, surface):
    bpy.context.collection.objects.unlink(surface)


def faceless(obj, surface):
    surface.data.clear_geometry()


def edited(obj, surface):
    scenes.activate(surface)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.view_layer.objects.active = obj


def lost(obj, surface):
    obj.dapple.surface = None


def curved(obj, surface):
    curve = bpy.data.objects.new("Curve", bpy.data.curves.new("Curve", "CURVE"))
    bpy.context.collection.objects.link(curve)
    obj.dapple.surface = curve


def colored(obj, surface):
    surface.data.attributes.new("Color", "FLOAT", "POINT")
    obj.dapple.density.attribute = obj.dapple.density.blocked_areas = "Color"


def written(obj, surface):
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.1
    obj.dapple.surface = bpy.context.object
    scenes.activate(obj)


TROUBLES = [
    (shared, "shares its mesh with other objects: make it single-user first"),
    (hidden, "Surface 'Sphere' is hidden: show it first"),
    (away, "Surface 'Sphere' is not in the view layer"),
    (faceless, "Surface 'Sphere' has no faces to paint on"),
    (edited, "Surface 'Sphere' is not in Object Mode: leave its mode first"),
    (lost, "has no surface: choose a mesh object"),
    (curved, "Surface 'Curve' is a curve: only meshes have vertex groups"),
    (written, "Surface 'Text' is a text: .*. Object > Convert > Mesh makes a mesh of it"),
    (colored, "uses 'Color', which is not a vertex group of surface 'Sphere'"),
]


@pytest.mark.parametrize("name", OPERATORS)
@pytest.mark.parametrize(("spoil", "message"), TROUBLES)
def test_what_cannot_be_painted_is_reported_and_nothing_changes(obj, spoil, message, name):
    spoil(obj, obj.dapple.surface)
    before = everything()
    with pytest.raises(RuntimeError, match=message):
        paint(name)
    assert everything() == before
    assert bpy.context.mode == "OBJECT"
    assert all(not one.vertex_groups for one in bpy.data.objects)
    assert bpy.context.scene.dapple_painted == ""


@pytest.mark.parametrize("name", OPERATORS)
@pytest.mark.parametrize("kind", ["objects", "meshes"])
def test_a_surface_of_another_file_cannot_be_painted(tmp_path, name, kind):
    path = str(tmp_path / "library.blend")
    scenes.sphere()
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (source, wanted):
        setattr(wanted, kind, getattr(source, kind))
    (found,) = getattr(wanted, kind)
    surface = found if kind == "objects" else bpy.data.objects.new("Sphere", found)
    bpy.context.collection.objects.link(surface)
    obj = scenes.scattered(surface)
    with pytest.raises(RuntimeError, match="linked from"):
        paint(name)
    assert (bpy.context.mode, bpy.context.object) == ("OBJECT", obj)


def test_what_a_new_group_is_called_is_said_once():
    table = addon_host.part("core.settings.density_table")
    settings = {setting.name for setting in table.DENSITY}
    assert {one.setting for one in table.PAINTED.values()} <= settings


def test_it_is_said_where_no_brush_is_chosen(obj, monkeypatch):
    """Some Blenders come without brushes: strokes did nothing, without a message."""
    panel = addon_host.part("blender.density.panel")
    assert panel.lacks_brush("builtin.brush", None)
    assert not panel.lacks_brush("builtin.gradient", None)
    assert not panel.lacks_brush("", None)
    paint("paint_density")
    monkeypatch.setattr(panel, "lacks_brush", lambda *_: True)
    assert "No brush is selected: strokes have no effect" in " ".join(test_panels.drawn())


def test_a_blender_without_brushes_gets_one_to_paint_with(obj, monkeypatch):
    """Debian's comes without them: strokes did nothing, and no menu had a brush to choose."""
    monkeypatch.setattr(addon_host.part("blender.density.painting"), "lacks_brush", lambda *_: True)
    for name in OPERATORS:
        paint(name)
        brush = bpy.context.tool_settings.weight_paint.brush
        assert brush is not None
        assert brush.library is None
        assert [one for one in bpy.data.brushes if one.library is None] == [brush]
        paint("finish_painting")


def test_brushes_that_are_there_are_not_joined_by_another(obj, monkeypatch):
    monkeypatch.setattr(
        addon_host.part("blender.density.painting"), "lacks_brush", lambda *_: False
    )
    paint("paint_density")
    assert not [one for one in bpy.data.brushes if one.library is None]


def test_it_is_said_where_strokes_meet_few_vertices():
    """A stroke over the middle of the default cube did nothing, without a message."""
    note = "has only 8 vertices, and strokes change vertices only: subdivide it to paint finer"
    bpy.ops.mesh.primitive_cube_add()
    scenes.scattered(bpy.context.object)
    paint("paint_density")
    assert f"'Cube' {note}" in " ".join(test_panels.drawn())
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=8)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    assert note not in " ".join(test_panels.drawn())
