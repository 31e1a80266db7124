# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that need no file; real ones come from the folder that benchmarks/compare takes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.tracking.animations import GENERATED
from benchmarks.tracking.implicit import Array, Faces

Mesh = tuple[Array, Faces]


def figure() -> Mesh:
    """A walking figure, closed and smooth, of about 12,000 faces of one size."""
    walk = GENERATED["walk"](1, 12_000)
    return walk.frames[0], walk.faces


def box() -> Mesh:
    """3 x 2 x 1: sharp edges, and 12 faces only."""
    vertices = np.array([[x, y, z] for z in (0, 1) for y in (0, 2) for x in (0, 3)], dtype=float)
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [half for a, b, c, d in sides for half in ((a, b, c), (a, c, d))]
    return vertices, np.array(faces, dtype=np.int32)


MADE_UP: dict[str, Callable[[], Mesh]] = {"figure": figure, "box": box}
