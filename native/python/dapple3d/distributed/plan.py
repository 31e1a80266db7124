# SPDX-License-Identifier: GPL-3.0-or-later
"""What is decided before the first tile: where the tiles are, and how many points each begins with.

The plan lies in the folder of the tiles. Work on them takes all it needs from there, today or when
it goes on tomorrow.
"""

import json
import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..writing import replacing
from .layout import KINDS, Job, Layout, unit_within
from .patches import BINS, Census, Floats

FORMAT = 1
SPARSE = 0.02  # the share of the points that may lie where the unit of zones is less than a spacing
WIDEST_FACE = 0.25  # units that the largest face needs to be


@dataclass(frozen=True)
class Plan:
    """The tiles of a surface and the points that each begins with.

    counts: (rows, columns) int64. settings: what else decides the points, for JSON.
    """

    layout: Layout
    counts: NDArray[np.int64]
    seed: int
    options: dict[str, Any]
    surface: dict[str, Any]
    tile: int

    @property
    def total(self) -> int:
        """Points on the whole surface."""
        return int(self.counts.sum())

    def ids(self, job: Job) -> NDArray[np.int64]:
        """Of the points that a tile begins with."""
        place = job.row * self.layout.shape[1] + job.column
        start = int(self.counts.ravel()[:place].sum())
        return np.arange(start, start + self.counts[job.row, job.column])

    def seed_of(self, job: Job) -> int:
        """A seed of its own for each job."""
        numbers = [self.seed, KINDS.index(job.kind), job.row, job.column]
        return int(np.random.SeedSequence(numbers).generate_state(1)[0])

    def settings(self) -> dict[str, Any]:
        """What a run that goes on needs to have in common with the one that began."""
        return {
            "format": FORMAT,
            "count": self.total,
            "seed": self.seed,
            "tile": self.tile,
            "options": self.options,
            "surface": self.surface,
        }

    def write(self, path: Path) -> None:
        """Store the plan, whole or not at all."""
        layout = self.layout
        document = self.settings() | {
            "rows": layout.rows.tolist(),
            "columns": layout.columns.tolist(),
            "axes": list(layout.axes),
            "unit": layout.unit,
            "counts": self.counts.tolist(),
        }
        with replacing(path) as file:
            file.write((json.dumps(document, indent=1) + "\n").encode())


def read_plan(path: Path) -> Plan:
    """The plan in a folder of tiles.

    Raises:
        ValueError: it is of another version.
        OSError: there is none.
    """
    document = json.loads(path.read_text(encoding="utf-8"))
    if document.get("format") != FORMAT:
        raise ValueError(f"{path}: is of another version of dapple3d")
    rows, columns = np.array(document["rows"]), np.array(document["columns"])
    first, second = document["axes"]
    layout = Layout(rows, columns, document["unit"], (first, second))
    counts = np.array(document["counts"], np.int64)
    kept = {name: document[name] for name in ("seed", "options", "surface", "tile")}
    return Plan(layout, counts, **kept)


def shape_for(tiles: float, lengths: tuple[float, float]) -> tuple[int, int]:
    """Rows and columns of about so many tiles that are nearly square."""
    rows = max(1, round(math.sqrt(tiles * lengths[0] / lengths[1])))
    return rows, max(1, round(tiles / rows))


def allot(masses: Floats, count: int) -> NDArray[np.int64]:
    """So many points for each tile that all of them are the count, by the masses.

    No tile is off its share by a point or more, nor is any run of tiles in the order in which an ox
    plows: what one tile has too much its neighbor has too little.
    """
    turned = masses.copy()
    turned[1::2] = turned[1::2, ::-1]
    sums = list(accumulate(turned.ravel().tolist(), initial=0.0))
    if not sums[-1] > 0.0:
        raise ValueError("the surface has no face with an area and a density above 0")
    reached = np.array([round(count * (s / sums[-1])) for s in sums], np.int64)
    counts = (reached[1:] - reached[:-1]).reshape(masses.shape)
    counts[1::2] = counts[1::2, ::-1].copy()
    return counts


def unit_of(found: Sequence[Census], count: int) -> float:
    """The spacing where points are sparse, or more if faces are large."""
    histogram = [math.fsum(masses) for masses in zip(*(c.histogram for c in found), strict=True)]
    mass = math.fsum(histogram)
    below = bisect_left(list(accumulate(histogram)), SPARSE * mass)
    density = float(BINS[max(below - 1, 0)])
    spacing = math.sqrt(2.0 / math.sqrt(3.0) * mass / count / density)
    return max(spacing, WIDEST_FACE * max(c.extent for c in found))


def layout_for(
    lines: tuple[Floats, Floats], axes: tuple[int, int], found: Sequence[Census], count: int
) -> Layout:
    """Tiles between lines, with seams as wide as the points ask for."""
    return Layout(*lines, unit_within(*lines, unit_of(found, count)), axes)
