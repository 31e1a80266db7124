# SPDX-License-Identifier: GPL-3.0-or-later
"""How a result came about and how its spacings lie, as lists small enough to be stored with it."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.native import package
from ..surface.arrays import Floats

BINS = 24
_MOST, _MOST_GAP = 100_000, 2**31  # energies, and points of a bin: more cannot be
FARTHEST = 1.2  # of the local spacing: the last bin's end


@dataclass(frozen=True)
class Details:
    """Of one optimization."""

    energies: tuple[float, ...] = ()  # normalized, at the start and after each iteration
    gaps: tuple[int, ...] = ()  # points by the distance to their nearest, in BINS up to FARTHEST

    def text(self) -> str:
        """As it is stored."""
        return json.dumps({"energies": self.energies, "gaps": self.gaps})


def details_from(text: str) -> Details:
    """From what text() has written; nothing where it is something else."""
    try:
        stored = json.loads(text)
        found = Details(tuple(map(float, stored["energies"])), tuple(map(int, stored["gaps"])))
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
        return Details()
    whole = len(found.energies) <= _MOST and len(found.gaps) <= BINS
    sane = np.isfinite(found.energies).all() and all(0 <= gap <= _MOST_GAP for gap in found.gaps)
    return found if whole and sane else Details()


def details_of(samples: Any, density: Floats) -> Details:
    """Of dapple.Samples with this density (n,) at each."""
    report = samples.report
    distances = package().nearest_distances(samples.positions) * np.sqrt(density)
    distances = distances / max(report.spacing, 1e-300)
    counts, _ = np.histogram(np.minimum(distances, FARTHEST), BINS, (0.0, FARTHEST))
    return Details(tuple(report.energies), tuple(counts.tolist()))
