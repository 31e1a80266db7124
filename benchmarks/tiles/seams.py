# SPDX-License-Identifier: GPL-3.0-or-later
"""How even points are beside seams, next to those of one solution at the same places."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

import dapple3d as dapple
import numpy as np
from dapple3d.extras.distributed import HeightField, Tiles, sample_tiles
from numpy.typing import NDArray
from scipy.spatial import Delaunay  # type: ignore[import-untyped]

from benchmarks.compare.tables import say
from benchmarks.tiles.terrain import hills, side_for

BESIDE = 8.0  # spacings from a seam
HEAD = ["tiles", "place", "points", "capacity variation", "alpha min", "psi6"]
TILES, ONE = "tiles", "one solution"
RATIO_HEAD = ["tiles", "place", "capacity variation", "alpha min", "psi6"]
Figures = tuple[float, float, float]


@dataclass(frozen=True)
class Compared:
    """Figures of all seeds by place and way."""

    tiles: int
    found: dict[tuple[str, str], list[Figures]]

    def rows(self) -> list[list[str]]:
        """Beside seams and elsewhere, of both: medians over seeds, least and most."""
        shape = f"{self.tiles} x {self.tiles}"
        return [
            [shape, place, way, *(spread(values) for values in zip(*runs, strict=True))]
            for (place, way), runs in sorted(self.found.items())
        ]

    def ratios(self) -> list[list[str]]:
        """How means of the tiles stand to those of one solution."""
        shape = f"{self.tiles} x {self.tiles}"
        return [
            [shape, place, *self._ratios_at(place)] for place in sorted({p for p, _ in self.found})
        ]

    def _ratios_at(self, place: str) -> list[str]:
        columns = (zip(*self.found[place, way], strict=True) for way in (TILES, ONE))
        return [ratio(ours, theirs) for ours, theirs in zip(*columns, strict=True)]


def compare(tiles: int, count: int, seeds: int) -> Compared:
    """Measure tiles and one solution."""
    side = np.arange(side_for(2 * count), dtype=np.float64)
    field = HeightField(hills(side, side))
    patch = field.read((-np.inf, np.inf), (-np.inf, np.inf))
    surface = dapple.Surface(patch.vertices, patch.faces)
    found: dict[tuple[str, str], list[Figures]] = {}
    for seed in range(seeds):
        say(f"{tiles} x {tiles} tiles, seed {seed}")
        with tempfile.TemporaryDirectory() as folder:
            done = sample_tiles(field, folder, count, tile=count // tiles**2, seed=seed)
            if done.shape != (tiles, tiles):
                raise ValueError(f"{done.shape} tiles were made")
            ways = {
                TILES: bound(surface, done),
                ONE: dapple.sample(surface, count, seed=seed),
            }
            lines = (done.plan().layout.rows, done.plan().layout.columns)
        for way, samples in ways.items():
            for place, figures in measured(surface, samples, lines).items():
                found.setdefault((place, way), []).append(figures)
    return Compared(tiles, found)


def bound(surface: dapple.Surface, tiles: Tiles) -> dapple.Samples:
    """The points of all tiles on the surface as a whole."""
    parts = list(tiles.tiles())
    faces = np.concatenate([part.faces for part in parts]).astype(np.int32)
    return dapple.Samples(surface, faces, np.concatenate([part.barycentric for part in parts]))


def measured(
    surface: dapple.Surface,
    samples: dapple.Samples,
    lines: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> dict[str, Figures]:
    """Capacity variation, alpha min and psi6 beside seams and elsewhere, far from the border."""
    spacing, count = surface.spacing(len(samples)), len(samples)
    owned = dapple.evaluate_energy(surface, samples.positions, samples.faces).capacities
    relative = owned / (surface.capacity / count)
    alphas = dapple.nearest_distances(samples.positions) / spacing
    orders = bond_orders(samples.positions)
    x, y = samples.positions[:, 0], samples.positions[:, 1]
    beside, inside = np.zeros(count, bool), np.ones(count, bool)
    for values, ends in ((y, lines[0]), (x, lines[1])):
        inside &= (values > ends[0] + BESIDE * spacing) & (values < ends[-1] - BESIDE * spacing)
        for line in ends[1:-1]:
            beside |= np.abs(values - line) < BESIDE * spacing
    places = {"beside seams": beside & inside, "elsewhere": ~beside & inside}
    return {
        place: (float(relative[at].std()), float(alphas[at].min()), float(orders[at].mean()))
        for place, at in places.items()
    }


def bond_orders(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """psi6 of each point, seen from above."""
    starts, others = Delaunay(positions[:, :2]).vertex_neighbor_vertices
    counts = np.diff(starts)
    own = np.repeat(np.arange(len(positions)), counts)
    ways = positions[others, :2] - positions[own, :2]
    turns = np.exp(6j * np.arctan2(ways[:, 1], ways[:, 0]))
    sums = np.zeros(len(positions), complex)
    np.add.at(sums, own, turns)
    orders: NDArray[np.float64] = np.abs(sums / counts)
    return orders


def spread(values: Sequence[float]) -> str:
    """The median, with the least and the most."""
    return f"{median(values):.4f} ({min(values):.4f} to {max(values):.4f})"


def ratio(ours: Sequence[float], theirs: Sequence[float]) -> str:
    """That of two means, with its standard error."""
    means, errors = [], []
    for values in (ours, theirs):
        means.append(np.mean(values))
        errors.append(np.std(values, ddof=1) / len(values) ** 0.5 / means[-1])
    quotient = means[0] / means[1]
    return f"{quotient:.3f} ± {quotient * np.hypot(*errors):.3f}"
