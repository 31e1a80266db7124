# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities by the normal of a surface: its slope, and its aspect, the direction that it faces."""

import math

import numpy as np

from .arrays import Floats
from .ranges import Range

LEVEL = math.radians(
    5.0
)  # below this slope a surface counts less, because it hardly has a direction


def slope(normals: Floats, angles: Range) -> Floats:
    """Factors (m, 3) by the angle between the normals and the z axis.

    Args:
        normals: (m, 3, 3), unit normals at the corners of the faces, as `Surface.corner_normals`.
        angles: in radians; 0 is a floor, pi / 2 a wall, pi a ceiling.
    """
    return angles.factors(np.arccos(np.clip(normals[:, :, 2], -1.0, 1.0)))


def aspect(normals: Floats, angles: Range, direction: float = 0.0) -> Floats:
    """Factors (m, 3) by the angle between a compass direction and the one that is faced.

    Level ground faces no direction: its factor is 1.

    Args:
        normals: (m, 3, 3), unit normals at the corners of the faces, as `Surface.corner_normals`.
        angles: in radians, 0 to pi.
        direction: in radians; 0 is north (the y axis), pi / 2 is east (the x axis).
    """
    x, y, z = np.moveaxis(normals, 2, 0)
    level = np.hypot(x, y)
    ahead = (x * math.sin(direction) + y * math.cos(direction)) / np.maximum(level, 1e-30)
    sloped = np.clip(np.arctan2(level, np.abs(z)) / LEVEL, 0.0, 1.0)
    found: Floats = 1.0 - sloped * (1.0 - angles.factors(np.arccos(np.clip(ahead, -1.0, 1.0))))
    return found
