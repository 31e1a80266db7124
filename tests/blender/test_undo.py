# SPDX-License-Identifier: GPL-3.0-or-later
"""Undo and redo of every operator: file, settings and playback as before, and as after."""

import addon_host
import bpy
import pytest
import scenes

pytestmark = pytest.mark.empty_file  # the node groups are built here


def values(group):
    """Properties of a group and of the groups inside, by their paths."""
    found = {}
    for prop in group.bl_rna.properties:
        if prop.identifier == "rna_type":
            continue
        value = getattr(group, prop.identifier)
        if prop.type == "POINTER" and isinstance(value, bpy.types.PropertyGroup):
            found |= {f"{prop.identifier}.{name}": one for name, one in values(value).items()}
        elif prop.type == "POINTER":
            found[prop.identifier] = getattr(value, "name", None)
        elif prop.type == "COLLECTION":
            found[prop.identifier] = [values(item) for item in value]
        else:
            found[prop.identifier] = value
    return found


def state():
    """Everything that an undo must bring back, without references that it leaves dangling."""
    found = scenes.snapshot()
    found["active"] = found["active"] and found["active"].name
    found["selected"] = sorted(obj.name for obj in found["selected"])
    for obj in [one for one in bpy.data.objects if one.dapple.surface]:
        found[obj.name] = values(obj.dapple)
        found[f"{obj.name} in nodes"] = obj.modifiers[0].node_group.name
        found[f"{obj.name} plays"] = [played(obj, frame) for frame in (1, 2, 3)]
        tiles = obj.dapple.tiles.object
        found["tiles"] = tiles and [tuple(vertex.co) for vertex in tiles.data.vertices]
    return found


def played(obj, frame):
    bpy.context.scene.frame_set(frame)
    matrices = scenes.instance_matrices(obj)
    bpy.context.scene.frame_set(1)
    return matrices.tolist()


def scatter():
    return scenes.scattered(scenes.tail(frames=3), 30)


def baked_scatter():
    obj = scatter()
    bpy.context.scene.frame_end = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


def baked_otherwise():
    obj = baked_scatter()
    obj.dapple.keyframe_step, obj.dapple.stickiness = 2, 5.0


def born_scatter():
    obj = scatter()
    obj.dapple.population, obj.dapple.fade_duration = "KEEP_DENSITY", 1
    obj.dapple.surface.scale = (1.0, 1.0, 1.0)
    obj.dapple.surface.keyframe_insert("scale", frame=1)
    obj.dapple.surface.scale = (1.5, 1.5, 1.5)
    obj.dapple.surface.keyframe_insert("scale", frame=3)
    bpy.context.scene.frame_set(1)
    return obj


def born_baked():
    obj = born_scatter()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(obj.data.vertices) > 30
    return obj


def tiled():
    obj = scatter()
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    obj.dapple.tiles.grout = 0.3
    return obj


def several():
    obj = scatter()
    for _ in range(2):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    obj.dapple.object_types[1].weight = 3.0
    return obj


def linked_copy():
    obj = baked_scatter()
    assert bpy.ops.object.duplicate(linked=True) == {"FINISHED"}
    assert bpy.context.object.data == obj.data
    bpy.context.object.dapple.seed = 3


def resized():
    scatter().dapple.count = 40


def changed_after_saving():
    obj = scatter()
    obj.dapple.repulsion_weight = 2.0
    assert bpy.ops.dapple.save_preset(name="Undone") == {"FINISHED"}
    obj.dapple.repulsion_weight = 1.0


def unequal():
    scenes.tail(frames=3, levels=1, render_levels=2)


def overlapping():
    obj = scatter()
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    obj.dapple.object_types[0].radius = 0.34
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.report.worst_overlap > 0


CASES = [
    ("add_scatter", lambda: scenes.tail(frames=3), {"count": 30}),
    ("add_scatter", lambda: scenes.tail(frames=3), {"count": 30, "attach_to": "REST"}),
    ("optimize", resized, {}),
    ("optimize", baked_scatter, {}),
    ("optimize", several, {}),
    ("optimize", linked_copy, {}),
    ("bake", scatter, {}),
    ("bake", baked_otherwise, {}),
    ("bake", born_scatter, {}),
    ("clear_bake", baked_scatter, {}),
    ("clear_bake", born_baked, {}),
    ("reattach", baked_scatter, {}),
    ("make_tiles", scatter, {}),
    ("make_tiles", tiled, {}),
    ("remesh", lambda: scenes.tail(frames=3), {"count": 200}),
    ("edit_object_types", scatter, {"action": "ADD"}),
    ("edit_object_types", several, {"action": "REMOVE"}),
    ("edit_object_types", several, {"action": "UP"}),
    ("lock_points", scatter, {"every": True}),
    ("load_preset", changed_after_saving, {"name": "Undone"}),
    ("copy_scatter", baked_scatter, {}),
    ("remove_scatter", baked_scatter, {}),
    ("match_subdivision", unequal, {}),
]


@pytest.mark.parametrize(("name", "prepare", "options"), CASES)
def test_undo_is_as_before_and_redo_as_after(name, prepare, options):
    prepare()
    bpy.context.scene.frame_set(1)
    bpy.ops.ed.undo_push(message="Before")
    before = state()
    assert getattr(bpy.ops.dapple, name)("EXEC_DEFAULT", True, **options) == {"FINISHED"}
    after = state()
    assert after != before
    for _ in range(2):
        bpy.ops.ed.undo()
        assert state() == before
        bpy.ops.ed.redo()
        assert state() == after
    bpy.ops.ed.undo()
    assert getattr(bpy.ops.dapple, name)("EXEC_DEFAULT", True, **options) == {"FINISHED"}
    again = state()
    for one in (after, again):  # the time and the key of a new object may differ
        for values_of_one in one.values():
            if isinstance(values_of_one, dict):
                for shown in ("report", "solved"):
                    values_of_one.pop(f"{shown}.milliseconds", None)
                values_of_one.pop("bake_key", None)
    assert again == after
    if name == "load_preset":
        assert bpy.ops.dapple.remove_preset(**options) == {"FINISHED"}


def selected_points():
    return [vertex.index for vertex in bpy.data.meshes["Tail Scatter"].vertices if vertex.select]


def test_steps_are_called_what_the_artist_has_done(live, artist, monkeypatch):
    """Blender lists them in Edit > Undo History."""
    names = []
    monkeypatch.setattr(addon_host.part("blender.base.jobs"), "push_undo", names.append)
    surface = scenes.sphere()
    artist.press("add_scatter", count=30)
    artist.finish()
    obj = bpy.data.objects["Sphere Scatter"]
    live.watcher.request(obj)
    live.settle()
    asset = addon_host.part("blender.assets.marking").marked(obj)
    bpy.context.scene.collection.objects.link(asset)
    bpy.context.view_layer.update()
    asset.dapple.surface = surface
    assert addon_host.part("blender.assets.dropped").check() is None
    live.settle()
    assert names == ["Add Scatter", "Optimize", "Place Scatter"]
    labels = [kind.bl_label for kind in addon_host.part("blender").CLASSES if has_step(kind)]
    assert len(labels) > 20
    plain = {"Optimize", "Bake", "Reattach"}
    assert [one for one in labels if len(one.split()) < 2 and one not in plain] == []


def has_step(kind):
    return issubclass(kind, bpy.types.Operator) and "UNDO" in getattr(kind, "bl_options", ())


def test_undo_of_selecting_an_overlap():
    overlapping()
    bpy.ops.ed.undo_push(message="Before")
    before = selected_points()
    assert bpy.ops.dapple.select_overlap("EXEC_DEFAULT", True) == {"FINISHED"}
    after = selected_points()
    assert len(after) == 2
    assert after != before
    bpy.ops.ed.undo()  # Blender's undo does not include the 3D cursor
    assert selected_points() == before
    bpy.ops.ed.redo()
    assert selected_points() == after


def test_undo_of_a_failed_operator_is_of_the_step_before():
    obj = scatter()
    obj.name = "Renamed"
    bpy.ops.ed.undo_push(message="Rename")
    obj.dapple.surface = None
    with pytest.raises(RuntimeError, match="no surface"):
        bpy.ops.dapple.optimize("EXEC_DEFAULT", True)
    bpy.ops.ed.undo_push(message="No surface")
    bpy.ops.ed.undo()
    assert bpy.data.objects["Renamed"].dapple.surface.name == "Tail"
