# SPDX-License-Identifier: GPL-3.0-or-later
"""Names every line with a British spelling or a withdrawn word: python scripts/spelling.py

docs/development/words.md says what to write instead.
"""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORD_LISTS = (
    "docs/development/words.md",
    "scripts/spelling.py",
    "tests/python/test_spelling.py",
)
OTHER_LANGUAGES = (
    "addon/translations/"  # tests/blender/settings/test_translation.py looks at the English
)
_VERBS = (  # without their -ise, -ised, -ising, -isation
    "capital character custom discret emphas equal final general initial local maxim memor "
    "minim modern normal optim organ parallel parameter parametr penal polygon priorit quant "
    "random raster real recogn regular serial special stabil standard summar symmetr synchron "
    "triangular util vector visual"
)
_STEMS = (
    r"aeroplane ageing amongst analys(ed|ing|er|e\b) armour artefact behaviour bevell "
    "catalogue centre centring cheque colour defence draught favour fibre flavour fulfil(?!l) "
    "grey harbour honour humour judgement labell learnt licence metre modell mould neighbour "
    "parlour plough practis programme(?![dr]) rumour sceptic spelt storey towards travell tyre "
    "vapour vigour whilst"
)
BRITISH = re.compile(
    rf"({'|'.join(_VERBS.split())})is(e|ing|ation|able)|{'|'.join(_STEMS.split())}",
    re.IGNORECASE,
)
_WARDS = "after back down for in out side up"  # toward is above
_WITHDRAWN = (
    rf"\b({'|'.join(_WARDS.split())})wards\b",
    r"\bwhat of\b",
    r"\bhears?\b",
    r"\bfore(tell|told)",
    r"\bas many as there are\b",
    r"\bin the place of\b",
    r"\b(those|files|states|points|frames?) of before\b",
    r"\bother bytes\b",
    r"\bgives? up what\b",
)
WITHDRAWN = re.compile("|".join(_WITHDRAWN), re.IGNORECASE)


def lines(path: Path) -> Iterator[tuple[int, str]]:
    """Numbered lines of a text file; none of any other."""
    try:
        yield from enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
    except UnicodeDecodeError:
        return


def british(line: str) -> str:
    """The first British spelling of a line; empty where there is none."""
    found = BRITISH.search(line)
    return found[0] if found else ""


def withdrawn(line: str) -> str:
    """The first withdrawn word of a line; empty where there is none."""
    found = WITHDRAWN.search(line)
    return found[0] if found else ""


def problems(name: str, line: str) -> Iterator[str]:
    """What is wrong with a line of a file."""
    if word := british(line):
        yield f"British spelling '{word}'"
    if word := withdrawn(line):
        yield f"withdrawn word '{word}': see docs/development/words.md"


def main() -> int:
    """How many lines are to be mended, at most 1."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.splitlines()
    found = [
        f"{name}:{number}: {problem}"
        for name in listed
        if name not in WORD_LISTS
        and not name.startswith(OTHER_LANGUAGES)
        and (ROOT / name).is_file()
        for number, line in lines(ROOT / name)
        for problem in problems(name, line)
    ]
    print(*found, sep="\n", end="\n" if found else "")
    return min(len(found), 1)


if __name__ == "__main__":
    sys.exit(main())
