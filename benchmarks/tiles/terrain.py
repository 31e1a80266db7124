# SPDX-License-Identifier: GPL-3.0-or-later
"""Hills of any size, made row by row."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

ROWS = 256  # at once
# Waves that do not repeat together: height, lengths along x and y.
WAVES = [(20.0, 97.0, 71.0), (6.0, 23.0, 31.0), (1.0, 7.3, 9.1), (150.0, 1400.0, 1900.0)]


def hills(rows: NDArray[np.float64], columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """The heights at rows and columns."""
    parts = [
        height * np.sin(columns[None, :] / x) * np.cos(rows[:, None] / y) for height, x, y in WAVES
    ]
    total: NDArray[np.float64] = np.sum(parts, axis=0)
    return total


def write_hills(path: Path, side: int) -> Path:
    """A square of heights in an npy file of single precision."""
    stored = np.lib.format.open_memmap(path, "w+", np.float32, (side, side))
    columns = np.arange(side, dtype=np.float64)
    for start in range(0, side, ROWS):
        rows = np.arange(start, min(start + ROWS, side), dtype=np.float64)
        stored[start : start + ROWS] = hills(rows, columns)
    stored.flush()
    return path


def side_for(faces: int) -> int:
    """Heights along a side, for so many faces."""
    return round(math.sqrt(faces / 2)) + 1
