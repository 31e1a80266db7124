# SPDX-License-Identifier: GPL-3.0-or-later
"""The tests of the add-on use what it offers: none reads or writes private state."""

import ast
from pathlib import Path

import pytest

TESTS = sorted((Path(__file__).resolve().parents[1] / "blender").rglob("*.py"))
OTHERS = {  # private names of other packages, which offer nothing else
    "_actions",
    "_asdict",
    "_dyn_ui_initialize",
    "_exit",
    "_exitfuncs",
    "_group_actions",
    "_run_exitfuncs",
    "_subparsers",
    "_tools",
}


def private_names(path):
    """Private attributes by line, but for those of a class of the test itself."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    classes = [node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    inside = {id(node) for one in classes for node in ast.walk(one)}
    for node in ast.walk(tree):
        if not isinstance(node, ast.Attribute) or not node.attr.startswith("_"):
            continue
        named = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
        own = named and id(node) in inside
        if not own and not node.attr.startswith("__") and node.attr not in OTHERS:
            yield f"{path.name}:{node.lineno}: {node.attr}"


@pytest.mark.parametrize("path", TESTS, ids=lambda path: path.stem)
def test_no_test_reaches_into_private_state(path):
    assert not list(private_names(path))
