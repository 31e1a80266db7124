# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities that know nothing of faces: heights, distances, noise, the camera's frame, obstacles.

Each has its values at places, and the faces on which it changes: only these need to be cut.
"""

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from .fields import fields_of
from .masks import Flags, Mask, mask_of
from .nearest import Body
from .settings import DensitySettings
from .surface import Floats, Ints, SurfaceArrays

_INWARD = 0.05  # of the way from a corner of a face to its middle
_ROUNDING = 2.5e-7  # of coordinates, which are stored in single precision


@dataclass(frozen=True)
class Places:
    """Vertices (v, 3) of a ground."""

    now: Floats
    first: Floats  # on the first frame of a bake; elsewhere the same

    def of(self, term: "Term") -> Floats:
        """Where a factor looks."""
        return self.first if term.rides else self.now


class Term(Protocol):
    """A factor of the density."""

    coarseness: float  # how much longer the edges of faces may be than at a sharp change
    rides: bool  # whether it belongs to the surface, however that deforms

    def values(self, points: Floats) -> Floats:
        """Factors (k,) at points (k, 3)."""

    def changes(self, points: Floats, faces: Ints) -> Flags:
        """Which faces (m,) of a mesh may have places with several values."""


def fine_terms(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays | None = None
) -> list[Term]:
    """What the settings ask for; of a later frame of a bake with its first one."""
    around, height = arrays.around, mask_of(settings, "height")
    terms: list[Term] = []
    if height is not None:
        terms.append(Height(height, float(np.abs(arrays.vertices[:, 2]).max(initial=0.0))))
    terms += fields_of(arrays, settings, first)
    if around.camera is not None:
        terms.append(Camera(around.camera, settings.camera_margin))
    terms += [Obstacle(*mesh, settings.obstacle_margin) for mesh in around.obstacles]
    return terms


class Height:
    """Full in a range of world Z, less over the fade beside it."""

    coarseness, rides = 1.0, False

    def __init__(self, mask: Mask, largest: float = 0.0) -> None:
        """The largest Z of the surface, by amount: its rounding leaves a floor in the range."""
        slack = _ROUNDING * largest if mask.fade <= 0.0 else 0.0
        self._mask = replace(mask, low=mask.low - slack, high=mask.high + slack)

    @property
    def is_sharp(self) -> bool:
        """Whether it jumps."""
        return self._mask.fade <= 0.0

    def values(self, points: Floats) -> Floats:
        return self._mask.factors(points[:, 2])

    def changes(self, points: Floats, faces: Ints) -> Flags:
        z = points[:, 2][faces]
        return self._mask.falls(z.min(axis=1), z.max(axis=1))


class Camera:
    """1 where a camera sees places or misses them by a margin, of half its frame; else 0.

    Whether something is in front of them is not asked.
    """

    coarseness, rides = 1.0, False

    def __init__(self, clip: Floats, margin: float) -> None:
        x, y, w = clip[0], clip[1], (1.0 + margin) * clip[3]
        self._planes = np.array([w - x, w + x, w - y, w + y, clip[3]])

    def _inside(self, points: Floats) -> Flags:
        signed: Floats = points @ self._planes[:, :3].T + self._planes[:, 3]
        found: Flags = signed >= 0.0
        return found

    def values(self, points: Floats) -> Floats:
        seen: Flags = np.all(self._inside(points), axis=1)
        return seen.astype(np.float64)

    def changes(self, points: Floats, faces: Ints) -> Flags:
        inside = self._inside(points)[faces]  # (m, 3 corners, 5 planes)
        beyond: Flags = np.any(np.all(~inside, axis=1), axis=1)  # all of them beyond one plane
        within: Flags = np.all(inside, axis=(1, 2))
        found: Flags = ~beyond & ~within
        return found


class Obstacle:
    """0 near to a mesh and, where that is closed, inside; else 1."""

    coarseness, rides = 1.0, False

    def __init__(self, vertices: Floats, faces: Ints, margin: float) -> None:
        self._body, self._margin = Body(vertices, faces), margin

    def values(self, points: Floats) -> Floats:
        return (self._outside(points, self._margin) >= self._margin).astype(np.float64)

    def changes(self, points: Floats, faces: Ints) -> Flags:
        """By the corners' distances: nothing else is known of what lies between them."""
        found = np.zeros(len(faces), dtype=bool)
        if not len(faces):
            return found
        corners = points[faces]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        near = self._body.beyond(points) <= self._margin + float(longest.max())
        chosen = np.flatnonzero(near[faces].any(axis=1))
        used = np.zeros(len(points), dtype=bool)
        used[faces[chosen]] = True
        away = np.full(len(points), np.inf)
        away[used] = np.abs(self._outside(points[used], np.inf) - self._margin)
        found[chosen] = away[faces[chosen]].min(axis=1) <= longest[chosen]
        return found

    def _outside(self, points: Floats, needed: float) -> Floats:
        """Distances (k,) from the body, less than 0 inside; infinite where they are beyond what is
        needed, as far as a box around it tells.
        """
        found = np.full(len(points), np.inf)
        near = self._body.beyond(points) <= needed
        found[near] = self._body.outside(points[near])
        return found


def at_corners(term: Term, places: Places, faces: Ints) -> Floats:
    """Factors (m, 3) at the corners of faces; those of a jump as they are inside of each face, so
    that the walls below a floor have none of what the floor has.
    """
    points = places.of(term)
    if not (isinstance(term, Height) and term.is_sharp):
        return term.values(points)[faces]
    corners = points[faces]
    inside = corners + _INWARD * (corners.mean(axis=1, keepdims=True) - corners)
    return term.values(inside.reshape(-1, 3)).reshape(-1, 3)


def to_cut(terms: list[Term], places: Places, faces: Ints, lengths: Floats, target: float) -> Flags:
    """Faces on which some term changes, and that are larger than is good.

    lengths are those of the faces' longest edges, target the good one at a sharp change.
    """
    found = np.zeros(len(lengths), dtype=bool)
    for term in terms:
        open_ones = np.flatnonzero(~found & (lengths > term.coarseness * target))
        found[open_ones] = term.changes(places.of(term), faces[open_ones])
    return found


def blocked(terms: list[Term], surface: Any) -> Flags:
    """Faces of a dapple.Surface that reach into obstacles."""
    found = np.zeros(len(surface.faces), dtype=bool)
    for term in terms:
        if isinstance(term, Obstacle):
            found |= (term.values(surface.vertices) == 0.0)[surface.faces].any(axis=1)
    return found
