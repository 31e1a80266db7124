# SPDX-License-Identifier: GPL-3.0-or-later
"""Aspect: the direction that a surface faces, as a mask at the corners of its faces."""

import math

import numpy as np

from .masks import Mask
from .surface import Floats

LEVEL = math.radians(5.0)  # a surface that slopes by less counts less, as it hardly has a direction


def aspect_factors(normals: Floats, mask: Mask, direction: float) -> Floats:
    """Factors (m, 3) by the angle between a compass direction and the one that is faced, of normals
    (m, 3, 3) at the corners of faces.
    """
    x, y, z = np.moveaxis(normals, 2, 0)
    level = np.hypot(x, y)
    ahead = (x * math.sin(direction) + y * math.cos(direction)) / np.maximum(level, 1e-30)
    sloped = np.clip(np.arctan2(level, np.abs(z)) / LEVEL, 0.0, 1.0)
    found: Floats = 1.0 - sloped * (1.0 - mask.factors(np.arccos(np.clip(ahead, -1.0, 1.0))))
    return found
