#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the add-on's tables of settings (addon/core/settings/tables.py) into docs/add-on.md, and
the types of their values for mypy into addon/core/settings/fields.pyi and scripts/types/bpy.

Needs the package, whose options are settings too.

  scripts/setting_tables.py [--write]

Without --write it names the files that differ, and fails if there are any.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from addon.core.settings.descriptors import Changes, Kind, Setting  # noqa: E402 - the path is set first
from addon.core.settings.fields import TABLES  # noqa: E402
from addon.core.settings.instance_table import INSTANCES  # noqa: E402
from addon.core.settings.solver_options import MOTION, SAMPLE, has_own_words  # noqa: E402
from addon.core.settings.tables import GROUPS  # noqa: E402

PAGE = ROOT / "docs/add-on.md"
TYPES = ROOT / "addon/core/settings/fields.pyi"
BPY_TYPES = ROOT / "scripts/types/bpy/types.pyi"
PROPERTIES = tuple(
    ROOT / f"addon/blender/settings/{name}.py"
    for name in ("declarations", "property_groups", "properties")
)
BEGIN, END = "<!-- tables of settings -->\n", "<!-- end of the tables -->\n"
HEAD = [
    "| property | label | default | range | changes | meaning |",
    "|---|---|---|---|---|---|",
]
PREFIXES = {
    "": "`scatter.dapple.`",
    "density": "`scatter.dapple.density.`",
    "tiles": "`scatter.dapple.tiles.`",
    "object_types": "`scatter.dapple.object_types[k].`, an object type, beside those of its "
    "instances",
}
CHANGES = {
    Changes.NOTHING: "",
    Changes.INSTANCES: "instances",
    Changes.SOLUTION: "solution",
    Changes.BAKE: "bake",
    Changes.INDIRECTLY: "solution",
}
DATA = {
    Kind.OBJECT: "an object",
    Kind.SURFACE: "an object",
    Kind.IMAGE: "an image",
    Kind.COLLECTION: "a collection",
    Kind.MATERIALS: "materials",
}


def written(text: str) -> str:
    """The page as it is to be."""
    found = re.compile(f"(?<={re.escape(BEGIN)}).*?(?={re.escape(END)})", re.DOTALL)
    return found.sub(lambda _: tables(), text, count=1)


def tables() -> str:
    """One for each group. Options that have no words of the add-on are in docs/options.md alone."""
    options = {one.name for one in (*SAMPLE, *MOTION) if not has_own_words(one)}
    instances = {one.name for one in INSTANCES}
    parts = []
    for group, prefix in PREFIXES.items():
        left_out = instances if group == "object_types" else options
        settings = [one for one in GROUPS[group] if one.name not in left_out]
        parts.append(f"\n{prefix}\n\n{table(settings)}")
    return "".join(parts) + "\n"


def table(settings: Iterable[Setting]) -> str:
    return "\n".join([*HEAD, *map(row, settings)]) + "\n"


def row(setting: Setting) -> str:
    cells = (
        f"`{setting.name}`",
        setting.label,
        _default(setting),
        _range(setting),
        CHANGES[setting.changes],
        f"{setting.tooltip}.",
    )
    return "| " + " | ".join(cells) + " |"


def _default(setting: Setting) -> str:
    return "" if setting.default in ("", ()) else f"`{setting.default}`"


def _range(setting: Setting) -> str:
    if setting.kind in DATA:
        return DATA[setting.kind]
    if setting.choices:
        return ", ".join(f"`{choice[0]}`" for choice in setting.choices)
    unit = " radians" if setting.subtype == "ANGLE" else ""
    return f"{_bounds(setting.low, setting.high)}{unit}"


def _bounds(low: Any, high: Any) -> str:
    known = [None if one is None else f"{one:.7g}" for one in (low, high)]
    if low is None or high is None or high == 2**31 - 1:
        return "" if low is None else f">= {known[0]}"
    return f"{known[0]}..{known[1]}"


TYPES_HEAD = '''# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of fields.py. Written by scripts/setting_tables.py."""

from dataclasses import dataclass

from .descriptors import Setting

TABLES: dict[str, tuple[str, list[Setting]]]
'''
NAMES = {
    Kind.NUMBER: "float",
    Kind.WHOLE: "int",
    Kind.SWITCH: "bool",
    Kind.MATERIALS: "tuple[str, ...]",
}


def types() -> str:
    """The stub of addon/core/settings/fields.py."""
    parts = [TYPES_HEAD]
    for name, (what, settings) in TABLES.items():
        fields = [f"    {one.field_name}: {NAMES.get(one.kind, 'str')} = ..." for one in settings]
        head = ["", "@dataclass(frozen=True)", f"class {name}:", f'    """Settings {what}."""', ""]
        parts.append("\n".join([*head, *fields, ""]))
    return "".join(parts)


BPY_HEAD = '''# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of Blender's objects, as far as the add-on's properties need them; all else is Any.

Written by scripts/setting_tables.py.
"""

from collections.abc import Iterator
from typing import Any, Generic, TypeVar

_Group = TypeVar("_Group")

class _Open:
    """A class whose methods are not described here."""

    bl_rna: Any
    id_data: Any
    name: str
    def __getitem__(self, key: str) -> Any: ...
    def __setitem__(self, key: str, value: Any) -> None: ...
    def __delitem__(self, key: str) -> None: ...
    def __contains__(self, key: str) -> bool: ...
    def get(self, key: str, default: Any = ...) -> Any: ...
    def keys(self) -> Any: ...
    def is_property_set(self, name: str) -> bool: ...
    def property_unset(self, name: str) -> None: ...

class _Collection(Generic[_Group]):
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[_Group]: ...
    def __getitem__(self, key: int) -> _Group: ...
    def add(self) -> _Group: ...
    def clear(self) -> None: ...
    def remove(self, index: int) -> None: ...
    def move(self, source: int, target: int) -> None: ...
    def keys(self) -> list[str]: ...

class Object(_Open):
    dapple: DAPPLE_PG_scatter
    def __getattr__(self, name: str) -> Any: ...
    def __setattr__(self, name: str, value: Any) -> None: ...

class Context:
    object: Object
    active_object: Object
    def __getattr__(self, name: str) -> Any: ...

def __getattr__(name: str) -> Any: ...
'''
BPY_KINDS = {
    "FloatProperty": "float",
    "IntProperty": "int",
    "BoolProperty": "bool",
    "EnumProperty": "str",
    "StringProperty": "str",
}
BPY_SETTINGS = {
    Kind.NUMBER: "float",
    Kind.WHOLE: "int",
    Kind.SWITCH: "bool",
    Kind.MATERIALS: "_Collection[DAPPLE_PG_material]",
}


def bpy_types() -> str:
    """The stub of bpy.types: the property groups of the add-on."""
    parts = [BPY_HEAD]
    for path in PROPERTIES:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and node.name.startswith("DAPPLE_PG"):
                fields = [*_table_fields(node), *_own_fields(node)]
                lines = [f"    {name}: {kind}" for name, kind in fields if name != "name"]
                parts.append("\n".join(["", f"class {node.name}(_Open):", *lines, ""]))
    return "".join(parts)


def _table_fields(node: ast.ClassDef) -> Iterable[tuple[str, str]]:
    """Names and types of the settings that a property group takes from the tables."""
    for decorator in node.decorator_list:
        group = ast.literal_eval(decorator.args[0].slice)  # type: ignore[attr-defined]
        for one in GROUPS[group]:
            kind = "Any" if one.kind in DATA else "str"
            yield one.name, BPY_SETTINGS.get(one.kind, kind)


def _own_fields(node: ast.ClassDef) -> Iterable[tuple[str, str]]:
    """Names and types of the properties that a property group declares itself."""
    for one in node.body:
        if isinstance(one, ast.AnnAssign) and isinstance(one.annotation, ast.Call):
            kind = ast.unparse(one.annotation.func)
            target = [
                ast.unparse(word.value) for word in one.annotation.keywords if word.arg == "type"
            ]
            group = target[0] if target and target[0].startswith("DAPPLE_PG") else "Any"
            collected = f"_Collection[{group}]" if kind == "CollectionProperty" else group
            yield ast.unparse(one.target), BPY_KINDS.get(kind, collected)


def main(arguments: Sequence[str]) -> int:
    """The exit code."""
    if not set(arguments) <= {"--write"}:
        print(__doc__)
        return 2
    page = PAGE.read_text(encoding="utf-8")
    stub = TYPES.read_text(encoding="utf-8") if TYPES.exists() else ""
    bpy_stub = BPY_TYPES.read_text(encoding="utf-8") if BPY_TYPES.exists() else ""
    wanted = {
        PAGE: (page, written(page)),
        TYPES: (stub, types()),
        BPY_TYPES: (bpy_stub, bpy_types()),
    }
    others = {path: now for path, (before, now) in wanted.items() if before != now}
    for path, now in others.items():
        print(path.relative_to(ROOT))
        if "--write" in arguments:
            path.write_text(now, encoding="utf-8")
    return int(bool(others) and "--write" not in arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
