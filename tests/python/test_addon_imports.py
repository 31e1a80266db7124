# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules of the add-on import only from rooms above their own, and few names.

The rooms and their order are the table in CONTRIBUTING.md. No module needs so many names of others
that it cannot be read by itself. What counts is what runs: each name that is imported from another
module of the add-on, and of a module that is imported as a whole each name that is used of it.
Types that only annotate do not count: they say what a value is, and are no work done elsewhere.
"""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon"
MODULES = sorted(ADDON.rglob("*.py"))
MOST = 20


class Uses(ast.NodeVisitor):
    """Names that a module uses when it runs, and what it uses of names: (name, attribute)."""

    def __init__(self):
        self.names, self.attributes = set(), set()

    def visit_Name(self, node):
        self.names.add(node.id)

    def visit_Attribute(self, node):
        if isinstance(node.value, ast.Name):
            self.attributes.add((node.value.id, node.attr))
        self.generic_visit(node)

    def visit_arg(self, node):
        """Its annotation does not run."""

    def visit_AnnAssign(self, node):
        for part in filter(None, (node.target, node.value)):
            self.visit(part)

    def visit_FunctionDef(self, node):
        for part in (*node.decorator_list, node.args, *node.body):
            self.visit(part)


def imported(path):
    """What a module imports from others of the add-on: (name, its module, whether it is that)."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            source = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for one in node.names:
                inside = source / one.name
                whole = inside.with_suffix(".py").is_file() or inside.is_dir()
                yield one.asname or one.name, inside if whole else source, whole


def needed(path):
    """The names that count."""
    uses = Uses()
    uses.visit(ast.parse(path.read_text()))
    for name, _, whole in imported(path):
        if whole:
            yield from (f"{name}.{used}" for owner, used in uses.attributes if owner == name)
        elif name in uses.names or path.name == "__init__.py":
            yield name


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ADDON)))
def test_few_names_of_other_modules_are_needed(path):
    names = sorted(set(needed(path)))
    assert len(names) <= MOST, f"{path.relative_to(ADDON)} needs {len(names)}: {', '.join(names)}"


def test_names_are_counted(tmp_path):
    for name in ("one", "two"):
        (tmp_path / f"{name}.py").write_text("")
    (tmp_path / "reads.py").write_text(
        "import json\n"
        "from . import two\n"
        "from .one import First, second, third as other\n"
        "def does(value: First) -> two.Type:\n"
        "    return two.does(second(other, json.loads(value))) + two.does(two.CONSTANT)\n"
    )
    found = set(needed(tmp_path / "reads.py"))
    assert found == {"second", "other", "two.does", "two.CONSTANT"}


def rooms():
    """Those of CONTRIBUTING.md, in order."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
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
        str(source.relative_to(ADDON))
        for _, source, _ in imported(path)
        if room_of(source, listed) > own
    }
    assert not below, f"{path.relative_to(ADDON)} imports from rooms below its own: {below}"
