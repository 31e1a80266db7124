# SPDX-License-Identifier: GPL-3.0-or-later
"""Aspect: the direction that a surface faces, as a mask at the corners of its faces."""

import math

import numpy as np

from .frames import vertex_normals
from .masks import Mask
from .surface import Floats, SurfaceArrays

LEVEL = math.radians(5.0)  # a surface that slopes by less counts less, as it hardly has a direction
_SHARP = math.cos(math.radians(15.0))  # between two faces that make an edge, half as much as there


def aspect_factors(arrays: SurfaceArrays, mask: Mask, direction: float) -> Floats:
    """Factors (m, 3) by the angle between a compass direction and the one that is faced."""
    x, y, z = np.moveaxis(corner_normals(arrays), 2, 0)
    level = np.hypot(x, y)
    ahead = (x * math.sin(direction) + y * math.cos(direction)) / np.maximum(level, 1e-30)
    sloped = np.clip(np.arctan2(level, np.abs(z)) / LEVEL, 0.0, 1.0)
    found: Floats = 1.0 - sloped * (1.0 - mask.factors(np.arccos(np.clip(ahead, -1.0, 1.0))))
    return found


def corner_normals(arrays: SurfaceArrays) -> Floats:
    """Unit normals (m, 3, 3) at the corners of faces: of the vertices, but for sharp edges."""
    a, b, c = (arrays.vertices[arrays.faces[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    flat /= np.maximum(np.linalg.norm(flat, axis=1), 1e-300)[:, None]
    smooth = vertex_normals(arrays.vertices, arrays.faces)[arrays.faces]
    sharp = np.einsum("mkd,md->mk", smooth, flat) < _SHARP
    found: Floats = np.where(sharp[:, :, None], flat[:, None, :], smooth)
    return found
