# SPDX-License-Identifier: GPL-3.0-or-later
"""How a result came about and how its spacings lie, as lists small enough to be stored with it."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from .native import package
from .surface import Floats

BINS = 24
FARTHEST = 1.2  # of the local spacing: the last bin's end


@dataclass(frozen=True)
class Details:
    """Of one optimisation."""

    energies: tuple[float, ...] = ()  # normalised, at the start and after each iteration
    gaps: tuple[int, ...] = ()  # points by the distance to their nearest, in BINS up to FARTHEST

    def text(self) -> str:
        """As it is stored."""
        return json.dumps({"energies": self.energies, "gaps": self.gaps})


def details_from(text: str) -> Details:
    """What text() told; nothing where it is not that."""
    try:
        stored = json.loads(text)
        return Details(tuple(map(float, stored["energies"])), tuple(map(int, stored["gaps"])))
    except (ValueError, TypeError, KeyError):
        return Details()


def details_of(samples: Any, density: Floats) -> Details:
    """Of dapple.Samples with this density (n,) at each."""
    report = samples.report
    distances = package().nearest_distances(samples.positions) * np.sqrt(density)
    distances = distances / max(report.spacing, 1e-300)
    counts, _ = np.histogram(np.minimum(distances, FARTHEST), BINS, (0.0, FARTHEST))
    return Details(tuple(report.energies), tuple(counts.tolist()))
