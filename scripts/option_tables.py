#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes what the tables of options in the C++ headers say into files.

These are the arguments in the package's type stubs, and docs/options.md. Needs the package, built
from this source.

  scripts/option_tables.py [--write]

Without --write it names the files that are to be written again, and fails if there are any.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from dapple3d import Option

ROOT = Path(__file__).resolve().parent.parent
STUBS = "native/python/dapple3d/_native.pyi"
PAGE = "docs/options.md"
HEAD = """# Options

What the functions of the package take by name, as `dapple3d.option_table` returns it; the command
line has flags of the same names. Where a function has a default of its own, it stands beside.
`scripts/option_tables.py --write` makes this page from the C++ headers.

"""

Tables = Mapping[str, Sequence["Option"]]  # by the name of the function or class


def tables() -> Tables:
    """Those of the package as it is installed."""
    import dapple3d

    return {verb: dapple3d.option_table(verb) for verb in dapple3d._native._verbs}


def written(root: Path, made_of: Tables) -> dict[Path, str]:
    """The files as they are to be."""
    stubs = root / STUBS
    return {
        stubs: with_options(stubs.read_text(encoding="utf-8"), made_of),
        root / PAGE: page(made_of),
    }


def stale(files: Mapping[Path, str]) -> list[Path]:
    """Those that are not as they are to be."""
    return [path for path, text in files.items() if not path.is_file() or _text(path) != text]


def _text(path: Path) -> str:
    return path.read_text(encoding="utf-8")


# Stubs


def with_options(text: str, made_of: Tables) -> str:
    """Stubs in which each function takes its options, before what else it takes by name."""
    lines = text.splitlines(keepends=True)
    for node, verb in reversed(list(functions(ast.parse(text), made_of))):
        lines[node.lineno - 1 : node.end_lineno] = definition(text, node, made_of[verb])
    return "".join(lines)


def functions(tree: ast.Module, made_of: Tables) -> Iterable[tuple[ast.FunctionDef, str]]:
    """The functions that take options, and the constructors of classes that do."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name in made_of:
            yield node, node.name
        if isinstance(node, ast.ClassDef) and node.name in made_of:
            for member in node.body:
                if isinstance(member, ast.FunctionDef) and member.name == "__init__":
                    yield member, node.name


def definition(text: str, node: ast.FunctionDef, options: Sequence[Option]) -> list[str]:
    """The lines of a function with these options; arguments of other names stay."""

    def source(part: ast.AST | None) -> str:
        return (part and ast.get_source_segment(text, part)) or ""

    def argument(arg: ast.arg, default: ast.expr | None) -> str:
        return source(arg) + (f" = {source(default)}" if default else "")

    known = {option.name for option in options}
    named = zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
    others = [argument(arg, default) for arg, default in named if arg.arg not in known]
    arguments = [*(source(arg) for arg in node.args.args), "*", *map(keyword, options), *others]
    indent = " " * node.col_offset
    return [
        f"{indent}def {node.name}(\n",
        *(f"{indent}    {one},\n" for one in arguments),
        f"{indent}) -> {source(node.returns)}: ...\n",
    ]


def keyword(option: Option) -> str:
    """An option as an argument."""
    words = ", ".join(f'"{choice}"' for choice in option.choices)
    kind = f"Literal[{words}]" if words else option.type
    default = f'"{option.default}"' if words else repr(option.default)
    return f"{option.name}: {kind} = {default}"


# The page


class Meaning(NamedTuple):
    """What options of one name have in common."""

    name: str
    range: str
    unit: str
    documentation: str
    changes_solution: bool


def page(made_of: Tables) -> str:
    """A table of all options, one line for those that mean the same."""
    found: dict[Meaning, dict[str, Any]] = {}
    for verb, options in made_of.items():
        for o in options:
            key = Meaning(o.name, o.range, o.unit, o.documentation, o.changes_solution)
            found.setdefault(key, {})[verb] = o.default
    head = [
        "| option | default | range | unit | meaning | functions |",
        "|---|---|---|---|---|---|",
    ]
    return HEAD + "\n".join([*head, *(row(*one) for one in found.items())]) + "\n"


def row(meaning: Meaning, defaults: Mapping[str, Any]) -> str:
    """A line of the table."""
    values = list(defaults.values())
    usual = max(values, key=values.count)
    others = [f"`{verb}`: {_code(value)}" for verb, value in defaults.items() if value != usual]
    cells = (
        f"`{meaning.name}`",
        "; ".join([_code(usual), *others]),
        meaning.range.replace("'", "`"),
        meaning.unit,
        meaning.documentation,
        ", ".join(f"`{verb}`" for verb in defaults),
    )
    return "| " + " | ".join(cells) + " |"


def _code(value: Any) -> str:
    return f"`{value}`"


def main(arguments: Sequence[str]) -> int:
    """The exit code."""
    if not set(arguments) <= {"--write"}:
        print(__doc__)
        return 2
    files = written(ROOT, tables())
    for path in stale(files):
        print(path.relative_to(ROOT))
        if "--write" in arguments:
            path.write_text(files[path], encoding="utf-8")
    return 0 if "--write" in arguments or not stale(files) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
