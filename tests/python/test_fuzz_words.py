# SPDX-License-Identifier: GPL-3.0-or-later
"""An engine refuses to start if it cannot read a line of a target's words."""

import re
from pathlib import Path

import pytest

FUZZ = Path(__file__).parents[1] / "fuzz"
LINE = re.compile(r'#.*|([\w.]+=)?"([^"\\]|\\\\|\\"|\\x[0-9a-fA-F]{2})+"|')


@pytest.mark.parametrize("words", sorted(FUZZ.glob("*.dict")), ids=lambda path: path.stem)
def test_engines_read_every_line(words: Path) -> None:
    """Of escapes there are a quote, a backslash and two digits of a byte."""
    assert [
        line for line in words.read_text("ascii").splitlines() if not LINE.fullmatch(line)
    ] == []


def test_every_file_of_words_has_a_target() -> None:
    """Words under another name are never used."""
    targets = {path.stem for path in (FUZZ / "targets").glob("*.cpp")}
    assert {path.stem for path in FUZZ.glob("*.dict")} <= targets
