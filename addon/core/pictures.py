# SPDX-License-Identifier: GPL-3.0-or-later
"""Small pictures for the panel: a curve, bars, dots. Each is (height, width, 4) in 0..1, row 0 at
the bottom, and transparent where nothing is drawn."""

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from .base.native import package
from .surface.arrays import Floats

SIZE = (160, 160)  # rows, columns; icons are square
_FINER = 3  # drawn so many times larger, then averaged
_INK = np.array([0.92, 0.92, 0.92])
_MARK = np.array([0.95, 0.55, 0.15])
_BACKGROUND = np.array([0.5, 0.5, 0.5])
_BACKGROUND_ALPHA = 0.18
_EDGE = 0.06  # of the height, free on all sides


def curve(values: Sequence[float]) -> Floats:
    """Values from the first to the last, joined; the smallest at the bottom, the largest on top."""
    canvas = _Canvas(SIZE)
    heights = np.asarray(values, dtype=np.float64)
    if not len(heights):
        return canvas.picture()
    heights = (heights - heights.min()) / max(float(np.ptp(heights)), 1e-30)
    places = np.column_stack([np.linspace(0.0, 1.0, len(heights)), heights])
    for begin, end in itertools.pairwise(places):
        canvas.line(begin, end, 0.013, _INK)
    canvas.dots(places, 0.026, _MARK)
    return canvas.picture()


def bars(counts: Sequence[int], marked: int | None = None) -> Floats:
    """A bar for each count, the tallest over the full height; one in another color."""
    canvas = _Canvas(SIZE)
    tallest = max(max(counts, default=0), 1)
    for index, count in enumerate(counts):
        color = _MARK if index == marked else _INK
        canvas.bar(index / len(counts), (index + 0.85) / len(counts), count / tallest, color)
    return canvas.picture()


def dots(points: Floats, radius: float) -> Floats:
    """A square with points (n, 2) in the unit square, of that radius."""
    canvas = _Canvas((SIZE[0], SIZE[0]), edge=0.0)
    canvas.dots(points, radius, _INK)
    return canvas.picture()


def pattern(count: int, options: dict[str, Any]) -> Floats:
    """Points of the periodic unit square, with these options of dapple.sample."""
    native = package()
    samples = native.sample(native.Torus(), count, **options)
    return dots(np.asarray(samples.positions), 0.2 / np.sqrt(count))


class _Canvas:
    """Pixels under the unit square, which an edge surrounds."""

    def __init__(self, size: tuple[int, int], edge: float = _EDGE) -> None:
        rows, columns = size[0] * _FINER, size[1] * _FINER
        self._pixels = np.zeros((rows, columns, 4))
        self._pixels[:, :, :3], self._pixels[:, :, 3] = _BACKGROUND, _BACKGROUND_ALPHA
        self._inset = edge * rows
        self._span = np.array([columns, rows]) - 2 * self._inset

    def bar(self, left: float, right: float, height: float, color: Floats) -> None:
        low, high = self._place([left, 0.0]), self._place([right, height])
        (c0, r0), (c1, r1) = (corner.round().astype(int) for corner in (low, high))
        self._pixels[r0:r1, c0:c1] = [*color, 1.0]

    def dots(self, points: Floats, radius: float, color: Floats) -> None:
        for point in points:
            self.line(point, point, radius, color)

    def line(self, begin: Floats, end: Floats, radius: float, color: Floats) -> None:
        """Color the pixels within `radius` of a segment; lengths are shares of the height."""
        a, b, size = self._place(begin), self._place(end), radius * self._span[1]
        low = np.maximum(np.floor(np.minimum(a, b) - size).astype(int), 0)
        high = np.ceil(np.maximum(a, b) + size).astype(int)
        window = self._pixels[low[1] : high[1], low[0] : high[0]]
        rows, columns = np.indices(window.shape[:2])
        pixels = np.stack([columns + low[0] + 0.5, rows + low[1] + 0.5], axis=-1)
        segment = b - a
        along = np.clip((pixels - a) @ segment / max(float(segment @ segment), 1e-30), 0.0, 1.0)
        distance = np.linalg.norm(pixels - a - along[..., None] * segment, axis=-1)
        window[distance <= size] = [*color, 1.0]

    def _place(self, point: Floats | list[float]) -> Floats:
        found: Floats = self._inset + np.asarray(point) * self._span
        return found

    def picture(self) -> Floats:
        rows, columns = (length // _FINER for length in self._pixels.shape[:2])
        blocks = self._pixels.reshape(rows, _FINER, columns, _FINER, 4)
        weights = blocks[..., 3:]
        alpha = weights.mean(axis=(1, 3))
        color = (blocks[..., :3] * weights).sum(axis=(1, 3)) / weights.sum(axis=(1, 3))
        return np.concatenate([color, alpha], axis=2)
