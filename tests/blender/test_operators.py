# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators by name, undo and redo, refusals that leave the scene as it was."""

from types import SimpleNamespace

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def points(obj):
    local = np.empty(3 * len(obj.data.vertices), dtype=np.float32)
    obj.data.vertices.foreach_get("co", local)
    return local.reshape(-1, 3)


def test_add_makes_exactly_the_points_asked_for():
    surface = scenes.sphere()
    obj = scenes.scattered(surface, count=77)
    assert obj.dapple.surface == surface
    assert obj.dapple.count == 77
    assert obj.select_get()
    assert not surface.select_get()
    found = scenes.positions(obj)
    assert len(found) == 77
    assert np.allclose(np.linalg.norm(found, axis=1), 1.0, atol=0.02)
    assert np.allclose(found, points(obj), atol=1e-5)


def test_add_stores_every_record():
    records, meshio = (
        addon_host.part("core.surface.records"),
        addon_host.part("blender.base.mesh_arrays"),
    )
    obj = scenes.scattered(scenes.sphere(), count=40)
    columns = meshio.read_columns(obj.data, {**records.ROW_ATTRIBUTES, **records.POINT_ATTRIBUTES})
    assert sorted(columns["id"].tolist()) == list(range(40))
    assert (columns["dapple_object_type"] == 0).all()
    assert np.allclose(columns["dapple_barycentric"].sum(axis=1), 1.0, atol=1e-6)
    assert obj.data[records.SCHEMA_KEY] == records.SCHEMA


def test_the_report_is_filled():
    report = scenes.scattered(scenes.sphere(), count=200).dapple.report
    assert report.count == 200
    assert 0.6 < report.alpha_mean <= 1.0
    assert report.alpha_min <= report.alpha_mean
    assert report.capacity_variation < 0.05
    assert report.evaluations > 1


def test_spacing_is_measured_in_world_space():
    surface = scenes.sphere(scale=(1.0, 1.0, 6.0))
    found = scenes.positions(scenes.scattered(surface, count=300))
    distance = np.linalg.norm(found[:, None] - found[None], axis=2) + 9.0 * np.eye(300)
    nearest = distance.min(axis=1)
    middle = np.abs(found[:, 2]) < 2.0
    assert nearest.std() / nearest.mean() < 0.2
    assert abs(nearest[middle].mean() / nearest[~middle].mean() - 1.0) < 0.1


def test_a_mirrored_surface_faces_outwards():
    surface = scenes.sphere(scale=(-1.0, 1.0, 1.0))
    obj = scenes.scattered(surface)
    outward = np.einsum("nd,nd->n", scenes.positions(obj), scenes.rotations(obj)[:, :, 2])
    assert outward.min() > 0.9


def test_the_same_seed_gives_the_same_points_and_another_seed_others():
    surface = scenes.sphere()
    first = points(scenes.scattered(surface))
    again = points(scenes.scattered(surface))
    assert (first == again).all()
    obj = bpy.context.object
    obj.dapple.seed = 1
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert not np.allclose(points(obj), first, atol=1e-3)


def test_optimize_follows_the_settings_and_the_frame():
    surface = scenes.tail()
    obj = scenes.scattered(surface)
    bpy.context.scene.frame_set(6)
    obj.dapple.count = 90
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 90
    dapple = pytest.importorskip("dapple3d")
    vertices = scenes.world_vertices(surface)
    reading = addon_host.part("blender.surface.mesh")
    faces = reading.read_mesh(surface).faces
    distances = dapple.project(dapple.Surface(vertices, faces), scenes.positions(obj)).distances
    assert np.max(distances) < 1e-5 * scenes.size(vertices)


def test_undo_and_redo():
    scenes.sphere()
    bpy.ops.ed.undo_push(message="Before")
    assert bpy.ops.dapple.add_scatter("EXEC_DEFAULT", True, count=50) == {"FINISHED"}
    name = bpy.context.object.name
    expected = points(bpy.data.objects[name])
    bpy.data.objects[name].dapple.count = 20
    assert bpy.ops.dapple.optimize("EXEC_DEFAULT", True) == {"FINISHED"}
    bpy.ops.ed.undo()
    assert (points(bpy.data.objects[name]) == expected).all()
    assert np.allclose(scenes.positions(bpy.data.objects[name]), expected, atol=1e-5)
    bpy.ops.ed.undo()
    assert name not in bpy.data.objects
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert len(scenes.positions(bpy.data.objects[name])) == 20


def refused(call, words):
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match=words):
        call()
    assert scenes.snapshot() == before


def test_unequal_levels_are_refused():
    surface = scenes.tail(levels=1, render_levels=2)
    words = "410 vertices in the viewport and 1634 in the render"
    refused(lambda: bpy.ops.dapple.add_scatter(attach_to="FACES"), words)
    assert bpy.ops.dapple.match_subdivision() == {"FINISHED"}
    obj = scenes.scattered(surface)
    obj.dapple.attach_to = "FACES"
    surface.modifiers["Subdivision"].render_levels = 1
    refused(bpy.ops.dapple.optimize, "Match Subdivision")
    refused(bpy.ops.dapple.bake, "Match Subdivision")
    assert len(scenes.positions(obj)) == 60


def test_a_vertex_that_is_not_finite_is_named():
    surface = scenes.sphere()
    surface.data.vertices[17].co.x = float("nan")
    refused(bpy.ops.dapple.add_scatter, r"'Sphere'.*vertices\[17\] is not finite")


def test_a_mesh_without_faces_is_refused():
    mesh = bpy.data.meshes.new("Empty")
    obj = bpy.data.objects.new("Empty", mesh)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    refused(bpy.ops.dapple.add_scatter, "'Empty'")


def test_a_scatter_without_surface_is_refused():
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.surface = None
    refused(bpy.ops.dapple.optimize, f"'{obj.name}' has no surface")


def test_a_surface_out_of_the_view_layer_is_evaluated_all_the_same():
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    for collection in surface.users_collection:
        collection.objects.unlink(surface)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(scenes.positions(obj)) == 60


def test_an_object_that_is_not_evaluated_cannot_be_read():
    errors = addon_host.part("core.base.errors")
    reading = addon_host.part("blender.surface.mesh")
    loose = bpy.data.objects.new("Loose", bpy.data.meshes.new("Loose"))
    with pytest.raises(errors.ScatterError, match="'Loose' is not evaluated"):
        reading.read_mesh(loose)


def test_operators_need_object_mode_and_the_right_object():
    assert not bpy.ops.dapple.add_scatter.poll()
    surface = scenes.sphere()
    assert bpy.ops.dapple.add_scatter.poll()
    assert not bpy.ops.dapple.optimize.poll()
    scenes.scattered(surface)
    assert not bpy.ops.dapple.add_scatter.poll()
    assert bpy.ops.dapple.optimize.poll()
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.dapple.optimize.poll()


def test_a_mesh_that_changed_meanwhile_is_not_written_to():
    adding, steps = addon_host.part("blender.add.steps"), addon_host.part("core.base.steps")
    errors = addon_host.part("core.base.errors")
    surface = scenes.sphere()
    running = adding.add_steps(bpy.context, count=30)
    task = next(running)
    solved = task.call(addon_host.part("core.base.native").package().Context())
    surface.data.vertices[0].co.z += 0.1
    before = scenes.snapshot()
    with pytest.raises(errors.ScatterError, match="'Sphere' changed while"):
        running.send(solved)
    assert scenes.snapshot() == before
    assert isinstance(task, steps.Task)


class Window:
    """Replaces a Blender with windows: records dialogs instead of showing them."""

    def __init__(self, monkeypatch, answer=True):
        self.asked, self.started, self.answer = [], [], answer
        self.operators = addon_host.part("blender.solve.operators")
        self.of_bakes = addon_host.part("blender.bake.operators")
        self.of_presets = addon_host.part("blender.presets.operators")
        bpy_there = SimpleNamespace(
            app=SimpleNamespace(background=False),
            ops=SimpleNamespace(
                dapple=SimpleNamespace(
                    delete_keyframes=self._ask, optimize=self._start, reattach=self._start
                )
            ),
        )
        for module in (self.operators, self.of_bakes):
            monkeypatch.setattr(module, "bpy", bpy_there)
        started = lambda operator, *_: self._start("MODAL", True)  # noqa: E731
        monkeypatch.setattr(self.operators.StepsOperator, "invoke", started)
        asked = SimpleNamespace(request=lambda _: self._start("BACKGROUND", True))
        monkeypatch.setattr(self.operators, "auto_update", asked)

    def press(self, kind, **properties):
        operator = SimpleNamespace(**properties)
        for name in dir(kind):
            if isinstance(getattr(kind, name), str) and not name.startswith("__"):
                setattr(operator, name, getattr(kind, name))
        operator.execute = lambda context: kind.work(operator, context)
        manager = SimpleNamespace(invoke_confirm=self._confirm)
        context = SimpleNamespace(object=bpy.context.object, window_manager=manager)
        return kind.invoke(operator, context, None)

    def _ask(self, how, action):
        assert how == "INVOKE_DEFAULT"
        self.press(self.operators.DAPPLE_OT_delete_keyframes, action=action)

    def _confirm(self, operator, event, title, message, **_):
        self.asked.append((title, message))
        there = SimpleNamespace(object=bpy.context.object)
        return operator.execute(there) if self.answer else {"CANCELLED"}

    def _start(self, how, delete_keyframes):
        self.started.append((how, delete_keyframes))
        return {"RUNNING_MODAL"}


def baked():
    obj = scenes.scattered(scenes.tail())
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


@pytest.mark.parametrize("name", ["optimize", "reattach"])
@pytest.mark.parametrize("answer", [True, False])
def test_a_button_that_drops_baked_keys_asks(monkeypatch, name, answer):
    baked()
    window = Window(monkeypatch, answer)
    kind = getattr(window.operators, f"DAPPLE_OT_{name}")
    assert window.press(kind, delete_keyframes=False) == {"CANCELLED"}
    assert window.asked == [("Delete the bake?", "The keyframes of frames 1 to 6 will be deleted")]
    assert window.started == ([("INVOKE_DEFAULT", True)] if answer else [])


@pytest.mark.parametrize(("name", "how"), [("optimize", "BACKGROUND"), ("reattach", "MODAL")])
def test_nothing_is_asked_without_keys_or_once_it_is_answered(monkeypatch, name, how):
    obj = baked()
    window = Window(monkeypatch)
    kind = getattr(window.operators, f"DAPPLE_OT_{name}")
    window.press(kind, delete_keyframes=True)
    obj.dapple.baked_keys = 0
    window.press(kind, delete_keyframes=False)
    assert window.asked == []
    assert window.started == [(how, True), (how, True)]


@pytest.mark.parametrize("answer", [True, False])
def test_discarding_frames_asks_as_it_cannot_be_undone(monkeypatch, answer):
    obj = baked()
    obj.dapple.bake_fingerprint = ""  # like a bake that was stopped
    files = addon_host.part("blender.freshness.unfinished_bakes").work_files(obj)
    window = Window(monkeypatch, answer)
    window.press(window.of_bakes.DAPPLE_OT_discard_unfinished_bake)
    said = "6 solved frames will be deleted from disk"
    assert window.asked == [("Discard the unfinished bake?", said)]
    assert files.frames() == (0 if answer else 6)
    files.clear()


@pytest.mark.parametrize("answer", [True, False])
def test_removing_a_preset_asks_and_names_it(monkeypatch, answer):
    scenes.scattered(scenes.sphere())
    bpy.ops.dapple.save_preset(name="Pebbles")
    window = Window(monkeypatch, answer)
    window.press(window.of_presets.DAPPLE_OT_remove_preset, name="Pebbles")
    said = "The file of 'Pebbles' will be deleted from disk"
    assert window.asked == [("Delete the preset?", said)]
    folder = addon_host.part("blender.presets.stored").folder()
    left = addon_host.part("core.settings.presets").names(folder)
    assert list(left) == ([] if answer else ["Pebbles"])
