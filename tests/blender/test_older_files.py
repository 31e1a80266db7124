# SPDX-License-Identifier: GPL-3.0-or-later
"""Files, presets and tiles of versions that had other names for what they store."""

import json

import addon_host
import bpy
import scenes


def older_scatter():
    """A scatter as it was stored when some of its settings and figures had other names."""
    obj = scenes.scattered(scenes.sphere(), count=30)
    bpy.ops.dapple.optimize()
    stored_values = addon_host.part("blender.data.older_files").stored_values
    stored_values(obj.dapple.tiles)["colour_by"] = 1
    for group, old, new in (
        (obj.dapple, "gap_weight", "repulsion_weight"),
        (obj.dapple.report, "capacity_spread", "capacity_variation"),
    ):
        stored = stored_values(group)
        stored.pop(new, None)
        stored[old] = 4.0
    solved = json.loads(obj.dapple.solved_settings)
    solved["gap_weight"] = solved.pop("repulsion_weight") + 1.0
    obj.dapple.solved_settings = json.dumps(solved)
    assert obj.dapple.tiles.color_by == "RANDOM"
    return obj


def test_an_older_file_keeps_its_settings(tmp_path):
    name, path = older_scatter().name, str(tmp_path / "older.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    settings = bpy.data.objects[name].dapple
    assert settings.tiles.color_by == "CLASS"
    assert (settings.repulsion_weight, settings.report.capacity_variation) == (4.0, 4.0)
    staleness = addon_host.part("core.stale")
    now = addon_host.part("blender.data.scatter").settings_of(bpy.data.objects[name])
    assert "repulsion_weight" not in staleness.changed_settings(settings.solved_settings, now)
    settings.tiles.color_by = "RANDOM"
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert bpy.data.objects[name].dapple.tiles.color_by == "RANDOM", "renamed once"


def test_scatters_appended_and_linked_from_an_older_file_keep_their_settings(tmp_path):
    name, path = older_scatter().name, str(tmp_path / "older.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    for link in (False, True):
        bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
        with bpy.data.libraries.load(path, link=link) as (_, wanted):
            wanted.objects = [name]
        assert bpy.data.objects[name].dapple.tiles.color_by == "CLASS"


def test_an_older_preset_keeps_its_settings():
    obj = scenes.scattered(scenes.sphere(), count=30)
    folder = addon_host.part("blender.steps.presets").folder()
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "Older.json"
    stored = {"schema": 1, "settings": {"tiles": {"grout": 0.25, "colour_by": "CLASS"}}}
    path.write_text(json.dumps(stored))
    assert bpy.ops.dapple.load_preset(name="Older") == {"FINISHED"}
    path.unlink()
    assert (obj.dapple.tiles.grout, obj.dapple.tiles.color_by) == (0.25, "CLASS")


def test_tiles_keep_the_attribute_that_older_materials_name():
    obj = scenes.scattered(scenes.sphere(), count=30)
    bpy.ops.dapple.tile()
    made = obj.dapple.tiles.object
    made.data.color_attributes["Color"].name = "Colour"
    bpy.ops.dapple.tile()
    assert [one.name for one in made.data.color_attributes] == ["Colour"]


def test_the_warning_of_an_older_node_group_is_written():
    obj = scenes.scattered(scenes.sphere(), count=30)
    group = obj.modifiers[0].node_group
    group.interface.items_tree["Warning"].name = "Stale"
    obj.dapple.seed = 7
    nodes = addon_host.part("nodes")
    assert nodes.get_input(obj.modifiers[0], "Warning").startswith("Settings were changed (Seed)")
    bpy.ops.dapple.optimize()
    assert obj.modifiers[0].node_group != group
    assert nodes.get_input(obj.modifiers[0], "Warning") == ""
