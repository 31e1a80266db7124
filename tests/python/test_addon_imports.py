# SPDX-License-Identifier: GPL-3.0-or-later
"""No module of the add-on needs so many names of the others that it cannot be read by itself.

What counts is what runs: each name that is imported from another module of the add-on, and of a
module that is imported as a whole each name that is used of it. Types that only annotate do not
count: they say what a value is, and are no work that is done elsewhere.
"""

import ast
from pathlib import Path

import pytest

ADDON = Path(__file__).resolve().parents[2] / "addon"
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
    """Names that a module imports from others of the add-on: (name, whether it is a module)."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            folder = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for one in node.names:
                whole = (folder / f"{one.name}.py").is_file() or (folder / one.name).is_dir()
                yield one.asname or one.name, whole


def needed(path):
    """The names that count."""
    uses = Uses()
    uses.visit(ast.parse(path.read_text()))
    for name, whole in imported(path):
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
