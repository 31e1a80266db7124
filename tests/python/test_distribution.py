# SPDX-License-Identifier: GPL-3.0-or-later
"""What a package index gets: the wheel, as `pip install .` builds it, and the sdist."""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from email.parser import Parser
from pathlib import Path
from zipfile import ZipFile

import dapple3d as dapple
import pytest

pytest.importorskip("build", reason="build is not installed")
pytest.importorskip("scikit_build_core", reason="scikit-build-core is not installed")

REQUIREMENTS = {
    "numpy>=1.26",
    'click; extra == "cli"',
    'DracoPy; extra == "draco"',
    'distributed; extra == "farm"',
    'rasterio; extra == "farm"',
    'zarr; extra == "farm"',
    'matplotlib; extra == "pictures"',
    'pillow; extra == "pictures"',
    'usd-core; extra == "usd"',
}


def run(*command: object, **variables: str) -> None:
    """Run a command that finds the programs beside this Python."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    found = subprocess.run(
        list(map(str, command)),
        capture_output=True,
        text=True,
        timeout=1200,
        env=os.environ | {"PATH": path} | variables,
        check=False,
    )
    assert found.returncode == 0, found.stdout + found.stderr


def made(kind: str, root: Path, folder: Path, *options: str) -> Path:
    """The sdist or the wheel of the folder root."""
    command = [sys.executable, "-m", "build", f"--{kind}", "--no-isolation", "--outdir", folder]
    run(*command, *options, root)
    (path,) = folder.iterdir()
    return path


def contents(folder: Path) -> dict[str, bytes]:
    """Files below a folder by their paths."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in files
        if "__pycache__" not in path.parts
    }


def check_metadata(text: str) -> None:
    found = Parser().parsestr(text)
    assert (found["Name"], found["Version"]) == ("dapple3d", dapple.__version__)
    assert found["License-Expression"] == "GPL-3.0-or-later"
    assert found["Requires-Python"] == ">=3.11"
    assert set(found.get_all("Requires-Dist")) == REQUIREMENTS
    assert found["Description-Content-Type"] == "text/markdown"
    assert "import dapple3d as dapple" in found.get_payload()


# What is in the sdist


def test_the_sdist_holds_all_that_is_built_and_nothing_else(root, tmp_path):
    archive = made("sdist", root, tmp_path / "sdist")
    assert archive.name == f"dapple3d-{dapple.__version__}.tar.gz"
    shutil.unpack_archive(archive, tmp_path)
    source = tmp_path / archive.name.removesuffix(".tar.gz")
    found = contents(source)
    check_metadata(found["PKG-INFO"].decode())
    for folder in ("cmake", "native", "packaging", "tests/native", "tests/consumer"):
        assert contents(source / folder) == contents(root / folder), folder
    assert {name.split("/")[0] for name in found} == {
        "CHANGELOG.md",
        "CMakeLists.txt",
        "CMakePresets.json",
        "LICENSE",
        "PKG-INFO",
        "benchmarks",
        "cmake",
        "native",
        "packaging",
        "pyproject.toml",
        "tests",
    }
    configured = ["-G", "Ninja", f"-DPython_EXECUTABLE={sys.executable}"]
    run("cmake", "-S", source, "-B", tmp_path / "build", *configured)
    run("cmake", "--build", tmp_path / "build", "--", "-n")  # fails where a source is missing


# What is in the wheel


@pytest.fixture
def built(root) -> Path:
    """The release build of this folder."""
    folder = Path(os.environ.get("DAPPLE_BUILD", root / "build" / "release")).resolve()
    cache = folder / "CMakeCache.txt"
    if not cache.is_file() or f"CMAKE_HOME_DIRECTORY:INTERNAL={root}\n" not in cache.read_text():
        pytest.skip(f"{folder} is no build of {root}")
    if not list(folder.glob("native/python/dapple3d/_native.*")):
        pytest.skip(f"no Python package in {folder}")
    return folder


@pytest.fixture
def copied(built, tmp_path) -> Path:
    """A copy of its library and package that can be configured anew."""
    folder = tmp_path / "release"
    shutil.copytree(built, folder, ignore=shutil.ignore_patterns("tests", "benchmarks"))
    cache = folder / "CMakeCache.txt"
    place = "CMAKE_CACHEFILE_DIR:INTERNAL="
    cache.write_text(cache.read_text().replace(f"{place}{built}\n", f"{place}{folder}\n"))
    return folder


def test_the_wheel_holds_what_the_set_up_installs(root, built, copied, tmp_path):
    # Precompiled headers are named by their folder, so that Ninja would compile all that is there a
    # second time: it only says so, and what is there is packed.
    as_built = [
        f"-Cbuild-dir={copied}",
        "-Ccmake.define.DAPPLE_WERROR=ON",
        "-Cbuild.tool-args=-n",
    ]
    wheel = made("wheel", root, tmp_path / "wheel", *as_built)
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    assert re.fullmatch(rf"dapple3d-[0-9.]+-{tag}-{tag}-\w+\.whl", wheel.name)
    with ZipFile(wheel) as files:
        files.extractall(tmp_path / "unpacked")
    info = tmp_path / "unpacked" / f"dapple3d-{dapple.__version__}.dist-info"
    check_metadata((info / "METADATA").read_text())
    assert (info / "entry_points.txt").read_text().split("\n")[:2] == [
        "[console_scripts]",
        "dapple = dapple3d.__main__:start",
    ]
    assert (info / "licenses" / "LICENSE").read_bytes() == (root / "LICENSE").read_bytes()

    run("cmake", "--install", built, "--component", "python", DESTDIR=str(tmp_path / "installed"))
    (module,) = (tmp_path / "installed").rglob("_native.*.so")
    found, expected = contents(tmp_path / "unpacked" / "dapple3d"), contents(module.parent)
    assert {"py.typed", "_native.pyi", "cli/commands/sample.py"} <= set(found)
    assert sorted(found) == sorted(expected)
    assert [name for name in found if found[name] != expected[name]] == []


def test_every_part_has_the_same_version(root):
    """CMakeLists.txt has it; files that other programs read repeat it."""
    manifest = tomllib.loads((root / "addon" / "blender_manifest.toml").read_text())
    port = json.loads((root / "packaging" / "vcpkg" / "dapple" / "vcpkg.json").read_text())
    recipe = (root / "packaging" / "conda" / "recipe.yaml").read_text()
    citation = (root / "CITATION.cff").read_text()
    repeated = {
        "Blender": manifest["version"],
        "vcpkg": port["version"],
        "conda": re.search(r'^  version: "(.*)"$', recipe, re.MULTILINE)[1],
        "citation": re.search(r"^version: (.*)$", citation, re.MULTILINE)[1],
    }
    assert repeated == dict.fromkeys(repeated, dapple.__version__)


def test_the_page_of_the_package_index_links_nothing_of_the_checkout(root):
    """There it has no folder beside it: what it shows or links must be found by an address."""
    page = (root / "native" / "python" / "README.md").read_text()
    targets = re.findall(r"\]\(([^)]+)\)|(?:src|href)=\"([^\"]+)\"", page)
    assert [one for pair in targets for one in pair if one and "://" not in one] == []
