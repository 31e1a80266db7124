# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's folders are in an order, without circles, and Blender stays at their edge.

The folders and their order are the table in docs/development/addon.md.
"""

import ast
import graphlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon"
PAGE = ROOT / "docs/development/addon.md"
MODULES = sorted(ADDON.rglob("*.py"))
BLENDERS = {"bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "bpy_extras", "blf", "addon_utils"}


def name_of(path):
    return path.relative_to(ADDON).as_posix()


def imported(path):
    """The modules of the add-on that a module imports, or imports names from."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            source = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for one in node.names:
                yield next(filter(Path.is_file, places(source, one.name)))


def places(source, name):
    """Where a name of a module or a folder may be."""
    inside = source / name
    yield from (inside.with_suffix(".py"), inside / "__init__.py")
    yield from (source.with_suffix(".py"), source / "__init__.py")


def roots_of(path):
    """The packages outside of the add-on that a module imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (one.name.split(".")[0] for one in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module.split(".")[0]


def folders():
    """The folders of the page, in order; modules in `blender` and above stand below all."""
    text = PAGE.read_text(encoding="utf-8")
    table = text.split("## The add-on's folders")[1].split("\n## ")[0]
    return [*re.findall(r"^\| `([a-z_/]+)` \|", table, re.MULTILINE), "blender", "."]


def rank(path):
    return folders().index(path.parent.relative_to(ADDON).as_posix())


def test_the_page_lists_every_folder_once():
    there = {path.parent.relative_to(ADDON).as_posix() for path in MODULES}
    assert sorted(folders()) == sorted(there)


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_only_folders_above_are_imported(path):
    below = {name_of(source) for source in imported(path) if rank(source) > rank(path)}
    assert not below, f"{name_of(path)} imports from folders below its own: {below}"


def test_no_modules_import_each_other():
    graph = {path: set(imported(path)) - {path} for path in MODULES}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        pytest.fail(" <- ".join(map(name_of, error.args[1])))


def test_the_core_knows_no_blender():
    core = [path for path in MODULES if path.is_relative_to(ADDON / "core")]
    assert len(core) > 30
    assert not {name_of(path) for path in core if BLENDERS & set(roots_of(path))}


def test_the_page_says_where_things_are():
    """Files of the list exist, and each question is answered by one."""
    text = PAGE.read_text(encoding="utf-8").split("## Where is ...")[1].split("\n## ")[0]
    rows = re.findall(r"^\| ([^|`]+) \| `([\w/.]+)`", text, re.MULTILINE)
    assert len(rows) >= 15
    assert not [place for _, place in rows if not (ADDON / place).is_file()]
