# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of what tests run: python tests/coverage.py PART..., each the path of a count, no suffix.

Fails where a room has less than LINES of its lines, or one of the KERNELS less than BRANCHES of its
branches.
"""

import json
import sys
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

LINES, BRANCHES = 0.90, 0.80
KERNELS = {"native/src/voronoi", "native/src/optimize"}
INSTALLED = {
    "site-packages/dapple3d/": "native/python/dapple3d",
    "repository/dapple/": "addon",
}


@dataclass
class Count:
    """Those run of all, lines and branches."""

    lines: int = 0
    of_lines: int = 0
    branches: int = 0
    of_branches: int = 0

    def add(self, other: "Count") -> None:
        """Together with others."""
        self.lines += other.lines
        self.of_lines += other.of_lines
        self.branches += other.branches
        self.of_branches += other.of_branches


def counts(path: Path) -> Iterator[tuple[str, Count]]:
    """Of each file, by gcovr or by coverage.py."""
    files = json.loads(path.read_text(encoding="utf-8"))["files"]
    if isinstance(files, list):
        for one in files:
            yield (
                one["filename"],
                Count(
                    *(
                        one[k]
                        for k in ("line_covered", "line_total", "branch_covered", "branch_total")
                    )
                ),
            )
        return
    for name, one in files.items():
        totals = one["summary"]
        keys = ("covered_lines", "num_statements", "covered_branches", "num_branches")
        yield name, Count(*(totals[key] for key in keys))


def room_of(name: str) -> str:
    """The folder that a file counts for."""
    for installed, source in INSTALLED.items():
        _, found, rest = name.partition(installed)
        if found:
            return str(Path(source, rest).parent)
    return str(Path(name).parent)


def share(run: int, of: int) -> float:
    """1 if there is nothing to run."""
    return run / of if of else 1.0


def shown(part: Path) -> bool:
    """Print the table of a part; whether all have what they should."""
    rooms: dict[str, Count] = defaultdict(Count)
    for name, count in counts(part.with_suffix(".json")):
        rooms[room_of(name)].add(count)
    print(f"\n{part.name}\n\n| room | lines | branches | |\n|---|---|---|---|")
    enough = True
    for room, count in sorted(rooms.items()):
        lines = share(count.lines, count.of_lines)
        branches = share(count.branches, count.of_branches)
        few = lines < LINES or (room in KERNELS and branches < BRANCHES)
        enough = enough and not few
        row = (room, f"{lines:.1%} of {count.of_lines}", f"{branches:.1%}", "too few" * few)
        print("| " + " | ".join(row) + " |")
    return enough


if __name__ == "__main__":
    sys.exit(0 if all([shown(Path(part)) for part in sys.argv[1:]]) else 1)
