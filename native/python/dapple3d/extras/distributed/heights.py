# SPDX-License-Identifier: GPL-3.0-or-later
"""Terrains: heights on a grid, in memory or in files that are read piece by piece."""

import math
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .digests import of_grid
from .patches import Floats, Patch, check_density, check_real


class Grid(Protocol):
    """Numbers in rows and columns: an array, a memory map, an array of Zarr."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Rows and columns."""

    def __getitem__(self, key: tuple[slice, slice], /) -> Any:
        """Some of them."""


@dataclass(frozen=True)
class HeightField:
    """A terrain: the height at row r and column c is that of the point
    (origin[0] + c * step[0], origin[1] + r * step[1]). Between four neighbors are two faces; there
    are none beside heights that are not finite.

    heights: (rows, columns), read in pieces.
    density: as many numbers >= 0, samples per area in relation; None is the same everywhere.
    """

    heights: Grid
    step: tuple[float, float] = (1.0, 1.0)
    origin: tuple[float, float] = (0.0, 0.0)
    density: Grid | None = None
    name: str = ""
    axes: tuple[int, int] = field(default=(1, 0), init=False)

    def __post_init__(self) -> None:
        shape = tuple(self.heights.shape)
        if len(shape) != 2 or min(shape) < 2:
            raise ValueError(
                f"heights has the shape {shape}: at least 2 rows and columns are needed"
            )
        if self.density is not None and tuple(self.density.shape) != shape:
            raise ValueError(f"density has the shape {self.density.shape}, but heights has {shape}")
        for name, grid in (("heights", self.heights), ("density", self.density)):
            if grid is not None:
                check_real(name, getattr(grid, "dtype", np.float64))
        if len(self.step) != 2 or not all(math.isfinite(s) and s != 0.0 for s in self.step):
            raise ValueError(f"step is {self.step}: two finite numbers that are not 0 are needed")
        if len(self.origin) != 2 or not all(map(math.isfinite, self.origin)):
            raise ValueError(f"origin is {self.origin}: two finite numbers are needed")

    @property
    def face_count(self) -> int:
        """Two triangles between each four heights, next to missing heights too."""
        rows, columns = self.heights.shape
        return 2 * (rows - 1) * (columns - 1)

    def lines(self, rows: int, columns: int) -> tuple[Floats, Floats]:
        """Borders between tiles, through heights; fewer if the grid has fewer rows or columns."""
        return self._lines(1, 0, rows), self._lines(0, 1, columns)

    def _lines(self, axis: int, side: int, wanted: int) -> Floats:
        cells = self.heights.shape[side] - 1
        count = min(wanted, cells)
        nodes = np.arange(count + 1) * cells // count
        return np.sort(self.origin[axis] + nodes * self.step[axis])

    def read(self, rows: tuple[float, float], columns: tuple[float, float]) -> Patch:
        """The faces between the borders, and some beside them."""
        r, c = self._nodes(1, 0, rows), self._nodes(0, 1, columns)
        heights = np.asarray(self.heights[r, c], np.float64)
        x = self.origin[0] + np.arange(c.start, c.stop) * self.step[0]
        y = self.origin[1] + np.arange(r.start, r.stop) * self.step[1]
        places = np.broadcast_arrays(x[None, :], y[:, None], heights)
        there = np.isfinite(heights)
        faces = _grid_faces(*heights.shape, turned=self.step[0] * self.step[1] < 0.0)
        patch = Patch(
            np.stack([p.ravel() for p in places], axis=1),
            faces,
            self._ids(r, c),
            self._density(r, c, there),
        )
        return patch.only(np.all(there.ravel()[faces], axis=1))

    def _nodes(self, axis: int, side: int, border: tuple[float, float]) -> slice:
        """Rows or columns of heights that reach over both borders."""
        most = self.heights.shape[side] - 1
        ends = sorted((b - self.origin[axis]) / self.step[axis] for b in border)
        first = math.floor(max(ends[0], 0.0)) - 1
        last = math.ceil(min(ends[1], float(most))) + 1
        first = min(max(first, 0), most - 1)
        return slice(first, max(min(last, most), first + 1) + 1)

    def _ids(self, r: slice, c: slice) -> NDArray[np.int64]:
        cells = np.arange(r.start, r.stop - 1)[:, None] * (self.heights.shape[1] - 1)
        cells = (cells + np.arange(c.start, c.stop - 1)).ravel()
        return (2 * cells[:, None] + np.arange(2)).ravel().astype(np.int64)

    def _density(self, r: slice, c: slice, there: NDArray[np.bool_]) -> Floats | None:
        """Checked where there are heights.

        Args:
            there: of which heights.
        """
        if self.density is None:
            return None
        density = np.asarray(self.density[r, c], np.float64)
        check_density(density, (r.start, c.start), there)
        return density.ravel()

    def describe(self) -> dict[str, Any]:
        """What tells it from another terrain; all numbers are read for their digests."""
        grids = {"heights": self.heights, "density": self.density}
        return {
            "kind": "heights",
            "name": self.name,
            "shape": [int(n) for n in self.heights.shape],
            "step": [float(s) for s in self.step],
            "origin": [float(o) for o in self.origin],
            "density": self.density is not None,
            "content": {name: of_grid(grid) for name, grid in grids.items() if grid is not None},
        }


def _grid_faces(rows: int, columns: int, *, turned: bool) -> NDArray[np.int32]:
    """Two faces between four nodes, seen counterclockwise from above; turned if a step is < 0."""
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    across, beside, below = corner + columns + 1, corner + 1, corner + columns
    lower, upper = (corner, beside, across), (corner, across, below)
    if turned:
        lower, upper = lower[::-1], upper[::-1]
    pairs = np.stack([np.stack(lower, axis=1), np.stack(upper, axis=1)], axis=1)
    return pairs.reshape(-1, 3).astype(np.int32)
