#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the add-on's tables of settings (addon/core/settings/tables.py) into docs/add-on.md, and
the types of their values for mypy into addon/core/settings/fields.pyi.

Needs the package, whose options are settings too.

  scripts/setting_tables.py [--write]

Without --write it names the files that differ, and fails if there are any.
"""

from __future__ import annotations

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


def main(arguments: Sequence[str]) -> int:
    """The exit code."""
    if not set(arguments) <= {"--write"}:
        print(__doc__)
        return 2
    page = PAGE.read_text(encoding="utf-8")
    stub = TYPES.read_text(encoding="utf-8") if TYPES.exists() else ""
    wanted = {PAGE: (page, written(page)), TYPES: (stub, types())}
    others = {path: now for path, (before, now) in wanted.items() if before != now}
    for path, now in others.items():
        print(path.relative_to(ROOT))
        if "--write" in arguments:
            path.write_text(now, encoding="utf-8")
    return int(bool(others) and "--write" not in arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
