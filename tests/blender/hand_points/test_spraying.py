# SPDX-License-Identifier: GPL-3.0-or-later
"""Points sprayed with a brush: strokes of scripts and of the mouse."""

from functools import partial
from types import SimpleNamespace

import addon_host
import bpy
import numpy as np
import pressing
import pytest
import scenes
from contents import reason
from test_keep_points import stored
from test_single_points import clear_cut, ids, locked

TOP = [(0.02 * k, 0.0, 1.0) for k in range(10)]  # a stroke over the top of a unit sphere


@pytest.fixture
def obj():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32)
    return quiet(scenes.scattered(bpy.context.object, count=600))


def quiet(made):
    made.dapple.auto_update_mode = "OFF"
    return made


def dabs(places, pressure=1.0):
    return [{"name": "", "location": place, "pressure": pressure} for place in places]


def spray(places=TOP, pressure=1.0, **options):
    return bpy.ops.dapple.spray_points(stroke=dabs(places, pressure), **options)


def emptied(places=TOP, **options):
    """The number of points that a stroke with Ctrl removes."""
    before = len(bpy.context.object.data.vertices)
    assert spray(places, remove=True, **options) == {"FINISHED"}
    return before - len(bpy.context.object.data.vertices)


def nearest(obj, some):
    """Least distance of points with these ids from all others."""
    places, rows = scenes.positions(obj), np.isin(ids(obj), list(some))
    gaps = np.linalg.norm(places[:, None] - places, axis=2)
    np.fill_diagonal(gaps, np.inf)
    return gaps[rows].min()


def away(obj):
    """Distances from the stroke over the top."""
    end = np.array(TOP[-1])
    places = scenes.positions(obj)
    return np.linalg.norm(places - np.clip(places, (0, 0, 1), end), axis=1)


def test_a_stroke_removes_and_another_fills_the_place(obj):
    before, spacing = stored(obj), obj.dapple.report.spacing
    inside = set(ids(obj)[away(obj) < 2.9 * spacing].tolist())
    count = emptied()
    clear_cut(obj)
    assert inside.isdisjoint(ids(obj))
    assert not locked(obj)
    assert obj.dapple.count == 600 - count
    assert spray() == {"FINISHED"}
    clear_cut(obj)
    new = locked(obj)
    assert 0.8 * count < len(new) < 1.15 * count
    assert nearest(obj, new) > 0.79 * spacing
    assert away(obj)[np.isin(ids(obj), list(new))].max() < 3.05 * spacing
    after = stored(obj)
    assert all(before[key] == after[key] for key in before.keys() & after.keys() - new)
    assert obj.dapple.count == len(after)
    assert "Points were placed by hand" in reason(obj)
    assert spray(TOP[:3]) == {"CANCELLED"} or nearest(obj, locked(obj)) > 0.79 * spacing


def test_a_smaller_spacing_fits_points_between_the_others(obj):
    spacing = obj.dapple.report.spacing
    assert spray() == {"CANCELLED"}
    assert reason(obj) == ""
    assert spray(spacing=0.4) == {"FINISHED"}
    assert len(locked(obj)) > 30
    assert nearest(obj, locked(obj)) > 0.39 * spacing


def test_the_same_stroke_and_seed_give_the_same_points(obj):
    def points(seed):
        obj.dapple.seed = seed
        spray(spacing=0.4)
        found = np.array([vertex.co[:] for vertex in obj.data.vertices])[600:]
        single = addon_host.part("blender.hand_points.single_points")
        single.remove_points(obj, list(range(600, len(obj.data.vertices))))
        return found.tolist()

    first = points(3)
    assert points(3) == first
    assert points(4) != first


def test_pressure_makes_the_radius_or_the_strength_smaller(obj):
    spacing = obj.dapple.report.spacing
    emptied()
    assert spray(TOP[:1], 0.3, use_pressure_size=True, use_pressure_strength=False) == {"FINISHED"}
    new = np.isin(ids(obj), list(locked(obj)))
    assert np.linalg.norm(scenes.positions(obj)[new] - TOP[0], axis=1).max() < 0.31 * 3 * spacing
    there = len(locked(obj))
    spray(TOP[4:5], 0.03)
    light = len(locked(obj)) - there
    spray(TOP[4:5], 0.03, use_pressure_strength=False)
    assert light < 0.5 * (len(locked(obj)) - there)
    assert spray(pressure=0.0, spacing=0.2) == {"CANCELLED"}
    assert spray(strength=0.0, spacing=0.2) == {"CANCELLED"}
    count = len(ids(obj))
    spray([(0, 0, -1)], 0.5, remove=True)
    some = count - len(ids(obj))
    spray([(0, 0, -1)], remove=True)
    assert 0 < some < 0.8 * (count - len(ids(obj)))


def test_points_of_the_active_object_type_are_added(obj):
    for _ in range(2):
        bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[1].use_count, obj.dapple.object_types[1].count = True, 50
    bpy.ops.dapple.optimize()
    obj.dapple.object_type_index = 1
    columns = addon_host.part("blender.scatter.points").point_columns_of
    assert spray(spacing=0.4) == {"FINISHED"}
    kinds = columns(obj)["dapple_object_type"]
    new = np.isin(ids(obj), list(locked(obj)))
    assert (kinds[new] == 1).all()
    assert obj.dapple.object_types[1].count == 50 + new.sum()
    assert spray(spacing=0.2, object_type=0) == {"FINISHED"}
    assert (columns(obj)["dapple_object_type"][len(kinds) :] == 0).all()
    with pytest.raises(RuntimeError, match="has no object type 2: it has 2"):
        spray(object_type=2)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}


@pytest.mark.parametrize("scale", [(2.0, 2.0, 2.0), (1.0, 0.3, 2.0), (-1.0, 1.0, 1.0)])
def test_a_surface_may_be_scaled_turned_and_parented(scale):
    surface, parent = scenes.sphere(), bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    parent.location, parent.rotation_euler = (3.0, 1.0, -2.0), (0.4, 0.2, 1.0)
    surface.parent, surface.scale = parent, scale
    surface.rotation_euler = (1.0, 0.5, 0.2)
    obj = quiet(scenes.scattered(surface, count=500))
    spacing, middle = obj.dapple.report.spacing, scenes.positions(obj)[17]
    off = middle + 0.5 * spacing * scenes.rotations(obj)[17][:, 2]
    count = emptied([off])
    assert 12 < count < 60
    assert np.linalg.norm(scenes.positions(obj) - middle, axis=1).min() > 1.5 * spacing
    assert spray([off]) == {"FINISHED"}
    new = locked(obj)
    assert 0.6 * count < len(new) < 1.2 * count
    assert nearest(obj, new) > 0.79 * spacing
    dapple = pytest.importorskip("dapple3d")
    faces = addon_host.part("blender.surface.mesh").read_mesh(surface).faces
    ground = dapple.Surface(scenes.world_vertices(surface), faces)
    assert np.max(dapple.project(ground, scenes.positions(obj)).distances) < 1e-4


def test_several_objects_are_one_surface():
    first, second = scenes.sphere(), scenes.sphere(location=(1.6, 0.0, 0.0))
    first.select_set(True)
    second.select_set(True)
    assert bpy.ops.dapple.add_scatter(count=500) == {"FINISHED"}
    obj = quiet(bpy.context.object)
    between = [(0.0, 0.0, 1.0), (1.6, 0.0, 1.0), (0.5, 0.0, 0.85), (1.1, 0.0, 0.85)]
    count = emptied(between)
    assert spray(between) == {"FINISHED"}
    assert 0.6 * count < len(locked(obj)) < 1.2 * count
    there = scenes.positions(obj)[np.isin(ids(obj), list(locked(obj)))]
    assert there[:, 0].min() < 0.0
    assert there[:, 0].max() > 1.6


def test_a_nurbs_surface_can_be_sprayed():
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    obj = quiet(scenes.scattered(bpy.context.object, count=300))
    top = [scenes.positions(obj)[scenes.positions(obj)[:, 2].argmax()]]
    count = emptied(top)
    assert spray(top) == {"FINISHED"}
    assert 0.6 * count < len(locked(obj)) < 1.2 * count


def test_points_on_the_other_side_of_a_thin_body_stay():
    bpy.ops.mesh.primitive_cube_add()
    surface = bpy.context.object
    surface.scale = (1.0, 1.0, 0.01)
    obj = quiet(scenes.scattered(surface, count=400))
    below = (scenes.positions(obj)[:, 2] < -0.005).sum()
    emptied([(0.0, 0.0, 0.01)])
    assert (scenes.positions(obj)[:, 2] < -0.005).sum() == below


def test_all_points_can_be_removed_and_sprayed_again(obj):
    assert emptied([(0, 0, 1), (0, 0, -1)], radius=20.0) == 600
    assert len(scenes.positions(obj)) == 0
    assert spray() == {"FINISHED"}
    clear_cut(obj)
    assert len(locked(obj)) == len(ids(obj)) > 10


def test_auto_update_evens_the_others_around_them(live, obj):
    obj.dapple.auto_update_mode = "ON"
    live.settle()
    assert spray(spacing=0.45) == {"FINISHED"}
    new, places = locked(obj), dict(zip(ids(obj), scenes.positions(obj), strict=True))
    assert live.settle() == 1
    assert reason(obj) == ""
    assert locked(obj) == new
    after = dict(zip(ids(obj), scenes.positions(obj), strict=True))
    assert len(after) == len(places) == obj.dapple.report.count
    assert all(np.linalg.norm(after[one] - places[one]) < 1e-5 for one in new)
    assert live.settle() == 0


def test_undo_is_one_step(live, obj):
    obj.dapple.auto_update_mode = "ON"
    name = obj.name
    live.settle()
    before = stored(obj)
    bpy.ops.ed.undo_push(message="Before")
    called = bpy.ops.dapple.spray_points("EXEC_DEFAULT", True, stroke=dabs(TOP), spacing=0.4)
    assert called == {"FINISHED"}
    live.settle()
    count = len(stored(bpy.data.objects[name]))
    bpy.ops.ed.undo()
    live.settle()
    obj = bpy.data.objects[name]
    assert stored(obj) == before
    assert obj.dapple.count == 600
    bpy.ops.ed.redo()
    live.settle()
    assert len(stored(bpy.data.objects[name])) == count


NAN = float("nan")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"stroke": []}, "The stroke is empty: it needs at least one location"),
        (
            {"stroke": dabs([(0, 0, 1), (0, NAN, 1)])},
            r"stroke\[1\].location is not finite: \[0",
        ),
        ({"radius": NAN}, "The radius of the brush must be a positive number: nan"),
        ({"spacing": NAN}, "The gap of the brush must be a positive number: nan"),
        ({"strength": NAN}, "The strength of the brush must be from 0 to 1: nan"),
        ({"object_type": 7}, "'Sphere Scatter' has no object type 7: it has 1"),
    ],
)
def test_bad_input_is_named_and_nothing_changes(obj, options, words):
    before, points = scenes.snapshot(), stored(obj)
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.dapple.spray_points(**{"stroke": dabs(TOP), "spacing": 0.3, **options})
    assert scenes.snapshot() == before
    assert stored(obj) == points


def test_what_cannot_be_sprayed_is_reported_and_nothing_changes(obj):
    points = stored(obj)
    assert spray([(50.0, 0.0, 0.0)], remove=True, radius=0.0) in ({"FINISHED"}, {"CANCELLED"})
    surface = obj.dapple.surface
    obj.dapple.report.spacing = 0.0
    with pytest.raises(RuntimeError, match="has no points yet: optimize it first"):
        spray()
    obj.dapple.report.spacing = 0.14
    surface.modifiers.new("Subdivision", "SUBSURF").render_levels = 1
    for remove in (False, True):
        with pytest.raises(RuntimeError, match="is out of date: attached to"):
            spray(remove=remove, spacing=0.3)
    surface.modifiers.clear()
    obj.dapple.surface = None
    with pytest.raises(RuntimeError, match="has no surface"):
        spray()
    obj.dapple.surface = surface
    assert stored(obj) == points
    bpy.context.scene.frame_end = 2
    bpy.ops.dapple.bake()
    with pytest.raises(RuntimeError, match="clear the bake to edit points"):
        spray()


def test_a_hidden_surface_can_be_sprayed_by_scripts(obj):
    obj.dapple.surface.hide_set(True)
    assert spray(spacing=0.4) == {"FINISHED"}
    clear_cut(obj)


def test_a_linked_duplicate_keeps_its_points(obj):
    copy = obj.copy()
    bpy.context.collection.objects.link(copy)
    mesh = obj.data
    assert spray(spacing=0.4) == {"FINISHED"}
    assert copy.data == mesh != obj.data
    assert len(mesh.vertices) == 600 < len(obj.data.vertices)


def test_a_linked_scatter_is_refused(obj, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (there, here):
        here.objects = list(there.objects)
    linked = bpy.data.objects["Sphere Scatter"]
    bpy.context.collection.objects.link(linked)
    scenes.activate(linked)
    with pytest.raises(RuntimeError, match=r"is linked from 'library\.blend': make it local"):
        spray()
    assert len(linked.data.vertices) == 600


def test_points_along_edges_can_be_sprayed_beside():
    bpy.ops.mesh.primitive_cube_add()
    obj = quiet(scenes.scattered(bpy.context.object, count=100))
    obj.dapple.scatter_on = "EDGES"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert spray([(0.0, 0.0, 1.0)]) == {"FINISHED"}
    assert len(locked(obj)) > 3
    assert (scenes.positions(obj)[100:, 2] > 0.999).all()


class Shown:
    """Dots that note whether they are there."""

    def __init__(self, there):
        self.there = there
        there.append(self)

    def redraw(self):
        assert self in self.there

    def remove(self):
        self.there.remove(self)


class Mouse:
    """A mouse over the surface; the places under its pixels are given by a function."""

    def __init__(self, monkeypatch, **options):
        self.module = addon_host.part("blender.hand_points.spray_operators")
        spraying = addon_host.part("blender.hand_points.spraying")
        self.dots, self.reported, self.noted = [], [], []
        monkeypatch.setattr(self.module, "Dots", lambda *_: Shown(self.dots))
        monkeypatch.setattr(spraying, "contact_at", self.contact)
        kind = self.module.DAPPLE_OT_spray_points
        settings = {
            **{"radius": 3.0, "spacing": 0.4, "strength": 1.0, "object_type": -1, "remove": False},
            **{"use_pressure_size": False, "use_pressure_strength": True},
        }
        self.button = SimpleNamespace(
            bl_label=kind.bl_label,
            report=lambda kinds, text: self.reported.append((*kinds, text)),
            stroke=Noted(),
            **(settings | options),
        )
        for name in pressing.own_methods(kind):
            setattr(self.button, name, partial(getattr(kind, name), self.button))

    def contact(self, _region, _view, at, rays):
        """The place of the unit sphere above a pixel; none beside the sphere."""
        x, y = at[0] / 100.0, at[1] / 100.0
        if x * x + y * y >= 1.0:
            return None
        return rays.first(np.array((x, y, 5.0)), np.array((0.0, 0.0, -1.0)))

    def context(self):
        manager = SimpleNamespace(modal_handler_add=lambda _: None)
        return SimpleNamespace(
            object=bpy.context.object, window_manager=manager, region=None, region_data=object()
        )

    def event(self, kind, value, at, pressure=1.0):
        return SimpleNamespace(
            type=kind, value=value, mouse_region_x=at[0], mouse_region_y=at[1], pressure=pressure
        )

    def press(self, at):
        return self.button.invoke(self.context(), self.event("LEFTMOUSE", "PRESS", at))

    def to(self, at, pressure=1.0):
        return self.button.modal(self.context(), self.event("MOUSEMOVE", "NOTHING", at, pressure))

    def end(self, kind="LEFTMOUSE", value="RELEASE"):
        return self.button.modal(self.context(), self.event(kind, value, (0, 0)))


class Noted(list):
    def add(self):
        self.append(SimpleNamespace())
        return self[-1]


def test_the_mouse_sprays_what_its_stroke_sprays_again(obj, monkeypatch):
    mouse = Mouse(monkeypatch)
    before = stored(obj)
    assert mouse.press((-20, 0)) == {"RUNNING_MODAL"}
    assert len(mouse.dots) == 1
    for at, pressure in (((0, 0), 0.5), ((3, 0), 0.5), ((40, 10), 1.0)):
        assert mouse.to(at, pressure) == {"RUNNING_MODAL"}
    assert stored(obj) == before  # nothing is written yet
    assert mouse.end() == {"FINISHED"}
    assert mouse.dots == []
    clear_cut(obj)
    added = scenes.positions(obj)[600:]
    assert len(added) > 40
    assert mouse.reported == [("INFO", f"Points added and locked: {len(added)}")]
    places = [tuple(one.location) for one in mouse.button.stroke]
    pressures = [one.pressure for one in mouse.button.stroke]
    assert len(places) > 3
    assert min(pressures) == 0.5
    single = addon_host.part("blender.hand_points.single_points")
    single.remove_points(obj, list(range(600, len(obj.data.vertices))))
    stroke = [
        {"name": "", "location": place, "pressure": pressure}
        for place, pressure in zip(places, pressures, strict=True)
    ]
    assert bpy.ops.dapple.spray_points(stroke=stroke, spacing=0.4) == {"FINISHED"}
    np.testing.assert_array_equal(scenes.positions(obj)[600:], added)


def test_the_mouse_removes_with_ctrl(obj, monkeypatch):
    mouse = Mouse(monkeypatch, remove=True)
    there = scenes.positions(obj)
    assert mouse.press((0, 0)) == {"RUNNING_MODAL"}
    mouse.to((30, 0))
    assert mouse.end() == {"FINISHED"}
    gone = 600 - len(scenes.positions(obj))
    assert mouse.reported == [("INFO", f"Points removed: {gone}")]
    assert gone > 20
    assert (there[:, 2] < 0).sum() == (scenes.positions(obj)[:, 2] < 0).sum()


@pytest.mark.parametrize("key", ["ESC", "RIGHTMOUSE"])
def test_a_canceled_stroke_changes_nothing(obj, monkeypatch, key):
    before, file = stored(obj), scenes.snapshot()
    for remove in (False, True):
        mouse = Mouse(monkeypatch, remove=remove)
        mouse.press((0, 0))
        mouse.to((30, 0))
        assert mouse.end(key, "PRESS") == {"CANCELLED"}
        assert mouse.dots == []
        assert not mouse.button.stroke
    assert stored(obj) == before
    assert scenes.snapshot() == file
    assert reason(obj) == ""


def test_a_stroke_may_begin_and_end_beside_the_surface(obj, monkeypatch):
    mouse = Mouse(monkeypatch)
    assert mouse.press((-150, 0)) == {"RUNNING_MODAL"}
    assert mouse.end() == {"CANCELLED"}
    assert mouse.reported == [("WARNING", "The surface is not under the mouse")]
    mouse.press((-150, 0))
    mouse.to((0, 0))
    mouse.to((150, 0))
    assert mouse.end() == {"FINISHED"}
    assert len(scenes.positions(obj)) > 600


def test_the_mouse_says_what_cannot_be_sprayed(obj, monkeypatch):
    before = stored(obj)
    mouse = Mouse(monkeypatch, spacing=2.0)
    mouse.press((0, 0))
    assert mouse.end() == {"CANCELLED"}
    said = "No room for more points: reduce Spacing, or remove some"
    assert mouse.reported == [("WARNING", said)]
    obj.dapple.surface = None
    assert mouse.press((0, 0)) == {"CANCELLED"}
    assert mouse.reported[-1][0] == "ERROR"
    assert "has no surface" in mouse.reported[-1][1]
    assert mouse.dots == []
    assert stored(obj) == before


def test_an_error_during_a_stroke_ends_it(obj, monkeypatch):
    mouse = Mouse(monkeypatch)
    mouse.press((0, 0))
    monkeypatch.setattr(mouse, "contact", None)
    spraying = addon_host.part("blender.hand_points.spraying")
    monkeypatch.setattr(spraying, "contact_at", lambda *_: 1 / 0)
    assert mouse.to((30, 0)) == {"CANCELLED"}
    assert mouse.dots == []
    assert mouse.reported[0][0] == "ERROR"


def test_the_dots_of_a_stroke_are_round():
    drawing = addon_host.part("blender.hand_points.spray_drawing")
    corners = drawing.discs(np.array([[10.0, 20.0], [50.0, 60.0]]), 4.0).reshape(2, -1, 2)
    np.testing.assert_allclose(corners[1] - corners[0], np.broadcast_to(40.0, corners[0].shape))
    away = np.linalg.norm(corners[0] - (10.0, 20.0), axis=1)
    assert set(away.round(3)) == {0.0, 4.0}
