# SPDX-License-Identifier: GPL-3.0-or-later
"""How a surface is cut into tiles, and which work needs which other work.

Each tile is solved alone first. Along its border the points then are those of a surface that ends
there, so that band is solved again, between what lies on both sides of it: along the seams of two
tiles first, then around the corners where four meet. All zones are rectangles along two axes; a
face is in the zone that its middle is in.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .patches import Floats, Patch, middles

# In units, which are spacings where points are sparse:
FRESH = 5.0  # half the width of the band that gets new points: no trace of a border reaches farther
YIELD = 3.0  # beside it the points stay for a start, and may move until they go well with the new
SEAM = FRESH + YIELD  # half the width of the band that is solved again
LOCKED = 4.0  # the points beside it that hold it; the cells of the nearest of them are whole
CORNER = SEAM + LOCKED  # where a seam ends, so that it holds no points that another seam moves
TOUCH = 1.25  # how far a point that stays keeps new ones at a distance
AROUND = CORNER + LOCKED  # half the side of the square at a corner: it takes in the ends of seams
NARROWEST = 2.0 * (AROUND + LOCKED)  # a tile, so that the squares at its corners stay apart

Kind = Literal["first", "across", "along", "corner", "tile"]
KINDS: tuple[Kind, ...] = ("first", "across", "along", "corner", "tile")
BESIDE: dict[Kind, str] = {  # the part of a tile that is solved, in messages
    "across": "the seam to the column after",
    "along": "the seam to the row after",
    "corner": "the corner after",
}
INFINITE = float("inf")
Span = tuple[float, float]


class Job(NamedTuple):
    """One piece of work.

    first: a tile alone. across: the seam between the columns c and c + 1. along: the seam between
    the rows r and r + 1. corner: where the rows r and r + 1 meet the columns c and c + 1. tile:
    what has become of a tile.
    """

    kind: Kind
    row: int
    column: int

    @property
    def name(self) -> str:
        """For files and tasks."""
        return f"{self.kind}-{self.row:04d}-{self.column:04d}"

    @property
    def place(self) -> str:
        """For messages: the tile by the name of its file."""
        tile = self._replace(kind="tile").name
        return f"{BESIDE[self.kind]} {tile}" if self.kind in BESIDE else tile


@dataclass(frozen=True)
class Zone:
    """A rectangle along the axes of rows and columns."""

    rows: Span
    columns: Span

    def holds(self, patch: Patch, axes: tuple[int, int]) -> NDArray[np.bool_]:
        """Which faces have their middle in it."""
        inside = np.ones(len(patch.faces), np.bool_)
        for axis, (start, end) in zip(axes, (self.rows, self.columns), strict=True):
            middle = middles(patch, axis)
            inside &= (middle >= start) & (middle < end)
        return inside

    def grown(self, margin: float) -> "Zone":
        """With so much more on each side."""
        rows, columns = ((a - margin, b + margin) for a, b in (self.rows, self.columns))
        return Zone(rows, columns)


@dataclass(frozen=True)
class Layout:
    """Tiles between lines, and the unit of the zones along them.

    rows, columns: (r + 1,) and (c + 1,), increasing. axes: the coordinates they are of.
    """

    rows: Floats
    columns: Floats
    unit: float
    axes: tuple[int, int]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of tiles."""
        return len(self.rows) - 1, len(self.columns) - 1

    def tiles(self) -> Iterator[tuple[int, int]]:
        """Row by row."""
        return ((r, c) for r in range(self.shape[0]) for c in range(self.shape[1]))

    def free(self, job: Job) -> Zone:
        """Where points may move."""
        return self._zone(job, 0.0)

    def fresh(self, job: Job) -> Zone:
        """Where all points are new ones."""
        return self._zone(job, YIELD)

    def _zone(self, job: Job, less: float) -> Zone:
        kind, r, c = job
        seam, around = (SEAM - less) * self.unit, (AROUND - less) * self.unit
        match kind:
            case "across":
                return Zone(self._inner(self.rows, r), _around(self.columns[c + 1], seam))
            case "along":
                return Zone(_around(self.rows[r + 1], seam), self._inner(self.columns, c))
            case "corner":
                rows = _around(self.rows[r + 1], around)
                return Zone(rows, _around(self.columns[c + 1], around))
        return Zone(_span(self.rows, r), _span(self.columns, c))

    def part(self, job: Job) -> Zone:
        """The part of the surface that the job reads."""
        alone = job.kind in ("first", "tile")
        return self.free(job) if alone else self.free(job).grown(LOCKED * self.unit)

    def _inner(self, lines: Floats, k: int) -> Span:
        """A row or column without the corners at its ends."""
        start, end = _span(lines, k)
        return start + CORNER * self.unit, end - CORNER * self.unit

    def needs(self, job: Job) -> list[Job]:
        """The work whose results a job begins with, each before what may replace a part of it."""
        kind, r, c = job
        match kind:
            case "first":
                return []
            case "across":
                return [Job("first", r, c), Job("first", r, c + 1)]
            case "along":
                return [Job("first", r, c), Job("first", r + 1, c)]
            case "corner":
                firsts = [Job("first", r + a, c + b) for a in (0, 1) for b in (0, 1)]
                across = [Job("across", r + a, c) for a in (0, 1)]
                return firsts + across + [Job("along", r, c + b) for b in (0, 1)]
        found = [Job("first", r, c), Job("across", r, c - 1), Job("across", r, c)]
        found += [Job("along", r - 1, c), Job("along", r, c)]
        found += [Job("corner", r - a, c - b) for a in (1, 0) for b in (1, 0)]
        return [needed for needed in found if self.has(needed)]

    def has(self, job: Job) -> bool:
        """Whether there is such work: a seam has a tile on both sides."""
        rows, columns = self.shape
        last_row = rows - (job.kind in ("along", "corner"))
        last_column = columns - (job.kind in ("across", "corner"))
        return 0 <= job.row < last_row and 0 <= job.column < last_column


def unit_within(rows: Floats, columns: Floats, wanted: float) -> float:
    """The unit, or less where tiles are so small that zones would meet."""
    narrowest = min(float(np.diff(lines).min()) for lines in (rows, columns))
    return min(wanted, narrowest / NARROWEST)


def _span(lines: Floats, k: int) -> Span:
    """From a line to the next; the first and the last reach on for ever."""
    start = -INFINITE if k == 0 else float(lines[k])
    return start, INFINITE if k == len(lines) - 2 else float(lines[k + 1])


def _around(line: float, reach: float) -> Span:
    return float(line) - reach, float(line) + reach
