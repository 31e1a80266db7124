# SPDX-License-Identifier: GPL-3.0-or-later
"""Wheels as each system builds them for itself: cibuildwheel with libraries that vcpkg makes."""

import importlib.util
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PORTS = ROOT / "packaging" / "wheels"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
SETTINGS = PROJECT["tool"]["cibuildwheel"]
WORKFLOW = (ROOT / ".github" / "workflows" / "wheels.yml").read_text()
PINS = "".join(path.read_text() for path in (ROOT / "scripts").glob("requirements*.txt"))
# Names of the workflow's systems in vcpkg, and the wheels of cibuildwheel.
SYSTEMS = {
    "ubuntu-24.04": ("x64-linux", "linux", "x86_64", "manylinux_x86_64"),
    "windows-2022": ("x64-windows", "windows", "AMD64", "win_amd64"),
    "macos-15": ("arm64-osx", "macos", "arm64", "macosx_arm64"),
    "macos-15-intel": ("x64-osx", "macos", "x86_64", "macosx_x86_64"),
}


def values(triplet: str) -> dict[str, str]:
    """What a triplet sets for every port."""
    text = (PORTS / "triplets" / f"{triplet}.cmake").read_text().partition("\nif")[0]
    return dict(re.findall(r"^set\(VCPKG_(\w+) (\S+)\)", text, re.MULTILINE))


def test_each_system_has_static_libraries_of_its_own():
    listed = re.search(r"system: \[(.*)\]", WORKFLOW)[1].split(", ")
    assert set(listed) == set(SYSTEMS)
    triplets = {path.stem for path in (PORTS / "triplets").glob("*.cmake")}
    assert triplets == {triplet for triplet, *_ in SYSTEMS.values()}
    for triplet in triplets:
        found = values(triplet)
        assert found["TARGET_ARCHITECTURE"] == triplet.partition("-")[0]
        assert (found["LIBRARY_LINKAGE"], found["BUILD_TYPE"]) == ("static", "release")


def test_libraries_and_module_want_the_same_macos():
    wanted = SETTINGS["macos"]["environment"]["MACOSX_DEPLOYMENT_TARGET"]
    assert {values(name)["OSX_DEPLOYMENT_TARGET"] for name in ("arm64-osx", "x64-osx")} == {wanted}


def test_the_ports_are_those_that_the_build_looks_for():
    """And pybind11, for the module; GMP and MPFR, which CGAL's port asks for, hold nothing."""
    manifest = json.loads((PORTS / "vcpkg.json").read_text())
    names = {one if isinstance(one, str) else one["name"] for one in manifest["dependencies"]}
    cmake = "".join(path.read_text() for path in (ROOT / "cmake").glob("dependencies.cmake"))
    cmake += (ROOT / "native" / "python" / "CMakeLists.txt").read_text()
    found = {name.lower() for name in re.findall(r"find_package\((\w+)", cmake)}
    assert names == found - {"python"}
    empty = {path.parent.name for path in PORTS.glob("ports/*/portfile.cmake")}
    assert empty == {"gmp", "mpfr"}
    for folder in manifest["vcpkg-configuration"].values():
        assert all((PORTS / name).is_dir() for name in folder)


def test_the_toolchain_hands_the_ports_to_vcpkg(tmp_path):
    """Here one that says what it got."""
    script = tmp_path / "scripts" / "buildsystems" / "vcpkg.cmake"
    script.parent.mkdir(parents=True)
    names = ["VCPKG_MANIFEST_DIR", "VCPKG_INSTALLED_DIR", "CGAL_DISABLE_GMP"]
    script.write_text("".join(f'message("${{{name}}}")\n' for name in names))
    toolchain = ROOT / SETTINGS["config-settings"]["cmake.toolchain-file"]
    found = subprocess.run(
        ["cmake", "-P", toolchain],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"VCPKG_ROOT": str(tmp_path)},
    )
    assert found.stderr.split() == [str(PORTS), str(ROOT / "build" / "vcpkg-installed"), "ON"]
    assert "path: build/vcpkg\n" in WORKFLOW  # the default path


def test_a_wheel_is_tested_with_all_that_the_tests_need():
    spec = importlib.util.spec_from_file_location("wheel", ROOT / "tests" / "wheel.py")
    wheel = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(wheel)
    extras = PROJECT["project"]["optional-dependencies"]
    brought = [*PROJECT["project"]["dependencies"], *SETTINGS["test-requires"]]
    brought += [one for name in SETTINGS["test-extras"] for one in extras[name]]
    assert {re.match(r"[\w-]+", one)[0] for one in brought} == set(wheel.NEEDED)
    assert SETTINGS["before-test"] == "python {project}/tests/wheel.py --needs"
    assert SETTINGS["test-command"] == "python {project}/tests/wheel.py"


def test_pythons_are_those_of_blender():
    blenders = re.findall(r'^bpy==.*python_version == "3\.(\d+)"', PINS, re.MULTILINE)
    assert SETTINGS["build"] == [f"cp3{minor}-*" for minor in blenders]


@pytest.mark.parametrize("system", SYSTEMS)
def test_cibuildwheel_takes_the_settings(system):
    pytest.importorskip("cibuildwheel", reason="cibuildwheel is not installed")
    _, platform, processor, tag = SYSTEMS[system]
    command = [sys.executable, "-m", "cibuildwheel", "--print-build-identifiers"]
    command += ["--platform", platform, "--archs", processor, str(ROOT)]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
    assert found.stdout.split() == [f"{build[:-2]}-{tag}" for build in SETTINGS["build"]]


def test_the_workflow_runs_the_cibuildwheel_that_was_asked():
    assert re.findall(r"cibuildwheel==\S+", WORKFLOW) == re.findall(r"cibuildwheel==\S+", PINS)


# Versions of libraries


@pytest.fixture
def libraries(tmp_path) -> Path:
    """A prefix with packages that hold nothing."""
    for name in ("CGAL", "Eigen3", "OpenMesh", "TBB", "embree", "nanoflann"):
        folder = tmp_path / "lib" / "cmake" / name
        folder.mkdir(parents=True)
        (folder / f"{name}Config.cmake").write_text("")
    any_version = "set(PACKAGE_VERSION 4.4.0)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n"
    (tmp_path / "lib/cmake/embree/embreeConfigVersion.cmake").write_text(any_version)
    return tmp_path


@pytest.mark.parametrize("version", ["3.3.9", "3.4.0", "5.0.1"])
def test_eigen_may_be_of_a_newer_major(libraries, version):
    """Whose package refuses whoever names another one: 3.4 was followed by 5.0."""
    (libraries / "lib/cmake/Eigen3/Eigen3ConfigVersion.cmake").write_text(
        f"set(PACKAGE_VERSION {version})\n"
        'if(PACKAGE_FIND_VERSION_COUNT EQUAL 0 OR "${PACKAGE_FIND_VERSION_MAJOR}" '
        f"EQUAL {version[0]})\n  set(PACKAGE_VERSION_COMPATIBLE TRUE)\nendif()\n"
    )
    alone = ["CMAKE_SYSTEM_PATH", "SYSTEM_ENVIRONMENT_PATH", "CMAKE_ENVIRONMENT_PATH"]
    options = [f"-DCMAKE_FIND_USE_{name}=OFF" for name in alone]
    script = ROOT / "cmake" / "dependencies.cmake"
    command = ["cmake", f"-DCMAKE_PREFIX_PATH={libraries}", *options, "-P", script]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (found.returncode == 0) == (version != "3.3.9"), found.stderr
    assert ("Eigen 3.3.9 is older than 3.4" in found.stderr) == (version == "3.3.9")
