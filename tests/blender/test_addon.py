# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension itself: enabling, layers, manifest, one name for each option."""

import ast
import importlib
import os
import re
import subprocess
import sys
import tomllib
from dataclasses import fields
from pathlib import Path

import addon_host
import addon_utils
import bpy
import child
import pytest
import scenes

WITHOUT_BPY = """
import importlib, pathlib, sys
sys.modules["bpy"] = None
folder = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(folder.parent))
names = sorted(path.relative_to(folder.parent) for path in (folder / "core").rglob("*.py"))
for name in names:
    importlib.import_module(".".join(name.with_suffix("").parts))
print(len(names))
"""

# Values that stand for the module of the native package.
INSTEAD_OF_DAPPLE = """
import tempfile, types
sys.modules["dapple3d"] = {module}
import addon_host
import addon_utils
addon_host.add_repository(addon_host.Path(tempfile.mkdtemp()))
addon_host.enable()
import scenes
scenes.sphere()
print(bpy.ops.dapple.add_scatter.poll(), addon_host.part("core.base.native").missing())
addon_host.disable()
"""


INSTALLED = """
bpy.ops.preferences.addon_enable(module="bl_pkg")
bpy.ops.extensions.package_install_files(
    filepath=arguments[0], repo="user_default", enable_on_install=True
)
import scenes
obj = scenes.scattered(scenes.sphere())
module = next(name for name in sys.modules if name.endswith("dapple.blender.solve.optimize"))
print(len(scenes.positions(obj)), "points in", module.removesuffix(".blender.solve.optimize"))
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
        assert "DAPPLE_OT_add_scatter" not in dir(bpy.types)
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
    assert int(done.stdout) >= 30


def test_without_the_native_package_the_add_on_enables_and_says_what_is_missing():
    said = child.run(INSTEAD_OF_DAPPLE.format(module="None"))
    assert "False Dapple's native Python package 'dapple3d' cannot be loaded" in said


def test_with_an_older_native_package_the_add_on_enables_and_says_so():
    said = child.run(INSTEAD_OF_DAPPLE.format(module="types.ModuleType('dapple3d')"))
    assert "False Dapple's native Python package 'dapple3d' is older than this add-on" in said


def test_the_manifest_asks_for_work_files_only_and_names_the_minimum():
    manifest = tomllib.loads((addon_host.sources() / "blender_manifest.toml").read_text())
    assert manifest["id"] == "dapple"
    assert manifest["blender_version_min"] == "4.3.0"
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later", "SPDX:CC0-1.0"]  # assets: CC0
    assert list(manifest["permissions"]) == ["files"]


def test_blender_accepts_the_extension():
    extension_tool("validate", str(addon_host.sources()))


def test_the_zip_installs_from_disk(tmp_path):
    archive = tmp_path / "dapple.zip"
    extension_tool("build", f"--source-dir={addon_host.sources()}", f"--output-filepath={archive}")
    assert "60 points in bl_ext.user_default.dapple" in child.run(INSTALLED, archive)


def test_options_have_the_names_and_defaults_of_the_native_package():
    settings = addon_host.part("core.settings.values").Settings()
    package = addon_host.part("core.base.native").package()
    heads = package.sample.__doc__.splitlines() + package.Tracker.__init__.__doc__.splitlines()
    found = re.findall(r"(\w+): [^=,)]+(?:= ([\w.-]+))?", heads[0])
    tracker = re.findall(r"(stickiness): float = ([\d.]+)", "".join(heads[1:]))
    surface = re.findall(r"(merge_doubled): bool = (\w+)", package.Surface.__init__.__doc__)
    sample = dict([*found, *tracker, *surface])
    shown = bpy.types.Object.bl_rna.properties["dapple"].fixed_type.properties
    assert settings.object_types == ()  # sample_classes takes a list instead
    assert shown["object_types"].type == "COLLECTION"
    own = shown["density"].fixed_type.properties  # terms of a density
    for field in fields(settings.density):
        value = getattr(settings.density, field.name)
        if own[field.name].type == "POINTER":  # data-blocks are stored by name
            assert value == ""
            continue
        if own[field.name].type == "COLLECTION":
            assert value == ()
            continue
        assert own[field.name].default == (
            value if isinstance(value, str) else pytest.approx(value, rel=1e-6)
        )
    edges = {one.name for one in addon_host.part("core.settings.edge_table").EDGES}
    for field in fields(settings):
        value = getattr(settings, field.name)
        if field.name in {"object_types", "density", "forward", "per_area", "symmetry"} | edges:
            continue
        assert field.name in sample
        assert shown[field.name].default == pytest.approx(value, rel=1e-6)
        if field.name != "count":
            assert ast.literal_eval(sample[field.name]) == value


def test_the_panel_says_how_even_it_is_and_whether_it_is_fresh():
    results = addon_host.part("blender.solve.results_panel")
    surface = scenes.sphere()
    obj = scenes.scattered(surface, count=120)
    lines = [text for text, _ in results.result_lines(obj, bpy.context)]
    assert len(lines) == 1
    assert re.fullmatch(r"120 instances, spacing \d\d % of ideal, up to date", lines[0])
    surface.modifiers.new("Subdivision", "SUBSURF")
    lines = [text for text, _ in results.result_lines(obj, bpy.context)]
    assert lines[-1].startswith("Out of date: Attached to 266 vertices, the surface has ")


def traces():
    """Everything that an enabled add-on has added to Blender."""
    handlers = bpy.app.handlers
    lists = (name for name in dir(handlers) if isinstance(getattr(handlers, name), list))
    return {
        "property": hasattr(bpy.types.Object, "dapple"),
        "classes": sorted(name for name in dir(bpy.types) if "DAPPLE" in name.upper()),
        "handlers": sorted(
            f"{name} {one.__name__}"
            for name in lists
            for one in getattr(handlers, name)
            if "dapple" in one.__module__
        ),
        "menu": [
            one.__name__
            for one in bpy.types.VIEW3D_MT_mesh_add._dyn_ui_initialize()
            if "dapple" in one.__module__
        ],
    }


@pytest.fixture
def disabled():
    """The add-on disabled, and enabled again afterward."""
    addon_host.disable()
    yield traces()
    addon_host.disable()
    addon_host.enable()
    assert traces()["property"]


@pytest.mark.parametrize("step", range(7))
@pytest.mark.parametrize("when", ["before", "after"])
def test_an_add_on_that_cannot_be_enabled_leaves_nothing_behind(disabled, monkeypatch, step, when):
    root = addon_host.part("blender")
    steps = root.steps()
    add, take_back = steps[step]

    def failing():
        if when == "after":
            add()
        raise OSError("no more")

    steps[step] = failing, take_back
    monkeypatch.setattr(root, "steps", lambda: steps)
    with pytest.raises(OSError, match="no more"):
        root.register()
    assert traces() == disabled


@pytest.mark.parametrize("count", [0, 2, 7, 20])
def test_a_class_that_cannot_be_registered_leaves_nothing_behind(disabled, monkeypatch, count):
    root, seen, known = addon_host.part("blender"), [], bpy.utils.register_class

    def failing(cls):
        seen.append(cls)
        if len(seen) > count:
            raise ValueError("no more")
        known(cls)

    monkeypatch.setattr(bpy.utils, "register_class", failing)
    with pytest.raises(ValueError, match="no more"):
        root.register()
    assert traces() == disabled


def test_what_fails_while_disabling_does_not_keep_the_rest(disabled, monkeypatch):
    root = addon_host.part("blender")
    root.register()
    steps = root.steps()
    add, take_back = steps[9]

    def failing():
        take_back()
        raise OSError("gone")

    steps[9] = add, failing
    monkeypatch.setattr(root, "steps", lambda: steps)
    with pytest.raises(OSError, match="gone"):
        root.unregister()
    assert traces() == disabled


@pytest.fixture
def second(tmp_path):
    """Module of a second copy in a repository of its own, enabled after the first."""
    (tmp_path / "dapple").symlink_to(addon_host.sources(), target_is_directory=True)
    repos = bpy.context.preferences.extensions.repos
    repo = repos.new(name="Second", module="dapple_second", custom_directory=str(tmp_path))
    repo.use_custom_directory = repo.enabled = True
    name = "bl_ext.dapple_second.dapple"
    addon_utils.enable(name, default_set=True)
    yield name
    addon_utils.disable(name, default_set=True)
    repos.remove(repo)
    if not addon_utils.check(addon_host.MODULE)[1] or not hasattr(bpy.types.Object, "dapple"):
        addon_host.disable()
        addon_host.enable()


def test_a_second_enabled_copy_says_so_and_leaves_the_first_alone(second, capsys):
    copies = importlib.import_module(f"{second}.blender.duplicate_addon")
    assert copies.waits()
    assert copies.note() == (
        f"Another copy of Dapple is enabled ('{addon_host.MODULE}'). This one ('{second}') does "
        "nothing until it is disabled"
    )
    assert copies.check() > 0
    assert len(scenes.positions(scenes.scattered(scenes.sphere()))) == 60
    addon_utils.disable(second, default_set=True)
    assert not copies.waits()
    assert len(scenes.positions(scenes.scattered(scenes.sphere()))) == 60


def test_a_second_enabled_copy_works_when_the_first_is_disabled(second):
    copies = importlib.import_module(f"{second}.blender.duplicate_addon")
    addon_host.disable()
    assert not hasattr(bpy.types.Object, "dapple")
    assert copies.check() is None
    obj = scenes.scattered(scenes.sphere())
    assert type(obj.dapple).__module__.startswith(second)
    assert len(scenes.positions(obj)) == 60
    addon_host.enable()  # now the registration waits
    assert len(scenes.positions(scenes.scattered(scenes.sphere()))) == 60


OPENED = """
import bpy
import addon.blender as addon

addon.register()
bpy.ops.wm.read_factory_settings(use_empty=True)
addon.unregister()
print("done")
"""


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="Blender itself ends in another way")
@pytest.mark.skipif(bool(addon_host.TESTED_ZIP), reason="it is imported from the checkout")
def test_python_closes_after_a_file_was_opened(tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(addon_host.CHECKOUT.parent)}
    environment["BLENDER_USER_RESOURCES"] = str(tmp_path)
    done = subprocess.run(
        [sys.executable, "-c", OPENED],
        capture_output=True,
        text=True,
        env=environment,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "done" in done.stdout
