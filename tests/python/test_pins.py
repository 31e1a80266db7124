# SPDX-License-Identifier: GPL-3.0-or-later
"""Versions that decide a check are the same on every machine and every day."""

import datetime
import importlib.metadata
import re
import sys
from pathlib import Path

import pytest

packaging = pytest.importorskip("packaging.requirements")
canonical = pytest.importorskip("packaging.utils").canonicalize_name
SCRIPTS = Path(__file__).parents[2] / "scripts"
CONSTRAINTS = SCRIPTS / "constraints.txt"
PYTHONS = {"3.11": "3.11.2", "3.13": "3.13.5"}  # of Debian 12 and 13


def lines(path):
    """The requirements of a file."""
    found = (line.partition("#")[0].strip() for line in path.read_text().splitlines())
    return [packaging.Requirement(line) for line in found if line]


def pins(path, python):
    """Versions by the names of the packages, as they hold for a Python."""
    known = {"python_version": python, "python_full_version": PYTHONS[python]}
    held = [one for one in lines(path) if not one.marker or one.marker.evaluate(known)]
    return {canonical(one.name): str(one.specifier) for one in held}


@pytest.mark.parametrize("path", sorted(SCRIPTS.glob("requirements*.txt")), ids=lambda p: p.stem)
def test_no_requirement_takes_whatever_release_is_newest(path):
    for one in lines(path):
        assert re.fullmatch(r"==[0-9][\w.]*", str(one.specifier)), one


@pytest.mark.parametrize("python", PYTHONS)
def test_the_constraints_know_every_requirement(python):
    found = pins(CONSTRAINTS, python)
    for path in SCRIPTS.glob("requirements*.txt"):
        wanted = pins(path, python)
        assert wanted == {name: found.get(name) for name in wanted}, path.name


def test_both_pythons_have_one_numpy_and_one_blender():
    for name in ("numpy", "bpy"):
        assert len({pins(CONSTRAINTS, python)[name] for python in PYTHONS}) == 2


def test_the_constraints_name_the_day_they_are_of():
    day = re.match(r"# As of (\S+)\. Made by scripts/constraints.sh ", CONSTRAINTS.read_text())[1]
    assert datetime.date.fromisoformat(day) <= datetime.datetime.now(datetime.UTC).date()


@pytest.mark.skipif(
    Path(sys.prefix) != SCRIPTS.parent / "build" / "venv", reason="only build/venv is pinned"
)
def test_what_a_requirement_brings_is_pinned_too():
    """Whatever is in build/venv but what it was made with."""
    found = pins(CONSTRAINTS, "{}.{}".format(*sys.version_info))
    there = {canonical(one.name): f"=={one.version}" for one in importlib.metadata.distributions()}
    for name in ("pip", "setuptools", "dapple3d"):
        there.pop(name, None)
    assert there == {name: found.get(name) for name in there}


def test_what_installs_packages_is_reported_the_versions(root):
    """But where the versions are in the command, and no dependency comes along."""
    known = re.compile(r"-c |--no-deps|--no-index|uv==|pip_install\(\)")
    for path in [*root.glob("scripts/*.sh"), *root.glob("tests/*.sh"), *root.glob("*/*/run.sh")]:
        for line in path.read_text().replace("\\\n", "").splitlines():
            if re.search(r"pip\"? (install|download) ", line) and not line.startswith("#"):
                assert known.search(line), f"{path.name}: {line.strip()}"
