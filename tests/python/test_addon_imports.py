# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules of the add-on import only from rooms above their own.

The rooms and their order are the table in docs/development/addon.md.
"""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon"
MODULES = sorted(ADDON.rglob("*.py"))


def imported(path):
    """The modules of the add-on that a module imports names from."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            source = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for one in node.names:
                inside = source / one.name
                whole = inside.with_suffix(".py").is_file() or inside.is_dir()
                yield inside if whole else source


def rooms():
    """The rooms of the page, in order."""
    text = (ROOT / "docs/development/addon.md").read_text(encoding="utf-8")
    table = text.split("## The add-on's rooms")[1].split("\n## ")[0]
    return re.findall(r"^\| `([a-z/]+)` \|", table, re.MULTILINE)


def room_of(path, listed):
    """Index of a module's room; modules of no room stand below all of them."""
    folders = [
        str(folder.relative_to(ADDON))
        for folder in (path, *path.parents[:-1])
        if folder.is_relative_to(ADDON)
    ]
    return next((listed.index(name) for name in folders if name in listed), len(listed))


def test_every_folder_with_modules_is_a_room():
    folders = {path.parent.relative_to(ADDON).as_posix() for path in MODULES}
    assert folders - {".", "blender"} == set(rooms())


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ADDON)))
def test_only_rooms_above_are_imported(path):
    listed = rooms()
    own = room_of(path, listed)
    below = {
        str(source.relative_to(ADDON)) for source in imported(path) if room_of(source, listed) > own
    }
    assert not below, f"{path.relative_to(ADDON)} imports from rooms below its own: {below}"
