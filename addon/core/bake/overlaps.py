# SPDX-License-Identifier: GPL-3.0-or-later
"""The largest overlaps of discs around the points of a bake, for each object type.

Frames between keyframes count as they are played: there the points are mixed, and nothing keeps
their discs apart.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..surface.arrays import Floats, Ints, normals_of
from ..surface.records import Placed

SAME_SIDE = -0.5  # cosine between the normals of two points: others lie on two sides of a sheet
_AROUND = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
_LIMIT = 1 << 20  # cells of a grid along each axis


@dataclass(frozen=True)
class Overlap:
    """The pair of discs that overlaps most: 1 - distance / sum of the radii; 0 if none does."""

    share: float = 0.0
    frame: int = 0
    between: bool = False  # whether the frame is no keyframe
    ids: tuple[int, int] = (-1, -1)


@dataclass(frozen=True)
class Discs:
    """Points of a frame with the radii of their discs."""

    points: Floats  # (n, 3)
    normals: Floats  # (n, 3)
    radii: Floats  # (n,); a point without a radius is kept out of the discs of others
    classes: Ints  # (n,)
    ids: Ints  # (n,)

    def worst(self, count: int) -> tuple[Floats, Ints]:
        """For each of `count` classes the largest overlap of one of its discs, and the rows of the
        two points (count, 2); -1 if there is none.
        """
        shares, rows = np.zeros(count), np.full((count, 2), -1)
        pairs, overlaps = self.overlapping()
        kinds = self.classes[pairs.T.ravel()]
        found = np.tile(np.arange(len(pairs)), 2)
        order = np.argsort(overlaps[found], kind="stable")  # of a class the last one is assigned
        shares[kinds[order]] = overlaps[found[order]]
        rows[kinds[order]] = pairs[found[order]]
        return shares, rows

    def overlapping(self) -> tuple[Ints, Floats]:
        """Rows (k, 2) of the pairs that overlap on one side of the surface, and by which shares."""
        pairs = np.concatenate([np.empty((0, 2), dtype=np.int64), *self._pairs()])
        first, second = pairs.T
        apart = np.linalg.norm(self.points[first] - self.points[second], axis=1)
        overlaps = 1.0 - apart / (self.radii[first] + self.radii[second])
        same_side = (self.normals[first] * self.normals[second]).sum(axis=1) > SAME_SIDE
        found = np.flatnonzero((overlaps > 0.0) & same_side)
        return pairs[found], overlaps[found]

    def _pairs(self) -> Iterator[Ints]:
        """Rows (k, 2) of all pairs that may overlap: a disc, and one that is not larger."""
        for radius in np.unique(self.radii[self.radii > 0.0]):
            large, small = (
                np.flatnonzero(self.radii == radius),
                np.flatnonzero(self.radii <= radius),
            )
            near = _near(self.points[large], self.points[small], 2.0 * float(radius))
            found = np.column_stack([large[near[:, 0]], small[near[:, 1]]])
            yield found[found[:, 0] != found[:, 1]]


class Overlaps:
    """The largest overlap of each object type over all frames so far."""

    def __init__(self, types: int) -> None:
        self.of_types = [Overlap()] * types

    @property
    def largest(self) -> Overlap:
        """The largest of all types; of equal ones the first."""
        return max(self.of_types, key=lambda one: one.share)

    def add(self, discs: Discs, frame: int, *, between: bool) -> None:
        """Add a frame, which may be no keyframe."""
        for kind, (share, rows) in enumerate(zip(*discs.worst(len(self.of_types)), strict=True)):
            if share > self.of_types[kind].share:
                pair = int(discs.ids[rows[0]]), int(discs.ids[rows[1]])
                self.of_types[kind] = Overlap(float(share), frame, between, pair)

    def text(self) -> str:
        """The overlaps of the types as JSON, as they are stored."""
        return json.dumps([[round(one.share, 6), one.frame, one.between] for one in self.of_types])


def discs_at(
    points: Floats, placed: Placed, vertices: Floats, radii: Floats, who: tuple[Ints, Ints]
) -> Discs:
    """Discs around points (n, 3), which are at or near their places on a surface.

    The radii are those of the object types; `who` are ids and types of at least n points. Points
    that appear or vanish are left out: what vanishes gives way to others while it becomes smaller.
    """
    there = np.arange(len(points))
    if placed.faded is not None:
        there = np.flatnonzero(placed.faded[: len(points)] == 0.0)
    ids, classes = (values[there] for values in who)
    normals = normals_of(vertices[placed.binding.corners[there]])
    return Discs(points[there], normals, radii[classes], classes, ids)


def overlaps_from(text: str) -> list[Overlap]:
    """The overlaps of the types stored in a text; empty if it is invalid."""
    try:
        stored = [(float(one[0]), int(one[1]), bool(one[2])) for one in json.loads(text)]
    except (ValueError, TypeError, KeyError, IndexError, OverflowError, RecursionError):
        return []
    sane = all(0.0 <= share <= 1.0 and abs(frame) < 1 << 31 for share, frame, _ in stored)
    return [Overlap(*one) for one in stored] if sane else []


def _near(points: Floats, others: Floats, reach: float) -> Ints:
    """Indices (k, 2) of points and others that may be within a distance, by cells of that size.

    The points are among the others.
    """
    low = others.min(axis=0)
    cell = max(reach, float(np.ptp(others, axis=0).max()) / (_LIMIT - 4), 1e-300)
    keys, have = (
        _numbered(np.floor((one - low) / cell).astype(np.int64)) for one in (points, others)
    )
    order = np.argsort(have, kind="stable")
    have, found = have[order], []
    for step in _numbered(_AROUND - 1).tolist():
        begin, end = (np.searchsorted(have, keys + step, side) for side in ("left", "right"))
        counts = end - begin
        rows = np.repeat(np.arange(len(points)), counts)
        within = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        found.append(np.column_stack([rows, order[begin[rows] + within]]))
    return np.concatenate(found)


def _numbered(cells: Ints) -> Ints:
    """One number for each cell (k, 3); neighbors differ by the same numbers everywhere."""
    found: Ints = ((cells[:, 0] + 1) * _LIMIT + cells[:, 1] + 1) * _LIMIT + cells[:, 2] + 1
    return found
