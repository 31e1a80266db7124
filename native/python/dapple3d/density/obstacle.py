# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh that is taken out of a density."""

import numpy as np

from .arrays import Flags, Floats, Indices, Ints, longest_edges, over_corners, vertices_of
from .fields import INNER, Field
from .nearest import Body


class _Distances:
    """Distances of places (n, 3) from the box around a body, and from the body itself: NaN where
    nobody has asked yet. Places are looked up again after faces are cut, with new ones at the end.
    """

    def __init__(self) -> None:
        self.places: Floats = np.empty((0, 3))
        self.beyond: Floats = np.empty(0)
        self.outside: Floats = np.empty(0)


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
        self._known = _Distances()

    def values(self, points: Floats) -> Floats:
        beyond = self._looked_up(points).beyond
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
        near = self._looked_up(points).beyond <= self._margin + float(longest.max())
        chosen = np.flatnonzero(over_corners(np.logical_or, near, faces))
        used = vertices_of(faces[chosen], len(points))
        away = np.full(len(points), np.inf)
        away[used] = np.abs(self._outside(points, used) - self._margin)
        found[chosen] = over_corners(np.minimum, away, faces[chosen]) <= longest[chosen]
        return found

    def reach(self, points: Floats, faces: Ints) -> Flags:
        """Corners and edges of the mesh count, too, where they end within a face."""
        found = over_corners(np.logical_or, self.values(points) == 0.0, faces)
        clear = np.flatnonzero(~found & self._near(points, faces))
        found[clear] = self._body.touches(points, faces[clear], self._margin)
        return found

    def _near(self, points: Floats, faces: Ints) -> Flags:
        """Faces (m,) of which some place may be near the mesh."""
        longest = longest_edges(points, faces)
        reach = self._margin + INNER * longest
        beyond = self._looked_up(points).beyond
        found: Flags = over_corners(np.minimum, beyond, faces) <= reach
        rows = np.flatnonzero(found)
        used = vertices_of(faces[rows], len(points))
        away = np.full(len(points), np.inf)
        away[used] = self._outside(points, used)
        found[rows] = over_corners(np.minimum, away, faces[rows]) <= reach[rows]
        return found

    def _looked_up(self, points: Floats) -> _Distances:
        """What is known of the points: those looked up before, with new ones at the end."""
        known = self._known
        if not np.array_equal(points[: len(known.places)], known.places):
            known = self._known = _Distances()
        new = points[len(known.places) :]
        if len(new):
            known.places = points.copy()
            known.beyond = np.concatenate([known.beyond, self._body.beyond(new)])
            known.outside = np.concatenate([known.outside, np.full(len(new), np.nan)])
        return known

    def _outside(self, points: Floats, chosen: Indices) -> Floats:
        """Distances (k,) from the body of some of the points, less than 0 inside."""
        outside = self._looked_up(points).outside
        new = chosen[np.isnan(outside[chosen])]
        if len(new):
            outside[new] = self._body.outside(points[new])
        found: Floats = outside[chosen]
        return found
