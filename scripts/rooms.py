#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the rooms of native/src, whose order is the table in docs/development/rooms.md.

A file includes only files of its own room and of rooms before it, and no circle leads from a
header over its source back to it. A public header belongs to the room that lists it. Every line
that breaks this is named.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
PAGE = "docs/development/rooms.md"
ROOM = re.compile(r"^\| `(?P<room>[a-z]+)/` \|[^|]*\|(?P<headers>[^|]*)\|$", re.MULTILINE)
INCLUDE = re.compile(r'#include (?:<dapple/(?P<public>\w+)|"\w+/(?P<internal>\w+))\.hpp[>"]')


class Include(NamedTuple):
    """One line that includes a file of ours: `path:line`, and stems (name without suffix)."""

    place: str
    source: str
    target: str


def listed_rooms() -> dict[str, list[str]]:
    """The rooms in order, with the public headers that each lists."""
    text = (ROOT / PAGE).read_text(encoding="utf-8")
    return {m["room"]: re.findall(r"`(\w+)`", m["headers"]) for m in ROOM.finditer(text)}


def files() -> Iterator[Path]:
    """All files with code of the library."""
    yield from sorted((ROOT / "native/include/dapple").glob("*.hpp"))
    yield from sorted((ROOT / "native/src").rglob("*.[ch]pp"))


def includes() -> Iterator[Include]:
    """Every line that includes a file of ours, but that of a source with its own header."""
    for path in files():
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            match = INCLUDE.match(line)
            target = match and (match["public"] or match["internal"])
            if target and target != path.stem:
                yield Include(f"{path.relative_to(ROOT)}:{number}", path.stem, target)


def room_of_stems(rooms: dict[str, list[str]]) -> dict[str, str]:
    """Where each stem belongs; headers nobody lists are missing."""
    found = {path.stem: path.parent.name for path in (ROOT / "native/src").rglob("*.[ch]pp")}
    for room, headers in rooms.items():
        found.update(dict.fromkeys(headers, room))
    return found


def list_problems(rooms: dict[str, list[str]]) -> Iterator[str]:
    """What the page lists and what is there must be the same."""
    there = {path.stem for path in (ROOT / "native/include/dapple").glob("*.hpp")}
    listed = [header for headers in rooms.values() for header in headers]
    folders = {path.name for path in (ROOT / "native/src").iterdir() if path.is_dir()}
    for header in sorted(there - set(listed)):
        yield f"native/include/dapple/{header}.hpp: no room in {PAGE} lists it"
    for header in sorted({name for name in listed if name not in there or listed.count(name) > 1}):
        yield f"{PAGE}: the header {header} is not there or listed twice"
    for room in sorted(folders ^ set(rooms)):
        yield f"native/src/{room}: must be a folder and a row of the table in {PAGE}"
    for path in (ROOT / "native/src").rglob("*.[ch]pp"):
        for room, headers in rooms.items():
            if path.stem in headers and path.parent.name != room:
                yield f"{path.relative_to(ROOT)}: its public header is in the room {room}"


def order_problems(rooms: dict[str, list[str]]) -> Iterator[str]:
    """Includes of rooms that come later."""
    order = list(rooms)
    room_of = room_of_stems(rooms)
    for place, source, target in includes():
        here, there = room_of.get(source), room_of.get(target)
        if here in order and there in order and order.index(there) > order.index(here):
            yield f"{place}: {here}/ includes {target} of {there}/, which comes after it"


def circle_problems() -> Iterator[str]:
    """One circle of headers and sources, if there is any.

    A public header stands apart from its source: it holds the options of its verb, which the parts
    of the verb take.
    """
    public = {path.stem for path in (ROOT / "native/include/dapple").glob("*.hpp")}
    graph: dict[str, set[str]] = {}
    lines: dict[tuple[str, str], str] = {}
    for place, stem, target in includes():
        is_source = stem in public and not place.startswith("native/include/")
        source = f"{stem}.cpp" if is_source else stem
        graph.setdefault(source, set()).add(target)
        lines.setdefault((source, target), place)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        circle = list(reversed(error.args[1]))
        for source, target in pairwise(circle):
            way = " > ".join(circle)
            yield f"{lines[source, target]}: {source} includes {target}, in the circle {way}"


def main() -> int:
    """Prints what is wrong; 1 if anything is."""
    rooms = listed_rooms()
    problems = [*list_problems(rooms), *order_problems(rooms), *circle_problems()]
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
