# SPDX-License-Identifier: GPL-3.0-or-later
"""An operator that fails leaves the file as it was, and says why in one sentence."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
import whole_file


def scattered():
    return scenes.scattered(scenes.sphere(), 40)


def two_types():
    obj = scattered()
    for _ in range(2):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def touching():
    """Types so large that they overlap."""
    obj = two_types()
    obj.dapple.object_types[0].radius = 0.4
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.report.worst_overlap > 0
    return obj


def with_bolt():
    """On two objects, one of which is too small for a point."""
    bolt = scenes.sphere(scale=(0.05, 0.05, 0.05), location=(2.0, 0.0, 0.0))
    ball = scenes.sphere()
    bolt.select_set(True)
    bpy.context.view_layer.objects.active = ball
    assert bpy.ops.dapple.add_scatter(count=60) == {"FINISHED"}
    assert bpy.context.object.dapple.report.small_parts == 1
    return bpy.context.object


def baked():
    obj = scattered()
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.context.scene.frame_set(2)
    return obj


def born():
    """A bake that has added points."""
    surface = scenes.sphere()
    for frame, size in ((1, 1.0), (3, 1.5)):
        surface.scale = (size, size, size)
        surface.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 3
    bpy.context.scene.frame_set(1)
    obj = scenes.scattered(surface, 40)
    obj.dapple.population = "KEEP_DENSITY"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(obj.data.vertices) > 40
    return obj


def at_rest():
    obj = scattered()
    obj.dapple.surface.modifiers.new("Subdivision", "SUBSURF")
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert obj.dapple.attached_to == "REST"
    return obj


def to_be_at_rest():
    """Optimize will put the points on the rest position."""
    obj = scattered()
    obj.dapple.surface.modifiers.new("Subdivision", "SUBSURF")
    return obj


def tiled():
    obj = scattered()
    assert bpy.ops.dapple.make_tiles() == {"FINISHED"}
    scenes.activate(obj)
    obj.dapple.count = 30
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def two_objects():
    surface = scenes.sphere()
    other = scenes.sphere(location=(3.0, 0.0, 0.0))
    surface.select_set(True)
    other.select_set(True)
    return surface


def of_collection():
    two_objects()
    bpy.context.scene.collection.children.link(bpy.data.collections.new("Parts"))
    for obj in bpy.context.selected_objects:
        bpy.data.collections["Parts"].objects.link(obj)


def joined():
    """A scatter over two objects, of which there are more by now."""
    of_collection()
    assert bpy.ops.dapple.add_over_collection(collection="Parts", count=40) == {"FINISHED"}
    obj = bpy.context.object
    more = scenes.sphere(location=(6.0, 0.0, 0.0))
    bpy.data.collections["Parts"].objects.link(more)
    scenes.activate(obj)
    return obj


def with_others():
    obj = scattered()
    for x in (3.0, 6.0):
        scenes.sphere(location=(x, 0.0, 0.0)).select_set(True)
    bpy.data.objects["Sphere.001"].select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


def asset():
    obj = scattered()
    assert bpy.ops.dapple.mark_asset() == {"FINISHED"}
    made = bpy.data.objects[f"{obj.name} Asset"]
    bpy.context.scene.collection.objects.link(made)
    scenes.activate(made)
    return made


def edited():
    obj = scattered()
    assert bpy.ops.dapple.edit_points() == {"FINISHED"}
    assert bpy.ops.dapple.place_point(location=(0.0, 0.0, 1.0)) == {"FINISHED"}
    return obj


def painted():
    obj = scattered()
    assert bpy.ops.dapple.paint_density() == {"FINISHED"}
    return obj


def with_group():
    obj = scattered()
    obj.dapple.surface.vertex_groups.new(name="Other")
    return obj


def with_material():
    obj = scattered()
    material = bpy.data.materials.new("Grass")
    obj.dapple.surface.data.materials.append(material)
    return obj


def of_material():
    obj = with_material()
    assert bpy.ops.dapple.add_material(material="Grass") == {"FINISHED"}
    return obj


def two_scatters():
    obj = scattered()
    scenes.scattered(obj.dapple.surface, 20)
    return bpy.context.object


def saved():
    obj = scattered()
    assert bpy.ops.dapple.save_preset(name="Failing") == {"FINISHED"}
    obj.dapple.count, obj.dapple.seed = 50, 3
    return obj


def subdivided():
    surface = scenes.sphere()
    surface.modifiers.new("Subdivision", "SUBSURF")
    return surface


HAND, FACES = "blender.hand_points", "blender.surface.subdivision"
EXPORT, SOLVE = "blender.export.operators", "blender.solve"
TYPES = "blender.object_types.operators"
DENSITY = "blender.density.operators"
FIRST = {"name": "Sphere Scatter"}
SPRAY = {
    "stroke": [{"name": "", "location": (0.0, 0.0, 1.0), "pressure": 1.0}],
    "spacing": 0.3,
}
TO_KEYS = {"count": 150, "animation": "SHAPE_KEYS", "frame_start": 1, "frame_end": 3}


# Operator, its properties, preparation, and the last step as a module and a name in it.
def text():
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.1


CASES = [
    ("add_scatter", {"count": 40}, scenes.sphere, "blender.add.steps.write_solved"),
    ("add_scatter", {"count": 40}, two_objects, "blender.add.steps.write_solved"),
    ("add_scatter", {"count": 40}, subdivided, "blender.add.steps.write_solved"),
    ("add_scatter", {"count": 40}, scenes.sphere, "blender.scatter.store.write_warning"),
    ("add_over_collection", {"collection": "Parts"}, of_collection, "blender.add.steps.apply"),
    ("surface_from_selected", {}, with_others, "blender.add.operators.put_on_selected"),
    ("mark_asset", {}, scattered, "blender.assets.operators.marked"),
    ("mark_asset", {}, baked, "blender.assets.marking.collect_instances"),
    ("place_scatter", {"surface": "Sphere"}, asset, "blender.solve.optimize.write_solved"),
    ("place_scatter", {"surface": "Sphere"}, asset, "blender.assets.placing.fit_classes"),
    ("bake", {}, scattered, "blender.bake.steps.write_known"),
    ("bake", {}, baked, "blender.bake.steps.write_known"),
    ("bake", {}, born, "blender.bake.steps.write_baked"),
    ("bake", {}, joined, "blender.bake.steps.write_known"),
    ("clear_bake", {}, baked, "blender.bake.operators.clear_keys"),
    ("clear_bake", {}, born, "blender.bake.operators.clear_keys"),
    ("discard_unfinished_bake", {}, baked, "blender.freshness.findings.touch"),
    ("export_points", {"filepath": "points.csv"}, scattered, f"{EXPORT}.export_points"),
    ("delete_keyframes", {"action": "OPTIMIZE"}, baked, "blender.solve.optimize.write_solved"),
    ("delete_keyframes", {"action": "REATTACH"}, baked, f"{SOLVE}.session_solutions.write_own_ids"),
    ("optimize", {}, scattered, "blender.display.preview.restart"),
    ("optimize", {}, baked, "blender.solve.optimize.write_solved"),
    ("optimize", {}, born, "blender.solve.optimize.write_solved"),
    ("optimize", {}, joined, "blender.display.preview.restart"),
    ("optimize", {}, to_be_at_rest, "blender.display.preview.restart"),
    ("reattach", {}, scattered, "blender.display.preview.restart"),
    ("reattach", {}, baked, f"{SOLVE}.session_solutions.write_own_ids"),
    ("reattach", {}, born, f"{SOLVE}.session_solutions.write_own_ids"),
    ("reattach", {}, at_rest, "blender.display.preview.restart"),
    ("make_tiles", {}, scattered, "blender.tiles.operators.write_tiles"),
    ("make_tiles", {}, tiled, "blender.tiles.operators.write_tiles"),
    ("add_hair_guides", {}, scattered, "blender.hair.guides.write_curves"),
    ("remesh", {"count": 60}, scenes.sphere, "blender.remesh.operators.write_new"),
    ("remesh", {"count": 60}, text, "blender.remesh.operators.show_mesh"),
    ("remesh", TO_KEYS, scenes.tail, "blender.remesh.motion._write_motion"),
    ("edit_points", {}, scattered, f"{HAND}.operators.begin_editing"),
    ("finish_editing_points", {}, edited, f"{HAND}.operators.end_editing"),
    ("place_point", {}, edited, f"{HAND}.operators.add_vertex"),
    ("add_point", {"location": (0, 0, 1)}, scattered, f"{HAND}.operators.add_point"),
    ("add_point", {"location": (0, 0, 1)}, at_rest, f"{HAND}.operators.add_point"),
    ("add_point", {"location": (0, 0, 1)}, two_types, f"{HAND}.hand_placed.follow_count"),
    ("move_point", {"id": 3}, scattered, f"{HAND}.operators.move_point"),
    ("remove_point", {"id": 3}, scattered, f"{HAND}.operators.remove_point"),
    ("spray_points", SPRAY, scattered, f"{HAND}.spraying.add_points"),
    ("spray_points", SPRAY, two_types, f"{HAND}.hand_placed.follow_count"),
    ("spray_points", SPRAY | {"remove": True}, at_rest, f"{HAND}.spraying.remove_points"),
    ("paint_density", {}, scattered, f"{DENSITY}.begin_painting"),
    ("paint_density", {}, with_group, f"{DENSITY}.begin_painting"),
    ("paint_blocked_areas", {}, scattered, f"{DENSITY}.begin_painting"),
    ("finish_painting", {}, painted, f"{DENSITY}.end_painting"),
    ("live_preview", {}, scattered, "blender.display.preview.start"),
    ("match_subdivision", {}, subdivided, f"{FACES}.match_subdivision"),
    ("show_density", {}, scattered, "blender.density.overlay.start"),
    *(
        ("edit_object_types", {"action": action}, made, f"{TYPES}.edit_object_types")
        for action in ("ADD", "REMOVE", "UP", "DOWN")
        for made in (scattered, two_types)
    ),
    (
        "add_material",
        {"material": "Grass"},
        with_material,
        f"{DENSITY}.by_full_name",
    ),
    ("remove_material", {"index": 0}, of_material, f"{DENSITY}.settings_changed"),
    ("lock_points", {"every": True}, scattered, f"{HAND}.operators.lock_points"),
    ("select_overlap", {}, touching, "blender.object_types.operators.select_overlap"),
    ("select_overlapping", {}, touching, "blender.object_types.operators.select_points"),
    ("select_small_parts", {}, with_bolt, "blender.solve.operators.select"),
    ("select_scatter", FIRST, two_scatters, "blender.add.scatter_list.activate"),
    ("select_surface", {}, two_scatters, "blender.add.scatter_list.activate"),
    ("solo_scatter", {}, two_scatters, "blender.add.scatter_list.show_solo"),
    ("copy_scatter", {}, baked, "blender.add.scatter_list.copied"),
    ("remove_scatter", {}, baked, "blender.add.scatter_list.remove"),
    ("remove_scatter", {}, born, "blender.add.scatter_list.remove"),
    ("save_preset", {"name": "Other"}, scattered, "core.settings.presets.store"),
    ("load_preset", {"name": "Failing"}, saved, "blender.presets.operators.apply"),
    ("remove_preset", {"name": "Failing"}, saved, "core.settings.presets.remove"),
]  # fmt: skip
APART = {
    "pull_point": "needs a mouse; test_single_points.py",
    "resize_spray_brush": "needs a window; window_spray.py",
    "cancel_update": "writes nothing",
    "hide_message": "writes nothing",
    "add_asset_library": "the preferences; test_assets.py",
    "remove_asset_library": "the preferences; test_assets.py",
}


def test_every_operator_is_tried():
    known = {name for name, *_ in CASES} | APART.keys()
    there = {name for name in dir(bpy.ops.dapple) if not name.startswith("_")}
    assert there == known


def failing(monkeypatch, path, error):
    """Let a step fail after its work."""
    module, name = path.rsplit(".", 1)
    module = addon_host.part(module)
    done = getattr(module, name)

    def step(*arguments, **named):
        result = done(*arguments, **named)
        steps.append(result)
        raise error

    steps = []
    monkeypatch.setattr(module, name, step)
    return steps


def wrong():
    return addon_host.part("core.base.errors").ScatterError("The last step failed")


ERRORS = {
    "foreseen": (wrong, "Error: The last step failed\n"),
    "surprising": (
        lambda: RuntimeError("The last step failed"),
        "failed, nothing was changed: The last step failed\n",
    ),
}


@pytest.mark.empty_file
@pytest.mark.sampled(2)
@pytest.mark.parametrize("foreseen", ERRORS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{case[2].__name__}")
def test_the_last_step_fails(case, foreseen, monkeypatch, tmp_path, capfd):
    name, properties, made, path = case
    made()
    if "filepath" in properties:
        properties = {"filepath": str(tmp_path / properties["filepath"])}
    make, words = ERRORS[foreseen]
    steps = failing(monkeypatch, path, make())
    before = whole_file.everything()
    undone = None
    try:
        with pytest.raises(RuntimeError) as raised:
            getattr(bpy.ops.dapple, name)(**properties)
        undone = whole_file.differences(before)
    finally:
        monkeypatch.undo()
        addon_host.part("blender.density.overlay").stop()
    assert len(steps) == 1
    assert str(raised.value).endswith(words)
    assert "Traceback" not in str(raised.value)
    assert undone == {}
    if name not in {"finish_editing_points", "place_point", "finish_painting"}:
        works_then(name, properties)


def works_then(name, properties):
    """An operator that failed works once the cause is removed."""
    if name in {"discard_unfinished_bake", "remove_preset", "export_points"}:
        return
    assert getattr(bpy.ops.dapple, name)(**properties) == {"FINISHED"}
    if name == "live_preview":
        bpy.ops.dapple.live_preview()
    addon_host.part("blender.density.overlay").stop()


def flat(obj):
    obj.scale.x = 0.0


def nothing(obj):
    obj.scale = (0.0, 0.0, 0.0)


def tiny(obj):
    obj.scale = (1e-30, 1.0, 1.0)


def of_parent(change):
    def parented(obj):
        parent = bpy.data.objects.new("Parent", None)
        bpy.context.scene.collection.objects.link(parent)
        obj.parent = parent
        change(parent)

    parented.__name__ = f"{change.__name__}_parent"
    return parented


def sheared(obj):
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale = (3.0, 1.0, 0.2)
    obj.parent, obj.rotation_euler = parent, (0.5, 0.7, 0.9)


def nowhere(obj):
    obj.location.x = float("nan")


def of_surface(change):
    def changed(obj):
        change(obj.dapple.surface)

    changed.__name__ = f"surface_{change.__name__}"
    return changed


def broken_vertex(obj):
    obj.dapple.surface.data.vertices[3].co.x = float("nan")
    obj.dapple.surface.data.update()


CHANGES = [flat, nothing, tiny, nowhere, sheared]
SPOILT = [
    *CHANGES,
    *map(of_parent, (flat, nothing)),
    *map(of_surface, (*CHANGES, of_parent(flat), of_parent(nothing))),
    broken_vertex,
]
TRIED = [
    *(("optimize", {}), ("reattach", {}), ("bake", {}), ("make_tiles", {}), ("clear_bake", {})),
    *(("add_point", {"location": (0.0, 0.0, 1.0)}), ("move_point", {"id": 3})),
    *(("spray_points", SPRAY), ("spray_points", SPRAY | {"remove": True})),
    *(
        ("remove_point", {"id": 3}),
        ("edit_points", {}),
        ("paint_density", {}),
        ("live_preview", {}),
    ),
    *(
        ("show_density", {}),
        ("lock_points", {"every": True}),
        ("select_overlap", {}),
        ("select_overlapping", {}),
        ("select_small_parts", {}),
        ("mark_asset", {}),
    ),
    *(
        ("copy_scatter", {}),
        ("remove_scatter", {}),
        ("edit_object_types", {}),
        ("select_surface", {}),
    ),
    *(("export_points", {"filepath": "points.csv"}), ("save_preset", {"name": "Spoilt"})),
]


@pytest.mark.sampled(6)
@pytest.mark.parametrize("spoil", SPOILT, ids=lambda one: one.__name__)
@pytest.mark.parametrize("made", [touching, baked])
@pytest.mark.parametrize("case", TRIED, ids=lambda case: case[0])
def test_scales_and_places_that_cannot_be(case, made, spoil, tmp_path):
    name, properties = case
    obj = made()
    spoil(obj)
    bpy.context.view_layer.update()
    if "filepath" in properties:
        properties = {"filepath": str(tmp_path / properties["filepath"])}
    operator, before = getattr(bpy.ops.dapple, name), whole_file.everything()
    if not operator.poll():
        return
    count = len(obj.data.vertices)
    try:
        assert operator(**properties) == {"FINISHED"}
    except RuntimeError as error:
        said = str(error)
        assert "failed, nothing was changed" not in said, said
        assert said.startswith("Error: ")
        assert said.count("\n") == 1
        assert whole_file.differences(before) == {}
    else:
        works(name, obj, count)
    finally:
        addon_host.part("blender.density.overlay").stop()
        preview = addon_host.part("blender.display.preview")
        active = bpy.context.object
        if active is not None and preview.is_on(active):
            bpy.ops.dapple.live_preview()
            assert not preview.is_on(active)


def works(name, obj, count):
    """What an operator has written is all there, and a number."""
    if name == "remove_scatter":
        return
    mesh = obj.data
    if obj.mode == "OBJECT":
        wanted = count + {"add_point": 1, "remove_point": -1}.get(name, 0)
        assert len(mesh.vertices) == wanted or name == "spray_points"
        ids = [one.value for one in mesh.attributes["id"].data]
        assert len(set(ids)) == len(ids)
        places = np.array([vertex.co for vertex in mesh.vertices])
        assert np.isfinite(places).all()
    if name in {"add_point", "remove_point", "spray_points"} and obj.dapple.amount == "COUNT":
        assert obj.dapple.report.count == len(mesh.vertices)


@pytest.mark.empty_file
@pytest.mark.parametrize("change", CHANGES, ids=lambda one: one.__name__)
def test_add_on_scales_and_places_that_cannot_be(change):
    surface = scenes.sphere()
    change(surface)
    bpy.context.view_layer.update()
    scenes.activate(surface)
    before = whole_file.everything()
    try:
        assert bpy.ops.dapple.add_scatter(count=40) == {"FINISHED"}
    except RuntimeError as error:
        said = str(error)
        assert "failed, nothing was changed" not in said
        assert whole_file.differences(before) == {}
    else:
        works("add_scatter", bpy.context.object, 40)


def shown_as(obj):
    yield "edited", lambda: bpy.ops.dapple.edit_points()
    yield "disabled", lambda: setattr(obj, "hide_viewport", True)
    yield "hidden", lambda: obj.hide_set(True)


@pytest.mark.parametrize("way", ["edited", "disabled", "hidden"])
@pytest.mark.parametrize("made", [touching, baked])
@pytest.mark.parametrize("case", TRIED, ids=lambda case: case[0])
def test_while_points_are_edited_or_the_scatter_is_hidden(case, made, way, tmp_path):
    """The button is gray and says why, or the operator does, or it works."""
    name, properties = case
    obj = made()
    if way == "edited" and made is baked:
        pytest.skip("a bake is not edited")
    dict(shown_as(obj))[way]()
    if "filepath" in properties:
        properties = {"filepath": str(tmp_path / properties["filepath"])}
    operator = getattr(bpy.ops.dapple, name)
    before = whole_file.everything()
    if not operator.poll():
        return
    try:
        assert operator(**properties) == {"FINISHED"}
    except RuntimeError as error:
        said = str(error)
        assert "failed, nothing was changed" not in said, said
        assert said.count("\n") == 1
        assert whole_file.differences(before) == {}
    finally:
        addon_host.part("blender.density.overlay").stop()


def test_a_confirmed_deletion_of_a_bake_that_fails_keeps_the_bake():
    obj = baked()
    obj.dapple.density.attribute = "Missing"
    before = whole_file.everything()
    for action in ("OPTIMIZE", "REATTACH"):
        if action == "REATTACH":
            obj.dapple.surface = None
            before = whole_file.everything()
        with pytest.raises(RuntimeError) as raised:
            bpy.ops.dapple.delete_keyframes(action=action)
        assert str(raised.value).count("\n") == 1
        assert "Traceback" not in str(raised.value)
        assert whole_file.differences(before) == {}
    assert obj.dapple.baked_keys


def test_nothing_is_left_of_a_copy_of_the_points():
    obj = scattered()
    names = {mesh.name for mesh in bpy.data.meshes}
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert {mesh.name for mesh in bpy.data.meshes} == names
    assert obj.data.name in names
