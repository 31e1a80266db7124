# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes and other computations for the tests of masks."""

import math

import numpy as np

SQUARE = np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], dtype=float)
TWO = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
CUBE_FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ],
    dtype=np.int32,
)  # fmt: skip


def winding() -> np.ndarray:
    """Segments of a line over the square."""
    t = np.linspace(-1.5, 1.5, 60)
    places = np.column_stack([t, np.sin(2.0 * t), 0.2 * t])
    return np.stack([places[:-1], places[1:]], axis=1)


def by_hand(points, segments) -> np.ndarray:
    """Distances to segments, place by place."""
    found = []
    for point in points:
        best = math.inf
        for begin, end in segments:
            along = end - begin
            length = float(along @ along)
            share = min(max(float((point - begin) @ along) / length, 0.0), 1.0) if length else 0.0
            best = min(best, math.dist(point, begin + share * along))
        found.append(best)
    return np.array(found)


def falls(value, low, high, fade, invert=False, strength=1.0) -> float:
    """A factor of the density, as docs/add-on.md has it."""
    if low <= value <= high:
        full = 1.0
    else:
        beside = low - value if value < low else value - high
        full = max(1.0 - beside / fade, 0.0) if fade > 0.0 else 0.0
    return 1.0 - strength * full if invert else 1.0 - strength * (1.0 - full)
