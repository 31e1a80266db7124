# SPDX-License-Identifier: GPL-3.0-or-later
"""Convex solids that are taken out of a density."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._native import reached_by_solids
from .arrays import Flags, Floats, Ints, shaped
from .fields import Field

_PARTLY = 1  # of reached_by_solids


class Solids(Field):
    """0 on all faces that touch convex solids, 1 elsewhere: no sample lies in one.

    Each solid is the convex hull of some points, which may be flat, a line or a point, with all
    that is not farther from it than a margin. Boxes are given by their eight corners.

    Args:
        points: (p, 3), those of all solids, one after the other.
        counts: (s,) >= 0, number of points of each solid.
        margin: >= 0.

    Raises:
        ValueError: an argument has another shape, or as `dapple.reached_by_solids`.
    """

    def __init__(self, points: ArrayLike, counts: ArrayLike, margin: float = 0.0) -> None:
        self._points = shaped("points", points, -1, 3)
        self._counts, self._margin = np.asarray(counts, dtype=np.int32), margin
        self._reach(np.empty((0, 3)), np.empty((0, 3), dtype=np.int32))  # checks the arguments

    def _reach(self, points: Floats, faces: Ints) -> NDArray[np.uint8]:
        return reached_by_solids(points, faces, self._points, self._counts, margin=self._margin)

    def values(self, points: Floats) -> Floats:
        each = np.repeat(np.arange(len(points), dtype=np.int32)[:, None], 3, axis=1)
        return (self._reach(points, each) == 0).astype(np.float64)

    def changes(self, points: Floats, faces: Ints) -> Flags:
        found: Flags = self._reach(points, faces) == _PARTLY
        return found

    def at_corners(self, points: Floats, faces: Ints) -> Floats:
        clear = (self._reach(points, faces) == 0).astype(np.float64)
        found: Floats = np.broadcast_to(clear[:, None], (len(faces), 3))
        return found
