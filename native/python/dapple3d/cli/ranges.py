# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers on the command line: click calls its own types "integer range" and "float range"."""

import math
from typing import Any

import click


class Whole(click.IntRange):
    """A whole number in a range."""

    name = "integer"


class Number(click.FloatRange):
    """A number in a range; never NaN, which compares as in any range.

    Args:
        finite: whether infinite numbers are refused too.
        open_below: whether the lower end itself is out of the range.
    """

    name = "number"

    def __init__(
        self,
        low: float | None = None,
        high: float | None = None,
        *,
        finite: bool = False,
        open_below: bool = False,
    ) -> None:
        super().__init__(low, high, min_open=open_below)
        self._finite = finite

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number."""
        found: float = super().convert(value, param, ctx)
        if math.isnan(found) or (self._finite and math.isinf(found)):
            self.fail(f"{value} is not a {'finite ' if self._finite else ''}number", param, ctx)
        return found
