# SPDX-License-Identifier: GPL-3.0-or-later
"""Markdown tables on stdout, progress on stderr."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence

Row = Sequence[str]


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def table(head: Row, rows: Iterable[Row]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
