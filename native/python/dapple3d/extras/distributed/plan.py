# SPDX-License-Identifier: GPL-3.0-or-later
"""What is decided before the first tile: where the tiles are, and how many points each begins with.

The plan lies in the folder of the tiles. Work on them takes all it needs from there, today or when
it goes on tomorrow.
"""

import json
import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...reading import BROKEN
from ...writing import replacing
from .digests import of_document
from .layout import KINDS, Job, Layout, unit_within
from .patches import BINS, Census, Floats

FORMAT = 2
SPARSE = 0.02  # the share of the points that may lie where the unit of zones is less than a spacing
WIDEST_FACE = 0.25  # units that the largest face needs to be


@dataclass(frozen=True)
class Plan:
    """The tiles of a surface and the points that each begins with.

    counts: (rows, columns) int64. patches: of each tile the digest of its part of the surface.
    """

    layout: Layout
    counts: NDArray[np.int64]
    seed: int
    options: dict[str, Any]
    surface: dict[str, Any]
    tile: int
    patches: list[str]

    @property
    def total(self) -> int:
        """Points on the whole surface."""
        return int(self.counts.sum())

    def ids(self, job: Job) -> NDArray[np.int64]:
        """Ids of the points that a tile begins with."""
        place = job.row * self.layout.shape[1] + job.column
        start = int(self.counts.ravel()[:place].sum())
        return np.arange(start, start + self.counts[job.row, job.column])

    def seed_of(self, job: Job) -> int:
        """A seed of its own for each job."""
        numbers = [self.seed, KINDS.index(job.kind), job.row, job.column]
        return int(np.random.SeedSequence(numbers).generate_state(1)[0])

    def patch_of(self, job: Job) -> str:
        """The digest of a tile's part of the surface."""
        return self.patches[job.row * self.layout.shape[1] + job.column]

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

    def document(self) -> dict[str, Any]:
        """All of it, for JSON."""
        layout = self.layout
        return self.settings() | {
            "rows": layout.rows.tolist(),
            "columns": layout.columns.tolist(),
            "axes": list(layout.axes),
            "unit": layout.unit,
            "counts": self.counts.tolist(),
            "patches": self.patches,
        }

    @cached_property
    def digest(self) -> str:
        """What tells it from another one, but for the surface's name."""
        return _digest(self.document())

    def write(self, path: Path) -> None:
        """Store the plan, whole or not at all."""
        document = self.document() | {"digest": self.digest}
        with replacing(path) as file:
            file.write((json.dumps(document, indent=1) + "\n").encode())


def read_plan(path: Path) -> Plan:
    """The plan in a folder of tiles.

    Raises:
        ValueError: it is damaged, changed or of another version: naming the first entry.
        OSError: there is none.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        _check(document)
    except BROKEN as error:
        reason = " ".join(str(error).split())
        raise ValueError(
            f"{path}: cannot be used: {reason}; remove it, and the same call makes it again"
        ) from error
    rows, columns = np.array(document["rows"], float), np.array(document["columns"], float)
    first, second = document["axes"]
    layout = Layout(rows, columns, document["unit"], (first, second))
    counts = np.array(document["counts"], np.int64)
    kept = {name: document[name] for name in ("seed", "options", "surface", "tile", "patches")}
    return Plan(layout, counts, **kept)


def _check(document: Any) -> None:
    """Refuse what is not the document of a plan.

    Raises:
        ValueError: naming the first entry that is missing or wrong.
    """
    if not isinstance(document, dict):
        raise ValueError(f"it holds {_shown(document)} instead of the entries of a plan")
    if document.get("format") != FORMAT:
        raise ValueError(f"'format' is {_shown(document.get('format'))}: this version has {FORMAT}")
    for name, (fits, rule) in ENTRIES.items():
        if name not in document:
            raise ValueError(f"'{name}' is missing")
        if not fits(document[name]):
            raise ValueError(f"'{name}' is {_shown(document[name])}: {rule}")
    _check_tiles(document)
    if document["digest"] != _digest(document):
        raise ValueError("'digest' is not that of the other entries: one of them was changed")


def _digest(document: dict[str, Any]) -> str:
    surface = {name: value for name, value in document["surface"].items() if name != "name"}
    return of_document(document | {"surface": surface})


def _check_tiles(document: dict[str, Any]) -> None:
    """Whether there is a count and a digest for each tile between the lines."""
    rows, columns = len(document["rows"]) - 1, len(document["columns"]) - 1
    counts, patches = document["counts"], document["patches"]
    if len(counts) != rows or any(len(row) != columns for row in counts):
        raise ValueError(f"'counts' has {len(counts)} rows: {rows} of {columns} are needed")
    if len(patches) != rows * columns:
        raise ValueError(f"'patches' has {len(patches)} texts: {rows * columns} are needed")
    total = sum(map(sum, counts))
    if total != document["count"]:
        raise ValueError(f"'counts' has the sum {total}, but 'count' is {document['count']}")


def _shown(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def _is_whole(value: Any, bits: int = 48) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 1 << bits


def _is_finite(value: Any) -> bool:
    return isinstance(value, int | float) and abs(value) < 1e300


def _are_lines(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) > 1
        and all(map(_is_finite, value))
        and all(a < b for a, b in pairwise(value))
    )


def _are_axes(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(one in (0, 1, 2) for one in value)


def _are_counts(value: Any) -> bool:
    return isinstance(value, list) and all(
        isinstance(row, list) and all(map(_is_whole, row)) for row in value
    )


WHOLE = (_is_whole, "a whole number is needed")
TABLE = (lambda value: isinstance(value, dict), "names and values are needed")
LINES = (_are_lines, "two growing numbers or more are needed")
ENTRIES: dict[str, tuple[Callable[[Any], bool], str]] = {
    **{"count": WHOLE, "tile": WHOLE, "options": TABLE, "surface": TABLE},
    "seed": (lambda value: _is_whole(value, 64), WHOLE[1]),
    **{"rows": LINES, "columns": LINES},
    "axes": (_are_axes, "two of 0, 1 and 2 are needed"),
    "unit": (lambda value: _is_finite(value) and value > 0, "a number > 0 is needed"),
    "counts": (_are_counts, "rows of whole numbers are needed"),
    "patches": (
        lambda value: isinstance(value, list) and all(isinstance(one, str) for one in value),
        "texts are needed",
    ),
    "digest": (lambda value: isinstance(value, str), "a text is needed"),
}


def shape_for(tiles: float, lengths: tuple[float, float]) -> tuple[int, int]:
    """Rows and columns of about so many nearly square tiles."""
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
    capacity = math.fsum(histogram)
    below = bisect_left(list(accumulate(histogram)), SPARSE * capacity)
    density = float(BINS[max(below - 1, 0)])
    spacing = math.sqrt(2.0 / math.sqrt(3.0) * capacity / count / density)
    return max(spacing, WIDEST_FACE * max(c.extent for c in found))


def layout_for(
    lines: tuple[Floats, Floats], axes: tuple[int, int], found: Sequence[Census], count: int
) -> Layout:
    """Tiles between lines, with seams as wide as the points ask for."""
    return Layout(*lines, unit_within(*lines, unit_of(found, count)), axes)
