# SPDX-License-Identifier: GPL-3.0-or-later
"""What Doxygen reads instead of the public headers.

Options have their level, range and unit in a comment behind them, which becomes a part of their
sentence here. The tables that a script makes from them are left out.
"""

import re
from pathlib import Path

LEFT_OUT = ("option.hpp", "option_tables.hpp")
STRUCT = re.compile(r"^struct (?P<name>\w+)[^;{]*\{\n(?P<body>.*?)^\};", re.DOTALL | re.MULTILINE)
MEMBER = re.compile(r"^  [\w:<>, ]+ (?P<name>\w+)(?: = (?P<value>.*?))?;(?: +// (?P<notes>.*))?$")
BROKEN = re.compile(r" = \{\n +(?=\.)")
THROW = re.compile(r"^( *)/// \\throw (.*(?:\n *///(?! \\| *$).*)*)", re.MULTILINE)
QUOTE = re.compile(r"///<? (?=> )")
UNSAID = {  # what is the same everywhere
    "Cancelled": "Cancelled through the context",
    "SurfaceError": "SurfaceError naming the first offender",
    "ArgumentError": "ArgumentError naming the first offender",
}


def limits(notes: str | None) -> str:
    """The range and unit of an option, from the comment behind it."""
    level, *rest = (notes or "").split(", ")
    rest = [note for note in rest if note != "same result"]
    if level not in ("basic", "expert", "internal") or not rest:
        return ""
    return f"  /// ({'; in '.join(rest)}).".replace("> ", "\\> ").replace(">= ", "\\>= ")


def plain(line: str, value: str) -> list[str]:
    """A member without the designated initializers of its value, which Sphinx cannot read."""
    if "{." not in value:
        return [line]
    return [f"  /// As by default, but `{value[1:-1]}`.", line.partition(" = ")[0] + ";"]


def with_comments(found: re.Match[str]) -> str:
    """A struct whose members tell the range and unit of options."""
    lines = []
    for line in BROKEN.sub(" = {", found["body"]).splitlines():
        member = MEMBER.match(line)
        if member and (note := limits(member["notes"])):
            lines.append(note)
        lines += plain(line, member["value"]) if member and member["value"] else [line]
    head = found[0][: found.start("body") - found.start()]
    return head + "\n".join(lines) + "\n};"


def throws(found: re.Match[str]) -> str:
    """What is thrown, each kind by itself: Doxygen takes one name."""
    text = re.sub(r"\s*\n *///\s*", " ", found[2])
    kinds = re.split(r"[;,] (?=(?:\w+Error|Cancelled)\b)", text)
    return "\n".join(f"{found[1]}/// \\throw {UNSAID.get(kind, kind)}" for kind in kinds)


def filtered(text: str) -> str:
    """What Doxygen is to read of a header."""
    text = QUOTE.sub(r"\g<0>\\", text)  # no quotation: "> 0"
    text = THROW.sub(throws, text.replace("\\pre, \\throw as", "Conditions and errors as of"))
    return STRUCT.sub(with_comments, text)


def write_headers(folder: Path, to: Path) -> None:
    """All headers of a folder as Doxygen is to read them."""
    to.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("*.hpp"):
        if path.name not in LEFT_OUT:
            (to / path.name).write_text(
                filtered(path.read_text(encoding="utf-8")), encoding="utf-8"
            )
