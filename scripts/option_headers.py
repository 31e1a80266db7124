#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the tables of options from the structs in the public headers.

    scripts/option_headers.py [--write]

An option is a member of an options struct with its sentence above it and a comment behind it:

    /// Relative decrease of the energy at which to stop.
    double tolerance = 5e-5;  // basic, >= 0, spacings

The comment holds the level, the range of a number (`>= a`, `> a` or `a..b`) and, if there is one,
the unit; `same result` marks an option that changes no sample. `// options` marks a struct whose
options are taken over. The tables give range checks, bindings, stubs, command line and pages.
Without --write stale ones are named.
"""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
INCLUDE = "native/include/dapple"
HEADER = f"{INCLUDE}/option_tables.hpp"
SOURCE = "native/src/options/option_tables.cpp"
MADE = """// SPDX-License-Identifier: GPL-3.0-or-later
// Made by scripts/option_headers.py from the options structs: change those.
"""

STRUCT = re.compile(r"^struct (\w+Options) \{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
ENUM = re.compile(r"^enum class (\w+)[^{]*\{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
MEMBER = re.compile(
    r"(?P<text>(?:^  ///? .*\n)*)^  (?P<type>[\w:]+) (?P<name>\w+)(?: =[^;]*)?;"
    r"(?:[ \n]*)// (?P<notes>.*)$",
    re.MULTILINE,
)


@dataclass
class Member:
    """A line of a table."""

    struct: str
    name: str
    type: str
    notes: list[str]
    text: str

    @property
    def is_group(self) -> bool:
        return self.notes == ["options"]

    def row(self) -> str:
        member = f"&{self.struct}::{self.name}"
        if self.is_group:
            return f"Group{{{member}}}"
        level, *rest = self.notes
        same = "same result" in rest
        rest = [note for note in rest if note != "same result"]
        range_ = range_of(rest.pop(0), self) if rest else "{}"
        unit = ", ".join(rest)
        sentence = self.text.replace('"', '\\"')
        if not sentence:
            raise ValueError(f"{self.struct}::{self.name} has no sentence")
        ending = ", false" if same else ""
        level = f"Level::k{level.capitalize()}"
        parts = [f'"{self.name}"', member, range_, f'"{unit}"', level, f'"{sentence}"{ending}']
        return f"Option{{{', '.join(parts)}}}"


@dataclass
class Header:
    """What a public header tells of options."""

    name: str
    tables: dict[str, list[Member]] = field(default_factory=dict)
    choices: dict[str, list[str]] = field(default_factory=dict)


def range_of(note: str, member: Member) -> str:
    """C++ for a range in words."""
    if found := re.fullmatch(r">= (\S+)", note):
        return f"{{{found[1]}, kFinite}}"
    if found := re.fullmatch(r"> (\S+)", note):
        return f"{{{found[1]}, kFinite, true}}"
    if found := re.fullmatch(r"(\S+)\.\.(\S+)", note):
        return f"{{{found[1]}, {found[2]}}}"
    raise ValueError(
        f"{member.struct}::{member.name}: '{note}' is no range; write >= a, > a or a..b"
    )


def sentence(lines: str) -> str:
    """The documentation above a member, without other comments."""
    found = re.findall(r"^  /// (.*)$", lines, re.MULTILINE)
    return " ".join(found)


def members_of(struct: str, body: str) -> list[Member]:
    """The options of a struct."""
    return [
        Member(struct, m["name"], m["type"], m["notes"].split(", "), sentence(m["text"]))
        for m in MEMBER.finditer(body)
        if m["notes"].split(", ")[0] in ("basic", "expert", "internal", "options")
    ]


def read_headers(root: Path) -> list[Header]:
    """Every public header that holds options or their choices."""
    headers = []
    for path in sorted((root / INCLUDE).glob("*.hpp")):
        text = path.read_text()
        header = Header(path.name)
        for name, body in STRUCT.findall(text):
            if members := members_of(name, body):
                header.tables[name] = members
        header.choices = {
            name: re.findall(r"^  k(\w+)", body, re.MULTILINE) for name, body in ENUM.findall(text)
        }
        headers.append(header)
    used = {m.type for header in headers for rows in header.tables.values() for m in rows}
    for header in headers:
        header.choices = {name: values for name, values in header.choices.items() if name in used}
    return [header for header in headers if header.tables or header.choices]


def in_order(headers: list[Header]) -> list[tuple[str, list[Member]]]:
    """The tables, those of nested structs first."""
    tables = {name: rows for header in headers for name, rows in header.tables.items()}
    placed: dict[str, list[Member]] = {}

    def place(name: str) -> None:
        for member in tables[name]:
            if member.is_group and member.type not in placed:
                place(member.type)
        placed[name] = tables[name]

    for name in tables:
        place(name)
    return list(placed.items())


def snake(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def header_text(headers: list[Header]) -> str:
    """The table of each struct and the names of each enumeration."""
    lines = [MADE, "#pragma once\n"]
    lines += [f"#include <dapple/{header.name}>" for header in headers]
    lines += ["#include <dapple/option.hpp>", "\nnamespace dapple {\n"]
    for header in headers:
        for enum, values in header.choices.items():
            pairs = ", ".join(f'{{"{snake(value)}", {enum}::k{value}}}' for value in values)
            array = f"std::array<Choice<{enum}>, {len(values)}>"
            lines.append(f"constexpr {array} choices_of({enum}) {{ return {{{{{pairs}}}}}; }}\n")
    for struct, members in in_order(headers):
        rows = ",\n".join(member.row() for member in members)
        lines.append(f"inline constexpr std::tuple k{struct} = {{\n{rows}}};\n")
        lines.append(f"constexpr const auto& options_of(const {struct}&) {{ return k{struct}; }}\n")
    return "\n".join([*lines, "}  // namespace dapple", ""])


def source_text(headers: list[Header]) -> str:
    """The range check of each struct."""
    lines = [MADE + "#include <dapple/option_tables.hpp>\n", "namespace dapple {\n"]
    lines += [
        f"void check_options(const {struct}& options) {{ check_ranges(options); }}"
        for struct, _ in in_order(headers)
    ]
    return "\n".join([*lines, "\n}  // namespace dapple", ""])


def formatted(root: Path, name: str, text: str) -> str:
    """As clang-format lays it out."""
    beside = Path(sys.executable).with_name("clang-format")
    program = str(beside) if beside.exists() else "clang-format"
    command = [program, f"--style=file:{ROOT / '.clang-format'}", f"--assume-filename={name}"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def written(root: Path) -> dict[Path, str]:
    """What the files ought to hold."""
    headers = read_headers(root)
    texts = {HEADER: header_text(headers), SOURCE: source_text(headers)}
    return {root / name: formatted(root, name, text) for name, text in texts.items()}


def stale(files: dict[Path, str]) -> list[Path]:
    """Those that do not hold it."""
    return [path for path, text in files.items() if not path.exists() or path.read_text() != text]


def main() -> int:
    files = written(ROOT)
    if "--write" in sys.argv[1:]:
        for path, text in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            if not path.exists() or path.read_text() != text:
                path.write_text(text)
        return 0
    for path in stale(files):
        print(f"{path.relative_to(ROOT)} is stale: scripts/option_headers.py --write")
    return 1 if stale(files) else 0


if __name__ == "__main__":
    sys.exit(main())
