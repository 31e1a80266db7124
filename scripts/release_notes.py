# SPDX-License-Identifier: GPL-3.0-or-later
"""Print what CHANGELOG.md says of a version: python scripts/release_notes.py [--draft] [FILE...]

The version is that of CMakeLists.txt, and its section the first one. With --draft it may still be
called Unreleased; with --tag NAME, a tag of another version is refused. Files, such as the table
of what was tested where, follow behind it.
"""

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
HEADING = re.compile(r"^## \[(?P<name>[^\]]+)\](?: - (?P<date>\d{4}-\d{2}-\d{2}))?$", re.MULTILINE)


def version(cmake: str) -> str:
    """The project's version in the text of CMakeLists.txt."""
    found = re.search(r"project\(dapple VERSION ([0-9.]+)", cmake)
    if not found:
        raise SystemExit("CMakeLists.txt names no version")
    return found[1]


def section(changelog: str, name: str, *, draft: bool = False) -> str:
    """The text of the first section, which must be the version's and dated."""
    headings = list(HEADING.finditer(changelog))
    if not headings:
        raise SystemExit("CHANGELOG.md has no section")
    first = headings[0]
    if not (first["name"] == name and first["date"]) and not (
        draft and first["name"] == "Unreleased"
    ):
        raise SystemExit(f'CHANGELOG.md begins with "{first[0]}", not with "## [{name}] - DATE"')
    end = headings[1].start() if len(headings) > 1 else len(changelog)
    return changelog[first.end() : end].strip()


def standing_alone(text: str) -> str:
    """The text for a page that keeps line breaks and has no checkout beside it for links."""
    unwrapped = re.sub(r"(?<=\S)\n {2,}(?=\S)(?![-*|])", " ", text)
    return re.sub(r"\[([^\]]+)\]\((?!\w+://)[^)]+\)", r"\1", unwrapped)


def main() -> None:
    """Print the notes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draft", action="store_true", help="the section may be Unreleased")
    parser.add_argument("--tag", metavar="NAME", help="the tag that the release is to have")
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="texts that follow")
    arguments = parser.parse_args()
    name = version((ROOT / "CMakeLists.txt").read_text())
    if arguments.tag not in (None, f"v{name}"):
        raise SystemExit(f"the tag is {arguments.tag}, but CMakeLists.txt names version {name}")
    changelog = (ROOT / "CHANGELOG.md").read_text()
    parts = [standing_alone(section(changelog, name, draft=arguments.draft))]
    parts += [file.read_text().strip() for file in arguments.files]
    sys.stdout.write("\n\n".join(parts) + "\n")


if __name__ == "__main__":
    main()
