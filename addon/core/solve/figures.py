# SPDX-License-Identifier: GPL-3.0-or-later
"""Convergence and spacing of a result, as lists that are small enough to be stored with it."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.native import package
from ..surface.arrays import Floats

BINS = 24
_MOST, _MOST_GAP = 100_000, 2**31  # limits for the number of energies and for a bin
FARTHEST = 1.2  # end of the last bin, relative to the local spacing


@dataclass(frozen=True)
class Details:
    """Energies and spacings of one optimization."""

    energies: tuple[float, ...] = ()  # normalized, at the start and after each iteration
    gaps: tuple[int, ...] = ()  # histogram of the distance to the nearest point, up to FARTHEST

    def text(self) -> str:
        """The text that is stored."""
        return json.dumps({"energies": self.energies, "gaps": self.gaps})


def details_from(text: str) -> Details:
    """The details stored in a text; empty if it is invalid."""
    try:
        stored = json.loads(text)
        found = Details(tuple(map(float, stored["energies"])), tuple(map(int, stored["gaps"])))
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
        return Details()
    whole = len(found.energies) <= _MOST and len(found.gaps) <= BINS
    sane = np.isfinite(found.energies).all() and all(0 <= gap <= _MOST_GAP for gap in found.gaps)
    return found if whole and sane else Details()


def details_of(samples: Any, density: Floats) -> Details:
    """The details of dapple.Samples with a density (n,) at each."""
    report = samples.report
    distances = package().nearest_distances(samples.positions) * np.sqrt(density)
    distances = distances / max(report.spacing, 1e-300)
    counts, _ = np.histogram(np.minimum(distances, FARTHEST), BINS, (0.0, FARTHEST))
    return Details(tuple(report.energies), tuple(counts.tolist()))
