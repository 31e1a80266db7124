# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities that know nothing of faces: heights, the camera's frame, obstacles.

Each has its values at places, and the faces on which it changes: only these need to be cut.
"""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .density import window
from .frames import vertex_normals
from .native import package
from .settings import DensitySettings
from .surface import Floats, Ints, Surroundings

Mask = NDArray[np.bool_]


class Term(Protocol):
    """A factor of the density."""

    def values(self, points: Floats) -> Floats:
        """Factors (k,) at points (k, 3)."""

    def changes(self, points: Floats, faces: Ints) -> Mask:
        """Which faces (m,) of a mesh may have places with several values."""


def fine_terms(around: Surroundings, settings: DensitySettings) -> list[Term]:
    """What the settings ask for."""
    terms: list[Term] = []
    if settings.use_height:
        terms.append(Height(settings))
    if around.camera is not None:
        terms.append(Camera(around.camera, settings.camera_margin))
    terms += [Obstacle(*mesh, settings.obstacle_margin) for mesh in around.obstacles]
    return terms


class Height:
    """Full in a range of world Z, less over the fade beside it."""

    def __init__(self, settings: DensitySettings) -> None:
        self._range = (settings.height_from, settings.height_to, settings.height_fade)

    def values(self, points: Floats) -> Floats:
        return window(points[:, 2], *self._range)

    def changes(self, points: Floats, faces: Ints) -> Mask:
        low, high, fade = self._range
        z = points[:, 2][faces]
        least, most = z.min(axis=1), z.max(axis=1)
        rises = (least < low) & (most >= low - fade)
        falls = (least <= high + fade) & (most > high)
        found: Mask = rises | falls
        return found


class Camera:
    """1 where a camera sees places or misses them by a margin, of half its frame; else 0.

    Whether something is in front of them is not asked.
    """

    def __init__(self, clip: Floats, margin: float) -> None:
        x, y, w = clip[0], clip[1], (1.0 + margin) * clip[3]
        self._planes = np.array([w - x, w + x, w - y, w + y, clip[3]])

    def _inside(self, points: Floats) -> Mask:
        signed: Floats = points @ self._planes[:, :3].T + self._planes[:, 3]
        found: Mask = signed >= 0.0
        return found

    def values(self, points: Floats) -> Floats:
        seen: Mask = np.all(self._inside(points), axis=1)
        return seen.astype(np.float64)

    def changes(self, points: Floats, faces: Ints) -> Mask:
        inside = self._inside(points)[faces]  # (m, 3 corners, 5 planes)
        beyond: Mask = np.any(np.all(~inside, axis=1), axis=1)  # all of them beyond one plane
        within: Mask = np.all(inside, axis=(1, 2))
        found: Mask = ~beyond & ~within
        return found


class Obstacle:
    """0 near to a mesh and, where that is closed, inside; else 1."""

    def __init__(self, vertices: Floats, faces: Ints, margin: float) -> None:
        self._mesh, self._margin = package().Surface(vertices, faces), margin
        self._normals = vertex_normals(vertices, faces)
        self._closed = self._mesh.topology.closed

    def values(self, points: Floats) -> Floats:
        return (self._outside(points) >= self._margin).astype(np.float64)

    def changes(self, points: Floats, faces: Ints) -> Mask:
        """By the corners' distances: nothing else is known of what lies between them."""
        corners = points[faces]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        away = np.abs(self._outside(points) - self._margin)[faces].min(axis=1)
        found: Mask = away <= longest
        return found

    def _outside(self, points: Floats) -> Floats:
        """Distances (k,) from the mesh, less than 0 inside."""
        closest = package().project(self._mesh, points)
        distance: Floats = np.array(closest.distances)
        if self._closed:
            corners = self._normals[self._mesh.faces[closest.faces]]
            normals = np.einsum("nk,nkd->nd", closest.barycentric, corners)
            inside = np.einsum("nd,nd->n", points - closest.positions, normals) < 0.0
            distance[inside] *= -1.0
        return distance


def all_changes(terms: list[Term], surface: Any) -> Mask:
    """Faces of a dapple.Surface on which some term changes."""
    found = np.zeros(len(surface.faces), dtype=bool)
    for term in terms:
        found |= term.changes(surface.vertices, surface.faces)
    return found


def blocked(terms: list[Term], surface: Any) -> Mask:
    """Faces of a dapple.Surface that reach into obstacles."""
    found = np.zeros(len(surface.faces), dtype=bool)
    for term in terms:
        if isinstance(term, Obstacle):
            found |= (term.values(surface.vertices) == 0.0)[surface.faces].any(axis=1)
    return found
