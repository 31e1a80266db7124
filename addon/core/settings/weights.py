# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights of the objects of a collection, as a text that nodes read; the order that nodes have them
in.
"""

import re
from functools import cmp_to_key
from typing import Any

TOTAL = 999  # that weights are shares of
DIGITS, DIGIT = 3, 9  # of a share, and letters of each: nodes can count letters, not read numbers
_PARTS = re.compile(rb"[0-9]+|.", re.DOTALL)
_DOT = b"."


def packed(weights: list[float]) -> str:
    """Weights as text for nodes, which can count letters; empty if all are equal. Each digit of a
    share is written as that many x, padded with spaces.
    """
    if len(set(weights)) <= 1 and any(weights):
        return ""
    return "".join(
        ("x" * int(digit)).ljust(DIGIT) for one in _shares(weights) for digit in f"{one:0{DIGITS}}"
    )


def _shares(weights: list[float]) -> list[int]:
    """Shares of TOTAL, by largest remainders; slightly more if each weight is to have one."""
    total = sum(weights)
    if not total:
        return [0] * len(weights)
    quotas = [TOTAL * one / total for one in weights]
    found = [int(quota) for quota in quotas]
    order = sorted(range(len(quotas)), key=lambda k: (found[k] - quotas[k], k))
    for k in order[: TOTAL - sum(found)]:
        found[k] += 1
    return [max(one, 1) if weight else 0 for one, weight in zip(found, weights, strict=True)]


def sort_key(name: str) -> Any:
    """Orders names as Blender's Collection Info does: numbers by their value, letters alike in both
    cases, a dot first. That is no order of all names: it has x0z before x00, x00 before x00y, and
    that before x0z.
    """
    return _KEY(name.encode())


def _compare(one: bytes, other: bytes) -> int:
    tie = 0
    for a, b in zip(_PARTS.findall(one), _PARTS.findall(other), strict=False):
        found, zeros = _compare_parts(a, b)
        if found:
            return found
        tie = tie or zeros
    return tie or (one > other) - (one < other)


def _compare_parts(a: bytes, b: bytes) -> tuple[int, int]:
    """Compare two numbers or letters; leading zeros count only if all else is equal."""
    if a.isdigit() and b.isdigit():
        return _sign(int(a), int(b)), _sign(len(a), len(b))
    a, b = a.lower()[:1], b.lower()[:1]
    if a != b and _DOT in (a, b):
        return (-1 if a == _DOT else 1), 0
    return _sign(a, b), 0


def _sign(a: Any, b: Any) -> int:
    return int(a > b) - int(a < b)


_KEY = cmp_to_key(_compare)
