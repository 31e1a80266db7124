# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of a frame moved so that no discs overlap where they are shown.

The solver keeps discs apart on the faces that masks cut. Where parts of a character are connected
along the line in which they meet at rest, these faces are not quite where the parts are when they
move. So what still overlaps on the parts themselves is pushed apart there.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.native import package
from ..density.masked_surface import MaskedSurface
from ..surface.arrays import Floats, Ints, normals_of
from .overlaps import SAME_SIDE, Discs

_NEARLY = 0.002  # share of an overlap that may remain
_BEYOND = 0.001  # of a distance: how much farther discs are pushed
_ROUNDS = 20  # pushed points may meet others
_ANGLES = np.radians([sign * 15.0 * k for k in range(1, 13) for sign in (1.0, -1.0)])
_LEAST_ROOM = 0.1  # squared length of directions along the surface: else the move would be long


Rows = NDArray[np.integer]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Places:
    """Where points are on the triangles of a surface."""

    faces: Ints  # (n,)
    barycentric: Floats  # (n, 3)

    def at(self, rows: Rows) -> "Places":
        return Places(self.faces[rows], self.barycentric[rows])

    def changed(self, rows: Rows, others: "Places") -> "Places":
        """These with others in some rows."""
        faces, barycentric = self.faces.copy(), self.barycentric.copy()
        faces[rows], barycentric[rows] = others.faces, others.barycentric
        return Places(faces, barycentric)


Allowed = Callable[[Rows, Places], Flags]  # rows, and their new places -> (k,) flags


def pushed_apart(discs: Discs, places: Places, surface: Callable[[], Any], at: Allowed) -> Places:
    """The places with the least overlap that is found; the same object if nothing is too near.

    Args:
        surface: returns the dapple.Surface of the frame.
        at: which points may go to new places.
    """
    best, least, crowd = places, np.inf, None
    stuck = np.zeros(len(discs.points), dtype=bool)
    for _ in range(_ROUNDS):
        pairs, shares = discs.overlapping()
        most = float(shares.max(initial=0.0))
        if most < least:
            best, least = places if crowd is None else crowd.places, most
        near = shares > _NEARLY
        if not near.any():
            break
        crowd = _Crowd(discs, places, surface(), at) if crowd is None else crowd
        moves = _moves(discs, pairs[near], shares[near], stuck)
        rows = np.flatnonzero(moves.any(axis=1))
        stuck[rows[~crowd.move(rows, moves[rows])]] = True
        for pair in pairs[near][stuck[pairs[near]].any(axis=1)]:
            stuck[pair] &= not crowd.go_around(*_smaller_first(discs, pair, stuck))
        discs = crowd.discs
    return best


def _smaller_first(discs: Discs, pair: Rows, stuck: Flags) -> Rows:
    """A pair, begun by the one that is to move: one that is stuck, the smaller of two."""
    order = np.lexsort((discs.radii[pair], ~stuck[pair]))
    return pair[order]


class _Crowd:
    """Discs that move on the surface of a frame."""

    def __init__(self, discs: Discs, places: Places, mesh: Any, at: Allowed) -> None:
        self.discs, self.places = discs, places
        self._mesh, self._at = mesh, at

    def move(self, rows: Rows, moves: Floats) -> Flags:
        """Move some discs along the surface; returns which of them may be there."""
        if not len(rows):
            return np.zeros(0, dtype=bool)
        found, there, normals = self._seen(self.discs.points[rows] + moves)
        fine = self._may_go(rows, there, normals)
        self._put(rows[fine], found[fine], there.at(np.flatnonzero(fine)), normals[fine])
        return fine

    def go_around(self, row: int, other: int) -> bool:
        """Move a disc along the edge of another one that it cannot leave straight; returns whether
        that made their overlap smaller.
        """
        discs = self.discs
        apart = discs.points[row] - discs.points[other]
        needed = discs.radii[row] + discs.radii[other]
        normal = discs.normals[other]
        if np.linalg.norm(apart) >= needed or not np.any(apart):
            return True
        targets = discs.points[other] + _turned(apart, normal, (1.0 + _BEYOND) * needed)
        found, there, normals = self._seen(targets)
        rows = np.full(len(targets), row)
        overlaps = np.array([self._overlap(row, *one) for one in zip(found, normals, strict=True)])
        overlaps[~self._may_go(rows, there, normals)] = np.inf
        fine = np.flatnonzero(overlaps <= _NEARLY)
        best = fine[:1] if len(fine) else np.array([np.argmin(overlaps)])
        if overlaps[best[0]] >= 1.0 - np.linalg.norm(apart) / needed:
            return False
        self._put(rows[:1], found[best], there.at(best), normals[best])
        return True

    def _seen(self, points: Floats) -> tuple[Floats, Places, Floats]:
        """The nearest points of the surface, their places and normals."""
        found = package().project(self._mesh, points)
        there = Places(np.asarray(found.faces, dtype=np.int32), np.asarray(found.barycentric))
        normals = normals_of(self._mesh.vertices[self._mesh.faces[there.faces]])
        return np.asarray(found.positions), there, normals

    def _may_go(self, rows: Rows, there: Places, normals: Floats) -> Flags:
        fine: Flags = (normals * self.discs.normals[rows]).sum(axis=1) > SAME_SIDE
        fine &= self._at(rows, there)
        return fine

    def _overlap(self, row: int, point: Floats, normal: Floats) -> float:
        """The largest overlap of a disc if it were at another place."""
        discs = self.discs
        needed = discs.radii + discs.radii[row]
        apart = np.linalg.norm(discs.points - point, axis=1)
        apart[(discs.normals @ normal <= SAME_SIDE) | (needed == 0.0)] = np.inf
        apart[row] = np.inf
        return float((1.0 - apart / np.maximum(needed, 1e-300)).max(initial=0.0))

    def _put(self, rows: Rows, points: Floats, places: Places, normals: Floats) -> None:
        now = self.discs
        there, turned = now.points.copy(), now.normals.copy()
        there[rows], turned[rows] = points, normals
        self.discs = replace(now, points=there, normals=turned)
        self.places = self.places.changed(rows, places)


def _turned(apart: Floats, normal: Floats, length: float) -> Floats:
    """Vectors (k, 3) of a length, from one turned by angles about a normal."""
    across = np.cross(normal, apart)
    cosine, sine = np.cos(_ANGLES)[:, None], np.sin(_ANGLES)[:, None]
    found = cosine * apart + sine * across
    lengths = np.linalg.norm(found, axis=1)
    result: Floats = found * (length / np.maximum(lengths, 1e-300))[:, None]
    return result


def _moves(discs: Discs, pairs: Rows, shares: Floats, stuck: Flags) -> Floats:
    """Moves (n, 3) along the surface; the smaller of two discs moves farther."""
    moves = np.zeros_like(discs.points)
    radii = discs.radii[pairs]
    total = radii.sum(axis=1)
    apart = discs.points[pairs[:, 0]] - discs.points[pairs[:, 1]]
    apart /= np.maximum(np.linalg.norm(apart, axis=1), 1e-300)[:, None]
    weights = radii[:, ::-1] / total[:, None]
    weights[stuck[pairs[:, ::-1]]] = 1.0  # where the other one cannot give way
    weights[stuck[pairs]] = 0.0
    along = [_along(side * apart, discs.normals[pairs[:, k]]) for k, side in ((0, 1.0), (1, -1.0))]
    room = sum(weights[:, k] * (along[k] ** 2).sum(axis=1) for k in range(2))
    lack = (shares + _BEYOND) * total / np.maximum(room, _LEAST_ROOM)
    for k in range(2):
        np.add.at(moves, pairs[:, k], (lack * weights[:, k])[:, None] * along[k])
    return moves


def _along(directions: Floats, normals: Floats) -> Floats:
    found: Floats = directions - (directions * normals).sum(axis=1)[:, None] * normals
    return found


def allowed_on(masked: MaskedSurface, classes: Rows, names: list[str]) -> Allowed:
    """Whether the density of its object type, of that name, allows a point at a place."""

    def allowed(rows: Rows, places: Places) -> Flags:
        samples = package().Samples(masked.original, places.faces, places.barycentric)
        there = masked.from_original(samples)
        found = np.zeros(len(rows), dtype=bool)
        for kind in np.unique(classes[rows]):
            mine = np.flatnonzero(classes[rows] == kind)
            density = masked.corner_density(names[kind])[there.faces[mine]]
            found[mine] = (density * there.barycentric[mine]).sum(axis=1) > 0.0
        return found

    return allowed
