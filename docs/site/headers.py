# SPDX-License-Identifier: GPL-3.0-or-later
"""What Doxygen reads instead of the public headers.

Options have their range, unit and sentence in a tuple beside the struct (`option.hpp`). Here they
come to the members as comments, and the tuples go with what only walks over them.
"""

import re
from pathlib import Path

TEXT = r'(?P<text>(?:"(?:[^"\\]|\\.)*"\s*)+)'
REST = rf'(?P<range>\{{[^}}]*\}}|k\w+),\s*"(?P<unit>[^"]*)",\s*Level::\w+,\s*{TEXT}'
ROW = re.compile(rf'Option\{{\s*"\w+",\s*&(?P<struct>\w+)::(?P<member>\w+),\s*{REST}')
SHARED_ROW = re.compile(r"\b(?P<kind>\w+)_option\(&(?P<struct>\w+)::(?P<member>\w+)\)")
SHARED = re.compile(rf' (?P<kind>\w+)_option\([^)]*\) \{{\s*return \{{"\w+",\s*member,\s*{REST}')
STRUCT = re.compile(r"^struct (?P<name>\w+)[^;{]*\{\n(?P<body>.*?)^\};", re.DOTALL | re.MULTILINE)
MEMBER = re.compile(r"^  [\w:<>, ]+ (?P<name>\w+)(?: = (?P<value>.*?))?;(?: +// .*)?$")
BROKEN = re.compile(r" = \{\n +(?=\.)")
THROW = re.compile(r"^( *)/// \\throw (.*(?:\n *///(?! \\| *$).*)*)", re.MULTILINE)
QUOTE = re.compile(r"///<? (?=> )")
UNSAID = {  # what is the same everywhere
    "Cancelled": "Cancelled through the context",
    "SurfaceError": "SurfaceError naming the first offender",
    "ArgumentError": "ArgumentError naming the first offender",
}
# Between two empty lines, or to the end of the namespace.
WALKED = re.compile(
    r"^(?:template [^\n]*\n)?"
    r"(?:inline constexpr std::tuple k\w+ =.*?;|constexpr const auto& options_of\(.*?\}"
    r"|constexpr std::array<Choice[^\n]* choices_of\(.*?^\}"
    r"|constexpr Option<[^\n]*_option\(.*?^\}|constexpr void visit_row\(.*?^\}"
    r"|Option\(const char.*?;|Group\(Nested.*?;)\n",
    re.DOTALL | re.MULTILINE,
)


def sentence(found: re.Match[str]) -> str:
    """Text of an option, with its unit."""
    text = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', found["text"]))
    return f"{text.rstrip('.')} ({found['unit']})." if found["unit"] else text


def shared_options(headers: list[str]) -> dict[str, str]:
    """Sentences of the options that several structs have, by the name of what makes the row."""
    return {found["kind"]: sentence(found) for text in headers for found in SHARED.finditer(text)}


def options(text: str, shared: dict[str, str]) -> dict[tuple[str, str], str]:
    """Sentences of the options of a header, by struct and member."""
    rows = {(row["struct"], row["member"]): sentence(row) for row in ROW.finditer(text)}
    for row in SHARED_ROW.finditer(text):
        rows[row["struct"], row["member"]] = shared[row["kind"]]
    return rows


def plain(line: str, value: str) -> list[str]:
    """A member without the designated initializers of its value, which Sphinx cannot read."""
    if "{." not in value:
        return [line]
    return [f"  /// As by default, but `{value[1:-1]}`.", line.partition(" = ")[0] + ";"]


def with_comments(found: re.Match[str], rows: dict[tuple[str, str], str]) -> str:
    """A struct whose members say what the rows of its options say."""
    lines = []
    for line in BROKEN.sub(" = {", found["body"]).splitlines():
        member = MEMBER.match(line)
        if member and (found["name"], member["name"]) in rows:
            lines.append(f"  /// {rows[found['name'], member['name']]}")
        lines += plain(line, member["value"]) if member and member["value"] else [line]
    head = found[0][: found.start("body") - found.start()]
    return head + "\n".join(lines) + "\n};"


def throws(found: re.Match[str]) -> str:
    """What is thrown, each kind by itself: Doxygen takes one name."""
    text = re.sub(r"\s*\n *///\s*", " ", found[2])
    kinds = re.split(r"[;,] (?=(?:\w+Error|Cancelled)\b)", text)
    return "\n".join(f"{found[1]}/// \\throw {UNSAID.get(kind, kind)}" for kind in kinds)


def filtered(text: str, shared: dict[str, str]) -> str:
    """What Doxygen is to read of a header."""
    rows = options(text, shared)
    text = QUOTE.sub(r"\g<0>\\", text)  # no quotation: "> 0"
    text = THROW.sub(throws, text.replace("\\pre, \\throw as", "Conditions and errors as of"))
    return WALKED.sub("", STRUCT.sub(lambda found: with_comments(found, rows), text))


def write_headers(folder: Path, to: Path) -> None:
    """All headers of a folder as Doxygen is to read them."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.hpp")}
    shared = shared_options(list(texts.values()))
    to.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (to / name).write_text(filtered(text, shared), encoding="utf-8")
