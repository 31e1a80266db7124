# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension itself: enabling, layers, manifest, one name for each option."""

import re
import subprocess
import sys
import tomllib
from dataclasses import fields
from pathlib import Path

import addon_host
import bpy
import child
import pytest
import scenes

WITHOUT_BPY = """
import importlib, pathlib, sys
sys.modules["bpy"] = None
folder = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(folder.parent))
names = sorted(path.stem for path in (folder / "core").glob("*.py"))
for name in names:
    importlib.import_module(f"{folder.name}.core.{name}")
print(len(names))
"""

WITHOUT_DAPPLE = """
import tempfile
sys.modules["dapple"] = None
import addon_host
addon_host.add_repository(addon_host.Path(tempfile.mkdtemp()))
addon_host.enable()
import scenes
scenes.sphere()
print(bpy.ops.dapple.add.poll(), addon_host.part("core.native").missing())
addon_host.disable()
"""


INSTALLED = """
bpy.ops.preferences.addon_enable(module="bl_pkg")
bpy.ops.extensions.package_install_files(
    filepath=arguments[0], repo="user_default", enable_on_install=True
)
import scenes
obj = scenes.scattered(scenes.sphere())
module = next(name for name in sys.modules if name.endswith("dapple.blender.work"))
print(len(scenes.positions(obj)), "points in", module.removesuffix(".blender.work"))
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.dapple")
"""


def extension_tool(*arguments):
    """Blender's own builder and validator of extensions."""
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    tool = scripts / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"
    done = subprocess.run(
        [sys.executable, str(tool), *arguments], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_enable_and_disable_again_and_again():
    for _ in range(3):
        addon_host.disable()
        assert not hasattr(bpy.types.Object, "dapple")
        assert "DAPPLE_OT_add" not in dir(bpy.types)
        addon_host.enable()
        assert hasattr(bpy.types.Object, "dapple")
    assert len(scenes.positions(scenes.scattered(scenes.sphere()))) == 60


def test_the_core_needs_no_bpy():
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_BPY, str(addon_host.sources())],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert int(done.stdout) >= 8


def test_without_the_native_package_the_add_on_enables_and_says_what_is_missing():
    said = child.run(WITHOUT_DAPPLE)
    assert "False Dapple's native Python package 'dapple' cannot be loaded" in said


def test_the_manifest_asks_for_work_files_only_and_names_the_minimum():
    manifest = tomllib.loads((addon_host.sources() / "blender_manifest.toml").read_text())
    assert manifest["id"] == "dapple"
    assert manifest["blender_version_min"] == "4.3.0"
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert list(manifest["permissions"]) == ["files"]


def test_blender_accepts_the_extension():
    extension_tool("validate", str(addon_host.sources()))


def test_the_zip_installs_from_disk(tmp_path):
    archive = tmp_path / "dapple.zip"
    extension_tool("build", f"--source-dir={addon_host.sources()}", f"--output-filepath={archive}")
    assert "60 points in bl_ext.user_default.dapple" in child.run(INSTALLED, archive)


def test_options_have_the_names_and_defaults_of_the_native_package():
    settings = addon_host.part("core.settings").Settings()
    package = addon_host.part("core.native").package()
    heads = package.sample.__doc__.splitlines() + package.Tracker.__init__.__doc__.splitlines()
    found = re.findall(r"(\w+): [^=,)]+(?:= ([\w.-]+))?", heads[0])
    tracker = re.findall(r"(stickiness): float = ([\d.]+)", "".join(heads[1:]))
    sample = dict([*found, *tracker])
    shown = bpy.types.Object.bl_rna.properties["dapple"].fixed_type.properties
    assert settings.classes == ()  # a list, for sample_classes
    assert shown["classes"].type == "COLLECTION"
    own = shown["density"].fixed_type.properties  # terms of a density
    for field in fields(settings.density):
        value = getattr(settings.density, field.name)
        if own[field.name].type == "POINTER":  # a data-block, in the settings by its name
            assert value == ""
            continue
        assert own[field.name].default == (
            value if isinstance(value, str) else pytest.approx(value, rel=1e-6)
        )
    for field in fields(settings):
        value = getattr(settings, field.name)
        if field.name in ("classes", "density", "forward", "per_area"):
            continue
        assert field.name in sample
        assert shown[field.name].default == pytest.approx(value, rel=1e-6)
        if field.name != "count":
            assert float(sample[field.name]) == value


def test_the_panel_says_how_even_it_is_and_whether_it_is_fresh():
    results = addon_host.part("blender.results")
    surface = scenes.sphere()
    obj = scenes.scattered(surface, count=120)
    lines = [text for text, _ in results.result_lines(obj, bpy.context)]
    assert lines[0].startswith("120 points, capacity spread ")
    assert lines[1].startswith("Spacing 0.")
    assert lines[-1] == "Fresh: fits the surface"
    surface.modifiers.new("Subdivision", "SUBSURF")
    lines = [text for text, _ in results.result_lines(obj, bpy.context)]
    assert lines[-1].startswith("Stale: Bound to 266 vertices, the surface has ")
