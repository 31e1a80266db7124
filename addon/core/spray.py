# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke of the spray brush: which points it adds to a surface, or removes from it.

A dab throws candidates on the part of the surface inside a ball. Those that keep a distance from
all points are taken one after another, the one nearest to a point first: that packs them as closely
as an even pattern, which candidates in a random order do not.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .base.errors import ScatterError
from .surface.arrays import Floats, Ints
from .surface.records import own_random

_FIRST, _LATER = 8.0, 5.0  # candidates for each point that has room in a dab, as later dabs overlap
_MOST_CANDIDATES = 3000  # in a dab, which has to be quick
_LAYERS = 4  # most faces that a candidate passes through before it meets one from the front
_PASSED = 1e-4  # relative to the radius: how far behind a face the next one is looked for
_FACING = -0.3  # cosine: more than a right angle, so that a dab reaches around the edges of a box
_MOST_CELLS = 2.0**20  # along an axis

# The first faces that lines from `begins` to `ends` (k, 3) meet: places and unit normals (k, 3),
# nan where there is none.
Cast = Callable[[Floats, Floats], tuple[Floats, Floats]]


@dataclass(frozen=True)
class Brush:
    """The settings of the spray brush.

    Raises:
        ScatterError: a length is not a positive number, or the strength is not from 0 to 1.
    """

    radius: float  # in world units
    gap: float  # least distance between points, in world units
    strength: float = 1.0  # share of the candidates, or of the points to remove
    pressure_sizes: bool = False  # whether the pressure of a pen multiplies the radius
    pressure_strengthens: bool = False  # and the strength

    def __post_init__(self) -> None:
        for name in ("radius", "gap"):
            value = getattr(self, name)
            if not 0.0 < value < np.inf:
                raise ScatterError(f"The {name} of the brush must be a positive number: {value}")
        if not 0.0 <= self.strength <= 1.0:
            raise ScatterError(f"The strength of the brush must be from 0 to 1: {self.strength}")

    def radius_at(self, pressure: float) -> float:
        """Radius of a dab."""
        return self.radius * (pressure if self.pressure_sizes else 1.0)

    def strength_at(self, pressure: float) -> float:
        """Strength of a dab."""
        return self.strength * (pressure if self.pressure_strengthens else 1.0)


@dataclass(frozen=True)
class Contact:
    """Where a dab touches the surface."""

    place: Floats  # (3,)
    normal: Floats  # (3,) of length 1


class Adding:
    """A stroke that adds points to those at `points` (n, 3)."""

    def __init__(self, points: Floats, brush: Brush, seed: int, cast: Cast) -> None:
        self.places = np.empty((0, 3))  # of the new points
        self._brush, self._cast, self._dabs = brush, cast, 0
        self._seed = _seed_of(seed, len(points))
        self._points, self._cells = points, Cells(points, brush.radius + brush.gap)

    def dab(self, contact: Contact, pressure: float = 1.0) -> None:
        """Add points inside the brush."""
        radius, strength = self._brush.radius_at(pressure), self._brush.strength_at(pressure)
        self._dabs += 1
        if radius <= 0.0 or strength <= 0.0:
            return
        found = self._candidates(contact, radius, strength)
        reach = radius + self._brush.gap
        new = self.places[np.linalg.norm(self.places - contact.place, axis=1) <= reach]
        there = self._points[self._cells.within(contact.place, reach)]
        taken = kept_apart(found, np.concatenate([there, new]), self._brush.gap)
        self.places = np.concatenate([self.places, found[taken]])

    def _candidates(self, contact: Contact, radius: float, strength: float) -> Floats:
        """Random places (k, 3) of the surface inside the brush.

        They come from a disc along its normal, from the upper to the lower half of the ball. The
        first dab begins with its own place, so that a click puts a point there.
        """
        room = np.pi * radius**2 / (np.sqrt(0.75) * self._brush.gap**2)
        many = (_FIRST if self._dabs == 1 else _LATER) * strength * room
        count = int(np.ceil(min(many, _MOST_CANDIDATES)))
        rows, stream = np.arange(count, dtype=np.int32), 2 * self._dabs
        away = radius * np.sqrt(own_random(self._seed, rows, stream))
        turn = 2.0 * np.pi * own_random(self._seed, rows, stream + 1)
        if self._dabs == 1:
            away[0] = 0.0
        x, y = axes_across(contact.normal)
        flat = np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * y
        flat = contact.place + away[:, None] * flat
        height = np.sqrt(np.maximum(radius**2 - away**2, 0.0))[:, None] * contact.normal
        return _from_the_front(flat + height, flat - height, contact, radius, self._cast)


class Removing:
    """A stroke that removes points of those at `points` (n, 3), which have normals (n, 3).

    Points on faces that look away from the brush stay: they are on the other side.
    """

    def __init__(self, points: Floats, normals: Floats, brush: Brush, seed: int) -> None:
        self.chosen = np.zeros(len(points), dtype=bool)
        self._brush, self._dabs, self._seed = brush, 0, _seed_of(seed, len(points))
        self._points, self._normals = points, normals
        self._cells = Cells(points, brush.radius)

    @property
    def places(self) -> Floats:
        """Places (k, 3) of the removed points."""
        return self._points[self.chosen]

    def dab(self, contact: Contact, pressure: float = 1.0) -> None:
        """Remove points inside the brush."""
        radius, strength = self._brush.radius_at(pressure), self._brush.strength_at(pressure)
        self._dabs += 1
        rows = self._cells.within(contact.place, radius)
        rows = rows[self._normals[rows] @ contact.normal > _FACING]
        self.chosen[rows[own_random(self._seed, rows, self._dabs) < strength]] = True


class Cells:
    """Points (n, 3) in a grid of cubes, for searches within about the size of a cube."""

    def __init__(self, points: Floats, size: float) -> None:
        self._points = points
        extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
        self._low = points.min(axis=0) if len(points) else np.zeros(3)
        self._size = max(size, extent / _MOST_CELLS)
        cells = self._cells_of(points)
        self._last = cells.max(axis=0) if len(points) else np.full(3, -1)
        keys = self._keys(*cells.T)
        self._order = np.argsort(keys, kind="stable")
        self._sorted = keys[self._order]

    def within(self, place: Floats, distance: float) -> Ints:
        """Rows of the points within a distance of a place, in order."""
        low = np.maximum(self._cells_of(place - distance), 0)
        high = np.minimum(self._cells_of(place + distance), self._last)
        if (low > high).any():
            return np.empty(0, dtype=np.int32)
        x, y = (np.arange(low[k], high[k] + 1) for k in range(2))
        x, y = (one.ravel() for one in np.meshgrid(x, y))
        begins = np.searchsorted(self._sorted, self._keys(x, y, low[2]))
        ends = np.searchsorted(self._sorted, self._keys(x, y, high[2]), side="right")
        pairs = zip(begins.tolist(), ends.tolist(), strict=True)
        rows = np.concatenate([self._order[begin:end] for begin, end in pairs])
        near = np.linalg.norm(self._points[rows] - place, axis=1) <= distance
        return np.sort(rows[near]).astype(np.int32)

    def _cells_of(self, places: Floats) -> NDArray[np.int64]:
        limit = 2.0 * _MOST_CELLS  # of what is far away
        cells = np.floor((places - self._low) / self._size)
        return np.clip(cells, -limit, limit).astype(np.int64)

    def _keys(self, x: NDArray[np.int64], y: NDArray[np.int64], z: NDArray[np.int64]) -> Ints:
        """Numbers of cells, of which those above each other follow each other."""
        _, rows, height = self._last + 1
        keys: Ints = (x * rows + y) * height + z
        return keys


def kept_apart(candidates: Floats, points: Floats, gap: float) -> list[int]:
    """Rows of candidates (k, 3) that are at least `gap` from points (n, 3) and from each other.

    The candidate nearest to a point goes first; nothing is left that could still be added.
    """
    away, taken = _distances(candidates, points), []
    free = np.flatnonzero(away >= gap)
    while len(free):
        row = int(free[np.argmin(away[free])])
        taken.append(row)
        apart = np.linalg.norm(candidates[free] - candidates[row], axis=1)
        away[free] = np.minimum(away[free], apart)
        free = free[away[free] >= gap]
    return taken


def _distances(candidates: Floats, points: Floats) -> Floats:
    """Distances (k,) to the nearest of points (n, 3)."""
    if not len(points) or not len(candidates):
        return np.full(len(candidates), np.inf)
    middle = candidates.mean(axis=0)  # squares of large coordinates would be inexact
    ours, others = candidates - middle, points - middle
    squares = (others**2).sum(axis=1) - 2.0 * (ours @ others.T)
    found: Floats = np.linalg.norm(ours - others[squares.argmin(axis=1)], axis=1)
    return found


def _from_the_front(
    begins: Floats, ends: Floats, contact: Contact, radius: float, cast: Cast
) -> Floats:
    """Where lines meet a face that looks to the side of the contact's normal, (k, 3)."""
    found, begins = np.full(begins.shape, np.nan), begins.copy()
    waiting = np.arange(len(begins))
    for _ in range(_LAYERS):
        places, normals = cast(begins[waiting], ends[waiting])
        met = np.isfinite(places).all(axis=1)
        front = met & (normals @ contact.normal > 0.0)
        found[waiting[front]] = places[front]
        passed = met & ~front
        waiting, places = waiting[passed], places[passed]
        if not len(waiting):
            break
        begins[waiting] = places - _PASSED * radius * contact.normal
    return found[np.isfinite(found).all(axis=1)]


def axes_across(normal: Floats) -> tuple[Floats, Floats]:
    """Two axes at right angles to a unit normal and to each other."""
    other = np.eye(3)[np.argmin(np.abs(normal))]
    x = np.cross(normal, other)
    x /= np.linalg.norm(x)
    return x, np.cross(normal, x)


def _seed_of(seed: int, count: int) -> int:
    """Seed of a stroke: another one once there are more points."""
    return seed * 1_000_003 + count
