# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of the public headers: one for each room, what they declare in the order of their lines."""

import re
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from scripts import rooms


class Entry(NamedTuple):
    """What a header declares in the namespace, in Doxygen's words."""

    header: str
    line: int
    kind: str
    name: str
    arguments: str


def entry(element: ElementTree.Element, name: str) -> Entry:
    """Of a class or of a member of the namespace."""
    place = element.find("location")
    assert place is not None
    return Entry(
        Path(place.attrib["file"]).stem,
        int(place.attrib["line"]),
        element.attrib["kind"],
        name,
        element.findtext("argsstring", "").replace("=default", ""),
    )


def entries(xml: Path) -> Iterator[Entry]:
    """All that the namespace holds; a class within a class comes with that."""
    space = ElementTree.parse(xml / "namespacedapple.xml").getroot()
    for member in space.iter("memberdef"):
        yield entry(member, f"dapple::{member.findtext('name')}")
    for inner in space.iter("innerclass"):
        if (inner.text or "").count("::") == 1:
            compound = ElementTree.parse(xml / f"{inner.attrib['refid']}.xml").find("compounddef")
            assert compound is not None
            yield entry(compound, inner.text or "")


def directive(found: Entry, overloaded: bool) -> str:
    """How breathe shows it."""
    name = found.name + (found.arguments if overloaded else "")
    members = "\n   :members:\n   :undoc-members:" if found.kind in ("class", "struct") else ""
    return f".. doxygen{found.kind}:: {name}{members}\n"


def heading(text: str, line: str) -> list[str]:
    """A title, underlined."""
    return [text, line * len(text), ""]


def room_page(room: str, what: str, names: list[str], found: list[Entry]) -> str:
    """The page of a room."""
    count = Counter(one.name for one in found)
    parts = [*heading(room.capitalize(), "="), f"{what}.\n"]
    for name in names:
        parts += heading(f"dapple/{name}.hpp", "-")
        parts += [
            directive(one, count[one.name] > 1) for one in sorted(found) if one.header == name
        ]
    return "\n".join(parts)


def write_rooms(xml: Path, to: Path) -> None:
    """A page for each room with public headers, from the table in docs/development/rooms.md."""
    text = (rooms.ROOT / rooms.PAGE).read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([a-z]+)/` \| ([^|]*?) \|", text, re.MULTILINE)
    what = {room: words[0].upper() + words[1:] for room, words in rows}
    found = list(entries(xml))
    shown = {one.header for one in found}
    listed = {
        room: [name for name in names if name in shown]
        for room, names in rooms.listed_rooms().items()
        if shown & set(names)
    }
    for room, names in listed.items():
        page = room_page(room, what[room], names, found)
        (to / f"{room}.rst").write_text(page, encoding="utf-8")
    index = (to / "index.md").read_text(encoding="utf-8")
    lines = [f"- [{room.capitalize()}]({room}.rst): {what[room]}" for room in listed]
    contents = ["", "```{toctree}", ":hidden:", "", *listed, "```", ""]
    (to / "index.md").write_text(index + "\n".join([*lines, *contents]), encoding="utf-8")


if __name__ == "__main__":
    write_rooms(Path(sys.argv[1]) / "xml", Path(sys.argv[1]) / "source/cpp")
