# SPDX-License-Identifier: GPL-3.0-or-later
"""Ranges: full density where a quantity is inside, less beside it."""

import math
from dataclasses import dataclass

import numpy as np

from .arrays import Flags, Floats


def window(values: Floats, low: float, high: float, falloff: float) -> Floats:
    """1 from low to high, falling to 0 over the length of the falloff on either side."""
    outside = np.maximum(low - values, values - high)
    if falloff <= 0.0:
        return (outside <= 0.0).astype(np.float64)
    return np.clip(1.0 - outside / falloff, 0.0, 1.0)


@dataclass(frozen=True)
class Range:
    """How a quantity becomes a factor of the density, in the quantity's own unit.

    low, high: full density from low to high, both included; infinite: no limit on that side.
    falloff: >= 0, the difference from the range over which the density falls to 0.
    invert: full density outside of the range instead of inside.
    strength: 0 to 1, how much the range counts; at 0 it has no effect.

    Raises:
        ValueError: naming the member that is out of its range.
    """

    low: float = -math.inf
    high: float = math.inf
    falloff: float = 0.0
    invert: bool = False
    strength: float = 1.0

    def __post_init__(self) -> None:
        if math.isnan(self.low) or math.isnan(self.high):
            raise ValueError(f"low {self.low} and high {self.high} must be numbers")
        if not 0.0 <= self.falloff < math.inf:
            raise ValueError(f"falloff is {self.falloff}: it must be finite and at least 0")
        if not 0.0 <= self.strength <= 1.0:
            raise ValueError(f"strength is {self.strength}: it must be from 0 to 1")

    def factors(self, values: Floats) -> Floats:
        """Factors of the density for these values, in their shape: 1 in the range."""
        found = window(values, self.low, self.high, self.falloff)
        if self.invert:
            found = 1.0 - found
        return found if self.strength >= 1.0 else 1.0 - self.strength * (1.0 - found)

    def varies(self, least: Floats, most: Floats) -> Flags:
        """Whether factors may differ for values from least to most, arrays of one shape."""
        rises = (least < self.low) & (most >= self.low - self.falloff)
        falls = (least <= self.high + self.falloff) & (most > self.high)
        found: Flags = rises | falls
        return found
