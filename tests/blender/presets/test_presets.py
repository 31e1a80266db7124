# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets as JSON files, and the one that new scatters begin with."""

import json
import re
import types

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from test_panels import Layout


@pytest.fixture
def folder():
    """Folder of presets of this test; empty before and afterward."""
    found = addon_host.part("blender.presets.stored").folder()
    for path in found.glob("*.json"):
        path.unlink()
    yield found
    for path in found.glob("*.json"):
        path.unlink()


def test_settings_come_back_on_another_scatter(folder):
    obj = scenes.scattered(scenes.sphere(), count=40)
    obj.dapple.capacity_weight, obj.dapple.random_tilt = 7.0, 0.25
    obj.dapple.density.use_height, obj.dapple.tiles.grout = True, 0.3
    assert bpy.ops.dapple.save_preset(name="Scales (wide)") == {"FINISHED"}
    other = scenes.scattered(scenes.sphere(), count=30)
    assert bpy.ops.dapple.load_preset(name="Scales (wide)") == {"FINISHED"}
    assert other.dapple.capacity_weight == 7.0
    assert other.dapple.random_tilt == 0.25
    assert other.dapple.density.use_height
    assert other.dapple.tiles.grout == pytest.approx(0.3)
    assert other.dapple.count == 40
    stored = json.loads((folder / "Scales (wide).json").read_text())
    assert stored["settings"][""]["random_tilt"] == 0.25
    assert bpy.ops.dapple.remove_preset(name="Scales (wide)") == {"FINISHED"}
    assert not list(folder.iterdir())


def with_types(obj, *types):
    for values in types:
        bpy.ops.dapple.edit_object_types(action="ADD")
        for name, value in values.items():
            setattr(obj.dapple.object_types[-1], name, value)
    return obj


def thing(name):
    bpy.ops.mesh.primitive_cube_add(size=0.3)
    bpy.context.object.name = name
    return bpy.context.object


TYPES = (
    {"name": "Rocks", "use_count": True, "count": 5, "radius": 0.25, "scale": 2.0},
    {"name": "Grass", "weight": 3.0, "random_tilt": 0.125, "offset": -0.5, "density_scale": 0.75},
)


def test_object_types_come_back_on_another_scatter(folder):
    with_types(scenes.scattered(scenes.sphere(), count=40), *TYPES)
    bpy.ops.dapple.save_preset(name="Meadow")
    other = scenes.scattered(scenes.sphere(), count=30)
    bpy.ops.dapple.load_preset(name="Meadow")
    assert [kind.name for kind in other.dapple.object_types] == ["Rocks", "Grass"]
    for kind, values in zip(other.dapple.object_types, TYPES, strict=True):
        assert {name: getattr(kind, name) for name in values} == values
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    kinds = [one.value for one in other.data.attributes["dapple_object_type"].data]
    assert np.bincount(kinds).tolist() == [5, 35]
    assert len(scenes.instance_matrices(other)) == 40


def test_object_types_keep_the_objects_that_they_have_here(folder):
    with_types(scenes.scattered(scenes.sphere(), count=40), *TYPES, {"name": "Moss"})
    bpy.ops.dapple.save_preset(name="Meadow")
    grass, stone, left = thing("Blade"), thing("Stone"), thing("Left")
    own = ({"name": "Grass", "instance": grass}, {"name": "Boulders", "instance": stone})
    other = with_types(scenes.scattered(scenes.sphere(), count=30), *own)
    bpy.ops.dapple.load_preset(name="Meadow")
    found = {kind.name: kind.instance for kind in other.dapple.object_types}
    assert found == {"Rocks": stone, "Grass": grass, "Moss": None}
    other.dapple.object_types[2].instance = left
    bpy.ops.dapple.load_preset(name="Meadow")
    assert [kind.instance for kind in other.dapple.object_types] == [stone, grass, left]


def test_a_preset_without_object_types_leaves_those_that_are_there(folder):
    scenes.scattered(scenes.sphere(), count=40)
    bpy.ops.dapple.save_preset(name="Plain")
    other = with_types(scenes.scattered(scenes.sphere(), count=30), *TYPES)
    bpy.ops.dapple.load_preset(name="Plain")
    assert [kind.name for kind in other.dapple.object_types] == ["Rocks", "Grass"]


def test_a_radius_from_a_preset_is_no_longer_that_of_the_bounds(folder):
    with_types(scenes.scattered(scenes.sphere(), count=40), {"name": "Rocks", "radius": 0.25})
    bpy.ops.dapple.save_preset(name="Meadow")
    rock = thing("Rock")
    other = scenes.scattered(scenes.sphere(), count=30)
    with_types(other, {"name": "Rocks", "instance": rock, "radius_from_bounds": True})
    assert other.dapple.object_types[0].radius == pytest.approx(0.15 * np.sqrt(2))
    bpy.ops.dapple.load_preset(name="Meadow")
    assert other.dapple.object_types[0].radius == 0.25


def test_new_scatters_begin_with_the_object_types_of_the_default(folder):
    bounds = {"name": "Trees", "radius_from_bounds": True, "fit_to_spacing": 1.0, "weight": 1.0}
    with_types(scenes.scattered(scenes.sphere(), count=40), *TYPES, bounds)
    bpy.ops.dapple.save_preset(name="Default")
    scenes.sphere()
    assert bpy.ops.dapple.add_scatter() == {"FINISHED"}
    new = bpy.context.object
    assert [kind.name for kind in new.dapple.object_types] == ["Rocks", "Grass", "Trees"]
    kinds = [one.value for one in new.data.attributes["dapple_object_type"].data]
    assert np.bincount(kinds).tolist() == [5, 26, 9]
    assert addon_host.part("blender.scatter.object").settings_reason(new) == ""


def test_a_default_whose_object_type_does_not_fit_is_reported(folder, capfd):
    obj = with_types(scenes.scattered(scenes.sphere(), count=40), *TYPES)
    obj.dapple.object_types[1].density = "Clearing"
    bpy.ops.dapple.save_preset(name="Default")
    scenes.sphere()
    assert bpy.ops.dapple.add_scatter() == {"FINISHED"}
    assert "no attribute or vertex group 'Clearing'" in capfd.readouterr().out
    kinds = bpy.context.object.dapple.object_types
    assert [(kind.name, kind.density) for kind in kinds] == [("Rocks", ""), ("Grass", "")]


def test_a_preset_with_a_broken_object_type_is_reported_and_changes_nothing(folder):
    obj = with_types(scenes.scattered(scenes.sphere(), count=40), *TYPES)
    bpy.ops.dapple.save_preset(name="Meadow")
    path = folder / "Meadow.json"
    path.write_text(path.read_text().replace('"random_tilt": 0.125', '"random_tilt": "steep"'))
    obj.dapple.object_types[0].scale, obj.dapple.seed = 4.0, 9
    with pytest.raises(RuntimeError, match="'Grass' cannot have random_tilt 'steep'"):
        bpy.ops.dapple.load_preset(name="Meadow")
    assert (obj.dapple.object_types[0].scale, obj.dapple.seed) == (4.0, 9)
    path.write_text(json.dumps({"schema": 1, "settings": {"object_types": {"name": "Rocks"}}}))
    with pytest.raises(RuntimeError, match="cannot be read"):
        bpy.ops.dapple.load_preset(name="Meadow")


def test_new_scatters_begin_with_the_default(folder):
    obj = scenes.scattered(scenes.sphere(), count=40)
    obj.dapple.density.use_height, obj.dapple.density.height_min = True, 0.0
    obj.dapple.density.height_max, obj.dapple.density.height_falloff = 5.0, 0.0
    obj.dapple.seed = 11
    bpy.ops.dapple.save_preset(name="Default")
    surface = scenes.sphere()
    assert bpy.ops.dapple.add_scatter() == {"FINISHED"}
    new = bpy.context.object
    assert (new.dapple.count, new.dapple.seed) == (40, 11)
    assert scenes.positions(new)[:, 2].min() > -0.1
    assert addon_host.part("blender.scatter.object").settings_reason(new) == ""
    bpy.context.view_layer.objects.active = surface
    bpy.ops.dapple.add_scatter(count=25)
    assert len(scenes.positions(bpy.context.object)) == 25


def test_a_default_per_area_gives_way_to_a_count(folder):
    obj = scenes.scattered(scenes.sphere(), count=40)
    obj.dapple.amount, obj.dapple.points_per_area = "PER_AREA", 2.0
    bpy.ops.dapple.save_preset(name="Default")
    surface = scenes.sphere()
    bpy.ops.dapple.add_scatter()
    assert len(scenes.positions(bpy.context.object)) == pytest.approx(8 * np.pi, abs=1.5)
    bpy.context.view_layer.objects.active = surface
    bpy.ops.dapple.add_scatter(count=25)
    assert len(scenes.positions(bpy.context.object)) == 25


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "cannot be read"),
        ('{"settings": []}', "cannot be read"),
        ('{"schema": 99, "settings": {}}', "schema 99 is not known"),
        (
            '{"schema": 1, "settings": {"": {"count": 7, "random_tilt": "steep"}}}',
            "does not fit.*tilt",
        ),
    ],
)
def test_a_broken_preset_is_reported_and_changes_nothing(folder, text, said):
    obj = scenes.scattered(scenes.sphere(), count=40)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "Broken.json").write_text(text)
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.dapple.load_preset(name="Broken")
    assert obj.dapple.count == 40


def test_a_preset_of_a_newer_version_is_taken_as_far_as_it_is_known(folder):
    obj = scenes.scattered(scenes.sphere(), count=40)
    folder.mkdir(parents=True, exist_ok=True)
    values = {"schema": 1, "settings": {"": {"seed": 5, "unheard_of": 3}, "clouds": {"a": 1}}}
    (folder / "Newer.json").write_text(json.dumps(values))
    bpy.ops.dapple.load_preset(name="Newer")
    assert obj.dapple.seed == 5


@pytest.mark.parametrize("name", ["", "../up", "a/b", " led", "end.", "two\nlines"])
def test_a_name_that_is_no_file_is_refused(folder, name):
    scenes.scattered(scenes.sphere(), count=20)
    with pytest.raises(RuntimeError, match="cannot be called"):
        bpy.ops.dapple.save_preset(name=name)
    assert not list(folder.glob("**/*.json"))


def test_a_preset_that_is_gone_is_reported(folder):
    scenes.scattered(scenes.sphere(), count=20)
    for operator in (bpy.ops.dapple.load_preset, bpy.ops.dapple.remove_preset):
        with pytest.raises(RuntimeError, match="no preset 'Gone'"):
            operator(name="Gone")


def default(folder, text):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "Default.json").write_text(text)


def of(density=None, **own):
    settings = {"": {"count": 40, **own}, "density": density or {}}
    return json.dumps({"schema": 1, "settings": settings})


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (of({"attribute": "Grass", "curvature": 0.5}), "no attribute or vertex group 'Grass'"),
        (of({"use_camera_view": True, "curvature": 0.5}), "has no camera"),
        (of({"uv_map": "Painted", "curvature": 0.5}), "no UV map 'Painted'"),
        (of({"curvature": 0.5}, random_tilt="steep"), r"random_tilt \('steep'\)"),
        (of({"curvature": 0.5}, seed=-3), r"seed \(-3\)"),
        (of({"curvature": 0.5}, align_to_normal="UPRIGHT"), "align_to_normal"),
    ],
)
def test_a_default_that_does_not_fit_is_left_out_and_reported(folder, text, said, capfd):
    default(folder, text)
    scenes.sphere()
    assert bpy.ops.dapple.add_scatter() == {"FINISHED"}
    new = bpy.context.object
    assert len(scenes.positions(new)) == 40, "what fits is taken"
    assert new.dapple.density.curvature == 0.5
    printed = capfd.readouterr().out
    assert re.search(f"Warning: Preset 'Default' does not fit here, skipped: .*{said}", printed)
    assert addon_host.part("blender.scatter.object").settings_reason(new) == ""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (of({"use_height": True, "height_min": 50.0, "height_max": 60.0}), "density"),
        (of(amount="PER_AREA", points_per_area=1e12), "all settings"),
        ("{", "cannot be read"),
        ('{"schema": 99, "settings": {}}', "schema 99 is not known"),
    ],
)
def test_a_default_that_leaves_no_point_does_not_block_add(folder, text, said, capfd):
    default(folder, text)
    scenes.sphere()
    assert bpy.ops.dapple.add_scatter() == {"FINISHED"}
    assert len(scenes.positions(bpy.context.object)) in (40, 1000)
    printed = capfd.readouterr().out
    assert re.search(f"Warning: Preset 'Default'.*{said}", printed)


def test_a_default_with_a_binding_that_cannot_be_gives_way(folder, capfd):
    default(folder, of(attach_to="FACES"))
    scenes.tail(levels=1, render_levels=2)
    assert bpy.ops.dapple.add_scatter() == {"FINISHED"}
    new = bpy.context.object
    assert (new.dapple.attach_to, new.dapple.attached_to, new.dapple.count) == ("AUTO", "REST", 40)
    assert "skipped: attachment (" in capfd.readouterr().out


def test_what_is_chosen_by_hand_is_refused_with_its_own_reason(folder):
    default(folder, of({"curvature": 0.5}))
    scenes.tail(levels=1, render_levels=2)
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match="410 vertices in the viewport and 1634"):
        bpy.ops.dapple.add_scatter(attach_to="FACES")
    assert scenes.snapshot() == before


def test_a_preset_is_removed_without_a_scatter(folder):
    default(folder, of())
    assert bpy.context.object is None
    assert bpy.ops.dapple.remove_preset(name="Default") == {"FINISHED"}
    assert not list(folder.iterdir())


@pytest.mark.parametrize("where", ["panel", "preferences"])
def test_presets_can_be_removed_where_no_scatter_is_selected(folder, where):
    default(folder, of())
    scenes.sphere()
    shown = []
    if where == "panel":
        panel = types.SimpleNamespace(layout=Layout(shown))
        bpy.types.DAPPLE_PT_main.draw(panel, bpy.context)
    else:
        preferences = types.SimpleNamespace(layout=Layout(shown), remove_library=False)
        preferences.layout.prop = lambda *_, **__: None
        preferred = addon_host.part("blender.preferences")
        preferred.DAPPLE_AP_preferences.draw(preferences, bpy.context)
    assert "dapple.remove_preset" in shown
    assert "dapple.load_preset" not in shown


@pytest.mark.parametrize("name", ["Meadow", "Other"])
def test_the_dialog_says_that_a_preset_is_replaced(folder, name):
    scenes.scattered(scenes.sphere())
    bpy.ops.dapple.save_preset(name="Meadow")
    operators, shown = addon_host.part("blender.presets.operators"), []
    dialog = types.SimpleNamespace(layout=Layout(shown), name=name)
    dialog.layout.prop = lambda *_: None
    operators.DAPPLE_OT_save_preset.draw(dialog, bpy.context)
    assert shown == (["Replaces the preset of this name"] if name == "Meadow" else [])
