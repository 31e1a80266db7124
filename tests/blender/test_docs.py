# SPDX-License-Identifier: GPL-3.0-or-later
"""The statements of docs/add-on.md are true."""

import importlib
import json
import re
from pathlib import Path

import addon_host
import bpy
import numpy as np
import pytest
import scenes

DOCS = Path(__file__).parents[2] / "docs"
MANUAL = sorted((DOCS / "manual").glob("*.md"))
# Operators, panels and assets of Blender itself.
BLENDERS_OWN = {
    "Adjust Last Operation",
    "Airbrush",
    "Compress",
    "Extrude",
    "Geometry",
    "Interpolate Hair Curves",
    "Save As",
}
TEXT, OPTIONS = [(DOCS / name).read_text() for name in ("add-on.md", "options.md")]
SCRIPTS = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


def test_the_script_runs(capsys):
    for name in ("Tuft", "Pebble"):
        bpy.ops.mesh.primitive_cube_add(size=0.05)
        bpy.context.object.name = name
    rocks = bpy.data.collections.new("Rocks")
    rocks.objects.link(bpy.data.objects["Pebble"])
    surface = scenes.tail(frames=2)
    values = np.ones(len(surface.data.vertices), np.float32)
    surface.data.attributes.new("Grass", "FLOAT", "POINT").data.foreach_set("value", values)
    exec(SCRIPTS[0].replace("count=2000", "count=60"), {})
    assert len(capsys.readouterr().out.split()) >= 2
    obj = bpy.context.object
    assert obj.dapple.baked_keys == 2
    assert obj.dapple.report.count == 60
    assert [round(one.weight, 2) for one in obj.dapple.object_types] == [1.0, 0.05]


def test_the_script_for_assets_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    meadow = scenes.sphere()
    meadow.name = "Meadow"
    scenes.scattered(meadow, count=50)
    bpy.ops.dapple.mark_asset()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    scenes.sphere().name = "Ground"
    (script,) = SCRIPTS[2:]
    exec(script, {"bpy": bpy})
    assert bpy.data.objects["Meadow Scatter Asset"].dapple.report.count == 50


def test_the_table_of_clicks_has_all_tasks_within_their_goals(tmp_path, monkeypatch):
    monkeypatch.setenv("DAPPLE_SHOTS", str(tmp_path))
    tasks = importlib.import_module("benchmarks.addon.tasks").TASKS
    found = re.findall(
        r"^\| (.+) \| (\d+) \| ([\d-]+) \| ([\d-]+) \|$", TEXT.split("## Clicks")[1], re.M
    )
    rows = [row for row in found if row[0][0].islower()]
    assert len(rows) == len(tasks)
    for (task, clicks, *own), (name, goal, _, *blenders) in zip(rows, tasks, strict=True):
        assert task.startswith(name.split(":")[0].lower()) or name.startswith("Classes"), name
        assert int(clicks) <= goal, name
        assert own == ["-" if steps is None else str(len(steps)) for steps in blenders], name


def test_the_script_for_the_spray_brush_runs():
    obj = scenes.scattered(scenes.sphere(), count=200)
    exec(SCRIPTS[1], {"bpy": bpy})
    assert obj.dapple.locked_count == obj.dapple.count - 200 > 10


def test_the_script_for_exports_runs(tmp_path):
    trees = scenes.scattered(scenes.sphere(), count=20)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "trees.blend"))
    scenes.activate(trees)
    script, _for_unreal = re.findall(
        r"```python\n(.*?)```", (DOCS / "export.md").read_text(), re.DOTALL
    )
    suffix = ".usdc" if bpy.app.build_options.usd else ".csv"
    exec(script.replace(".usdc", suffix), {"bpy": bpy})
    assert (tmp_path / f"trees{suffix}").stat().st_size > 1000


def test_every_operator_and_property_is_reported():
    for name in dir(bpy.ops.dapple):
        assert f"`{name}(" in TEXT, f"no word of bpy.ops.dapple.{name}"
    groups = {"": scenes.scattered(scenes.sphere()).dapple}
    groups["density."], groups["tiles."] = groups[""].density, groups[""].tiles
    internal = {
        "rna_type",
        "name",
        "object_types",
        "object_type_index",
        "density",
        "tiles",
        "report",
    }
    options = addon_host.part("core.settings.values").Settings().sample_options()
    stored = ("surface", "baked", "attached", "solved", "bake_fingerprint", "preview_budget")
    for prefix, group in groups.items():
        for name in set(group.bl_rna.properties.keys()) - internal:
            parts = name.removeprefix("slope_").removeprefix("height_")
            mentioned = (
                name in TEXT or (prefix and parts in TEXT) or (name in options and name in OPTIONS)
            )
            assert mentioned or name.startswith(stored), f"no word of {prefix}{name}"


def texts() -> set[str]:
    """What the add-on says: test_translation.py holds that the translation lists all of it."""
    contexts = json.loads((addon_host.CHECKOUT / "translations" / "de_DE.json").read_text())
    return {text for context in contexts.values() for text in context}


@pytest.mark.parametrize("page", MANUAL, ids=lambda page: page.stem)
def test_the_manual_names_what_there_is(page):
    text = page.read_text()
    named = re.findall(r"(?<![*\w])\*([^*]+)\*(?!\*)", text)
    assert {" ".join(name.split()) for name in named} - texts() - BLENDERS_OWN == set()


@pytest.mark.parametrize("page", MANUAL, ids=lambda page: page.stem)
def test_the_manual_quotes_what_the_panel_says(page):
    said = set(re.findall(r"`([^`]+)`", page.read_text())) - {"NAME.dapple", "Default"}
    assert {
        message for message in said if not any(fits(message, text) for text in texts())
    } == set()


def fits(message: str, text: str) -> bool:
    """Whether a message matches a text with placeholders, or starts or ends with one."""
    pieces = re.split(r"\{[^}]*\}", text)
    whole = re.fullmatch(".+".join(map(re.escape, pieces)), message)
    part = any(piece.strip(" ,:") == message for piece in pieces)
    return part or (whole is not None and len(max(pieces, key=len)) > len("{a}: {b}"))


def test_the_manual_shows_its_pictures():
    shown = {
        page.parent / name
        for page in MANUAL
        for name in re.findall(r"!\[[^\]]+\]\(([^)]+)\)", page.read_text())
    }
    assert shown == set((DOCS / "manual" / "images").iterdir())
    assert all(picture.stat().st_size <= 150_000 for picture in shown)
