# SPDX-License-Identifier: GPL-3.0-or-later
"""What masks have in common: full density in a range of values, less beside it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .surface import Floats

Flags = NDArray[np.bool_]


def window(values: Floats, low: float, high: float, fade: float) -> Floats:
    """1 from low to high, falling to 0 over the length fade on either side."""
    outside = np.maximum(low - values, values - high)
    if fade <= 0.0:
        return (outside <= 0.0).astype(np.float64)
    return np.clip(1.0 - outside / fade, 0.0, 1.0)


@dataclass(frozen=True)
class Mask:
    """How values become factors of the density."""

    low: float
    high: float
    fade: float
    invert: bool = False
    strength: float = 1.0

    def factors(self, values: Floats) -> Floats:
        """1 in the range; beside it less by the strength."""
        found = window(values, self.low, self.high, self.fade)
        if self.invert:
            found = 1.0 - found
        return found if self.strength >= 1.0 else 1.0 - self.strength * (1.0 - found)

    def falls(self, least: Floats, most: Floats) -> Flags:
        """Whether factors are not the same for all values from least to most."""
        rises = (least < self.low) & (most >= self.low - self.fade)
        falls = (least <= self.high + self.fade) & (most > self.high)
        found: Flags = rises | falls
        return found


def mask_of(settings: Any, name: str) -> Mask | None:
    """The mask of that name of DensitySettings; None where it has no effect."""
    strength = getattr(settings, f"{name}_strength")
    if not getattr(settings, f"use_{name}") or strength <= 0.0:
        return None
    low, high, fade = (getattr(settings, f"{name}_{of}") for of in ("from", "to", "fade"))
    return Mask(low, high, fade, getattr(settings, f"{name}_invert"), strength)
