# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh that is taken out of a density."""

import numpy as np

from .arrays import Flags, Floats, Indices, Ints, longest_edges
from .fields import INNER, Field
from .nearest import Body


class Obstacle(Field):
    """0 near a mesh and, where that is closed, inside it; 1 elsewhere.

    Args:
        vertices, faces: (v, 3) and (m, 3) of the mesh.
        margin: >= 0, the distance from it that is still 0.

    Raises:
        ValueError: as `dapple.Surface`.
    """

    blocks = True

    def __init__(self, vertices: Floats, faces: Ints, margin: float) -> None:
        self._body, self._margin = Body(vertices, faces), margin
        self._known: tuple[Floats, Floats] = (np.empty((0, 3)), np.empty(0))

    def values(self, points: Floats) -> Floats:
        beyond = self._body.beyond(points)
        found = np.ones(len(points))
        near = np.flatnonzero(beyond <= self._margin)
        found[near] = self._outside(points, near) >= self._margin
        return found

    def changes(self, points: Floats, faces: Ints) -> Flags:
        """By the corners' distances: nothing else is known of what lies between them."""
        found = np.zeros(len(faces), dtype=bool)
        if not len(faces):
            return found
        longest = longest_edges(points, faces)
        near = self._body.beyond(points) <= self._margin + float(longest.max())
        chosen = np.flatnonzero(near[faces].any(axis=1))
        used = np.unique(faces[chosen])
        away = np.full(len(points), np.inf)
        away[used] = np.abs(self._outside(points, used) - self._margin)
        found[chosen] = away[faces[chosen]].min(axis=1) <= longest[chosen]
        return found

    def reach(self, points: Floats, faces: Ints) -> Flags:
        """Corners and edges of the mesh count, too, where they end within a face."""
        found: Flags = (self.values(points) == 0.0)[faces].any(axis=1)
        clear = np.flatnonzero(~found & self._near(points, faces))
        found[clear] = self._body.touches(points, faces[clear], self._margin)
        return found

    def _near(self, points: Floats, faces: Ints) -> Flags:
        """Faces (m,) of which some place may be near the mesh."""
        longest = longest_edges(points, faces)
        reach = self._margin + INNER * longest
        found: Flags = self._body.beyond(points)[faces].min(axis=1) <= reach
        rows = np.flatnonzero(found)
        used = np.unique(faces[rows])
        away = np.full(len(points), np.inf)
        away[used] = self._outside(points, used)
        found[rows] = away[faces[rows]].min(axis=1) <= reach[rows]
        return found

    def _outside(self, points: Floats, chosen: Indices) -> Floats:
        """Distances (k,) from the body of some of the points, less than 0 inside.

        They are kept: points are looked up again after faces are cut, with new ones at the end.
        """
        places, known = self._known
        if not np.array_equal(points[: len(places)], places):
            known = np.empty(0)
        known = np.concatenate([known, np.full(len(points) - len(known), np.nan)])
        self._known = (points.copy(), known)
        new = chosen[np.isnan(known[chosen])]
        known[new] = self._body.outside(points[new])
        found: Floats = known[chosen]
        return found
