# SPDX-License-Identifier: GPL-3.0-or-later
"""The native part of the package as Python that Sphinx can read: stubs with documentation.

A native function has no annotations, and no source from which an order could be read. Its stub has
both but no documentation; that is in the module itself.
"""

from __future__ import annotations

import ast
import inspect
from pathlib import Path
from types import ModuleType
from typing import Any

ALIASES = ("ArrayLike", "NDArray")
Documented = ast.ClassDef | ast.FunctionDef


def documentation(thing: Any) -> str:
    """What a native object says of itself, without the signature that pybind11 puts first."""
    text = inspect.getdoc(thing) or ""
    first, _, rest = text.partition("\n")
    return rest.strip() if "->" in first and "(" in first else text


def document(node: Documented, thing: Any) -> None:
    """Puts the documentation of a native object into its stub, and so for what is in it."""
    for child in node.body:
        if isinstance(child, Documented) and not child.name.startswith("_"):
            document(child, vars(thing)[child.name])
    if text := documentation(thing):
        node.body.insert(0, ast.Expr(ast.Constant(text)))


def without_overloads(tree: ast.Module) -> None:
    """Leaves the first signature of each function, whose documentation has the others."""
    seen: set[str] = set()
    for node in list(tree.body):
        if not isinstance(node, ast.FunctionDef):
            continue
        if node.name in seen:
            tree.body.remove(node)
        seen.add(node.name)
        node.decorator_list = []


def documented_stubs(native: ModuleType, stubs: str) -> str:
    """The stubs of a module, with the documentation that the module has."""
    tree = ast.parse(stubs)
    without_overloads(tree)
    for node in tree.body:
        if isinstance(node, Documented):
            document(node, getattr(native, node.name))
    return ast.unparse(tree)


def defer(module: ModuleType) -> None:
    """Runs a module anew so that its annotations stay text, as written.

    Sphinx would else write numpy's aliases as lines of unions. What it cannot look up it takes as
    text, so the aliases go.
    """
    path = Path(str(module.__file__))
    code = compile(path.read_text(encoding="utf-8"), path, "exec", annotations.compiler_flag)
    exec(code, vars(module))
    for alias in ALIASES:
        vars(module).pop(alias, None)


def forget_line(thing: Any) -> None:
    """Since Python 3.13 a class knows its line: that of the stubs, not of the package's file."""
    if inspect.isclass(thing) and "__firstlineno__" in vars(thing):
        type.__delattr__(thing, "__firstlineno__")


def overlay(package: ModuleType, stubs: str) -> str:
    """Puts the documented stubs where the package has the native objects; returns their code.

    Other modules of the package name native types too, which are to be found in the package itself.
    """
    native = package._native
    code = "from __future__ import annotations\n" + documented_stubs(native, stubs)
    for thing in vars(native).values():
        if inspect.isclass(thing):
            thing.__module__ = package.__name__
    version = vars(package)["__version__"]
    exec(compile(code, "<stubs>", "exec"), vars(package))
    vars(package)["__version__"] = version
    for alias in ALIASES:
        del vars(package)[alias]
    for name in package.__all__:
        forget_line(vars(package)[name])
    return code
