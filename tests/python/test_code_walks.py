# SPDX-License-Identifier: GPL-3.0-or-later
"""The walks through the code lead through files and functions that exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/development/walks.md"
FOLDERS = (
    "",
    "native/src",
    "native/include",
    "addon/blender",
    "addon",
    "native/python",
    "native/python/dapple3d",
)
FILE = re.compile(r"`([\w/]+\.(?:[ch]pp|py))`")
NAME = re.compile(r"`(?:\w+(?:::|\.))?(\w+)(?:\(\))?`")


def steps() -> list[str]:
    """The numbered steps, each on one line."""
    joined = re.sub(r"\n   +", " ", PAGE.read_text(encoding="utf-8"))
    return re.findall(r"^\d+\. (.*)$", joined, re.MULTILINE)


def found(name: str) -> Path:
    """The file that a walk calls by this name."""
    places = [ROOT / folder / name for folder in FOLDERS]
    there = [place for place in places if place.is_file()]
    assert there, f"{PAGE.name} names {name}, which does not exist"
    return there[0]


@pytest.mark.parametrize("step", steps())
def test_a_step_names_files_and_functions_that_exist(step):
    sources = [found(name).read_text(encoding="utf-8") for name in FILE.findall(step)]
    text = "".join(sources)
    names = [name for name in NAME.findall(FILE.sub("", step)) if sources]
    missing = [name for name in names if not re.search(rf"\b{name}\b", text)]
    assert not missing, f"not in the files of this step: {missing}"


def test_there_are_walks():
    assert len(re.findall(r"^## From ", PAGE.read_text(encoding="utf-8"), re.MULTILINE)) >= 4
    assert len(steps()) > 25


def test_a_sample_reaches_the_clip_in_few_steps():
    page = PAGE.read_text(encoding="utf-8")
    first = page.split("\n## From ")[1]
    assert len(re.findall(r"^\d+\. ", first, re.MULTILINE)) <= 7
