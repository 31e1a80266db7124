# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip that ships, installed into a Blender that has nothing else of Dapple's."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from zipfile import ZipFile

import addon_host
import bpy
import child
import nodes_text
import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("DAPPLE_BUILD", ROOT / "build" / "release"))
HAS_BUILD = bool(list(BUILD.glob("native/python/dapple3d/_native.*")))
TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"

needs_bpy_module = pytest.mark.skipif(
    bool(bpy.app.binary_path) or sys.platform != "linux",
    reason="needs Linux and bpy as a module of Python",
)
needs_build = pytest.mark.skipif(not HAS_BUILD, reason=f"no Python package in {BUILD}")

INSTALL = """
import scenes
bpy.ops.preferences.addon_enable(module="bl_pkg")
bpy.ops.extensions.package_install_files(
    filepath=arguments[0], repo="user_default", enable_on_install=True
)
import dapple3d as dapple
from pathlib import Path
extensions = Path(os.environ["BLENDER_USER_RESOURCES"], "extensions")
assert Path(dapple.__file__).is_relative_to(extensions / ".local"), dapple.__file__
"""

BAKE = (
    INSTALL
    + """
bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
bpy.context.scene.frame_start = 1
obj = scenes.scattered(scenes.tail(frames=2), count=60)
assert bpy.ops.dapple.bake() == {"FINISHED"}
print(len(scenes.positions(obj)), "points,", obj.dapple.baked_keys, "frames")
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.dapple")
assert not hasattr(bpy.types.Object, "dapple")
"""
)

UNINSTALL = (
    INSTALL
    + """
bpy.ops.extensions.package_install_files(
    filepath=arguments[0], repo="user_default", enable_on_install=True
)
assert len(scenes.positions(scenes.scattered(scenes.sphere()))) == 60
repositories = [repo.module for repo in bpy.context.preferences.extensions.repos]
index = repositories.index("user_default")
bpy.ops.extensions.package_uninstall(repo_index=index, pkg_id="dapple")
print("left:", [str(path) for path in extensions.rglob("dapple*")])
"""
)

LOADED = (
    INSTALL
    + """
bundled = ("libtbb", "libgmp", "libOpenMesh", "libdapple_embree", "libembree")
mapped = {line.split(maxsplit=5)[5].strip() for line in open("/proc/self/maps") if "/lib" in line}
blender = Path(bpy.utils.resource_path("LOCAL")).resolve().parent
for path in sorted(path for path in mapped if Path(path).name.startswith(bundled)):
    if not Path(path).is_relative_to(blender):
        print("loaded", Path(path).relative_to(extensions))
"""
)

PRELOADED = (
    INSTALL
    + """
import ctypes, hashlib
import numpy as np
print("there" if hasattr(ctypes.CDLL(None), "rtcPointQuery") else "away")
steps = np.arange(12) * (np.pi / 6)
ring = np.column_stack([np.cos(steps), np.sin(steps), np.zeros(12)])
rows = [ring + [0, 0, 0.5 * row] for row in range(4)]
i = np.arange(12)
j = (i + 1) % 12
faces = [np.column_stack([12 * r + i, 12 * r + j, 12 * r + 12 + j]) for r in range(3)]
faces += [np.column_stack([12 * r + i, 12 * r + 12 + j, 12 * r + 12 + i]) for r in range(3)]
samples = dapple.sample(dapple.Surface(np.vstack(rows), np.vstack(faces)), 200, seed=1)
print(hashlib.sha256(samples.positions.tobytes()).hexdigest())
"""
)


def package(folder, *options):
    """Run scripts/package.sh for this build."""
    script = [ROOT / "scripts" / "package.sh", "--build", BUILD, "--to", folder, *options]
    return subprocess.run(script, capture_output=True, text=True, timeout=300)


def built(folder, *options):
    """The zip that scripts/package.sh makes."""
    done = package(folder, *options)
    assert done.returncode == 0, done.stdout + done.stderr
    (archive,) = folder.glob("*.zip")
    return archive


def wheels_of(archive):
    with ZipFile(archive) as files:
        return [name for name in files.namelist() if name.startswith("wheels/")]


def files_of_wheel(archive):
    """Files of the wheel for this Python."""
    (name,) = (name for name in wheels_of(archive) if f"-{TAG}-" in name)
    with ZipFile(archive) as files, files.open(name) as file, ZipFile(file) as inner:
        return [Path(name) for name in inner.namelist()]


@pytest.fixture(scope="session")
def archive(tmp_path_factory):
    made = addon_host.TESTED_ZIP or os.environ.get("DAPPLE_BUILT_ZIP")
    if made:
        return Path(made)
    if not HAS_BUILD:
        pytest.skip(f"no Python package in {BUILD}")
    return built(tmp_path_factory.mktemp("package"))


def test_the_manifest_differs_from_the_sources_by_platform_and_wheel(archive):
    with ZipFile(archive) as files:
        shipped = tomllib.loads(files.read("blender_manifest.toml").decode())
    wheels = [f"./{name}" for name in wheels_of(archive)]
    platform = {"platforms": ["linux-x64"], "wheels": wheels}
    source = tomllib.loads((ROOT / "addon" / "blender_manifest.toml").read_text())
    assert len({name.split("-")[2] for name in wheels}) == len(wheels)
    assert shipped == source | platform
    assert archive.name == f"dapple-{source['version']}-linux-x64.zip"


def test_it_is_small_and_brings_the_licenses_of_what_is_bundled(archive):
    assert archive.stat().st_size < 30e6
    with ZipFile(archive) as files:
        assert "LICENSE" in files.namelist()
        assert "CC0 1.0 Universal" in files.read("assets/LICENSE-CC0.txt").decode()
    names = {path.name for path in files_of_wheel(archive) if path.parent.name == "licenses"}
    assert "LICENSE" in names
    for library in ("cgal", "embree", "tbb", "openmesh"):
        assert [name for name in names if library in name]


def test_it_brings_the_node_groups_as_assets_with_their_catalog(archive, tmp_path):
    with ZipFile(archive) as files:
        for name in ("blender_assets.cats.txt", "dapple_nodes.blend"):
            files.extract(f"assets/{name}", tmp_path)
    source = ROOT / "addon" / "assets" / "blender_assets.cats.txt"
    shipped = tmp_path / "assets"
    assert (shipped / source.name).read_bytes() == source.read_bytes()
    path = str(shipped / "dapple_nodes.blend")
    with bpy.data.libraries.load(path, assets_only=True) as (found, wanted):
        names = list(found.node_groups)
        wanted.node_groups = list(names)
    assets = dict(zip(names, wanted.node_groups, strict=True))
    described = addon_host.part("nodes.assets").ASSETS
    assert sorted(assets) == sorted(asset.name for asset in described)
    found = {name: nodes_text.dump(group) for name, group in assets.items()}
    assert found == nodes_text.built()


@needs_build
def test_the_same_build_gives_the_same_bytes(archive, tmp_path):
    assert built(tmp_path).read_bytes() == archive.read_bytes()


@needs_build
@needs_bpy_module
def test_of_wheels_for_several_pythons_blender_takes_its_own(archive, tmp_path):
    (name,) = wheels_of(archive)
    with ZipFile(archive) as files:
        wheel = Path(files.extract(name, tmp_path))
    older, newer = (wheel.with_name(wheel.name.replace(TAG, other)) for other in ("cp310", "cp399"))
    for other in (older, newer):
        with ZipFile(other, "w") as files:
            files.writestr("dapple3d/__init__.py", "raise RuntimeError('the wrong wheel')")
    both = built(tmp_path, "--wheel", older, "--wheel", newer)
    assert {Path(name).name for name in wheels_of(both)} == {
        path.name for path in (wheel, older, newer)
    }
    assert "60 points, 2 frames" in child.bare(BAKE, both)
    refused = package(tmp_path, "--wheel", wheel)
    assert refused.returncode == 1
    assert f"{wheel.name}: there is another wheel for {TAG}" in refused.stderr


def test_a_blender_without_the_package_scatters_and_bakes_once_it_is_installed(archive):
    assert "60 points, 2 frames" in child.bare(BAKE, archive)


@pytest.mark.skipif(not bpy.app.binary_path, reason="needs a Blender executable")
def test_a_virtual_environment_on_the_path_is_not_blenders(archive, tmp_path, monkeypatch):
    """With build/venv on the path the package of the checkout hid the one that is installed."""
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    packages = tmp_path / "lib" / version / "site-packages"
    packages.mkdir(parents=True)
    (packages / "dapple3d.py").write_text("raise RuntimeError('of the virtual environment')")
    (tmp_path / "pyvenv.cfg").write_text("home = /usr/bin\n")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python3").symlink_to("/usr/bin/python3")
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=os.pathsep)
    assert "60 points, 2 frames" in child.bare(BAKE, archive)


def test_installed_twice_it_works_and_uninstalled_it_leaves_nothing(archive):
    assert "left: []" in child.bare(UNINSTALL, archive)


@needs_bpy_module
def test_no_library_of_the_system_is_used_that_users_may_lack(archive):
    said = child.bare(LOADED, archive)
    names = {Path(line).name for line in said.splitlines() if line.startswith("loaded")}
    beside = {path.name for path in files_of_wheel(archive) if re.match(r"lib.*\.so", path.name)}
    assert names == beside


@needs_bpy_module
def test_blenders_own_embree_and_tbb_change_nothing(archive):
    lib = Path(bpy.utils.resource_path("LOCAL")).parent / "lib"
    preload = f"{lib}/libembree4.so.4 {lib}/libtbb.so.12"
    alone = child.bare(PRELOADED, archive).split()[-2:]
    beside = child.bare(PRELOADED, archive, LD_PRELOAD=preload).split()[-2:]
    assert (alone[0], beside[0]) == ("away", "there")
    assert alone[1] == beside[1]
