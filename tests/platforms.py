# SPDX-License-Identifier: GPL-3.0-or-later
"""Say in a release's table what ran where: python tests/platforms.py TABLE.md PLATFORM CELL...

The line of the platform is replaced or added, all others stay as their writers left them. An empty
cell means no.
"""

import sys
from pathlib import Path

HEAD = ["| platform | built | tests run | loaded in Blender |", "|---|---|---|---|"]


def with_line(table: str, platform: str, cells: list[str]) -> str:
    """The table with this line."""
    lines = table.splitlines() if "|---|" in table else [*table.splitlines(), *HEAD]
    line = "| " + " | ".join([platform, *(cell or "no" for cell in cells)]) + " |"
    begin = f"| {platform} |"
    found = [number for number, old in enumerate(lines) if old.startswith(begin)]
    if found:
        lines[found[0]] = line
    else:
        last = max(number for number, old in enumerate(lines) if old.startswith("|"))
        lines.insert(last + 1, line)
    return "\n".join(lines) + "\n"


def main(name: str, platform: str, *cells: str) -> None:
    """Write the line into the file, which may be missing."""
    path = Path(name)
    path.write_text(with_line(path.read_text() if path.exists() else "", platform, list(cells)))


if __name__ == "__main__":
    main(*sys.argv[1:])
