# SPDX-License-Identifier: GPL-3.0-or-later
"""A density as colors on the triangles of a surface; computed by a worker."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .frames import vertex_normals
from .ground import Ground
from .settings import Settings
from .solve import named
from .surface import Floats, SurfaceArrays

Singles = NDArray[np.float32]
_LIFT = 2e-3  # above the surface, of its size
_ALPHA = 0.75
# From nothing to the most: dark, teal, yellow.
_COLORS = np.array([[0.10, 0.06, 0.25], [0.13, 0.55, 0.55], [0.99, 0.90, 0.15]])


def computed(
    arrays: SurfaceArrays, settings: Settings, values: str, context: Any
) -> tuple[Singles, Singles]:
    """Corners of the triangles and their colors, for a class whose density has these values."""
    with named(arrays.name):
        ground = Ground(arrays, settings, context)
        density = ground.at_corners(values)
    vertices, faces = ground.surface.vertices, ground.surface.faces
    lift = _LIFT * float(np.linalg.norm(np.ptp(arrays.vertices, axis=0)))
    lifted = (vertices + lift * vertex_normals(vertices, faces)).astype(np.float32)
    shares = density.ravel() / max(float(density.max()), 1e-300)
    return lifted[faces].reshape(-1, 3), colored(shares)


def colored(shares: Floats) -> Singles:
    """Colors (n, 4) of shares (n,) of the largest density."""
    steps = np.linspace(0.0, 1.0, len(_COLORS))
    found = np.full((len(shares), 4), _ALPHA, dtype=np.float32)
    for k in range(3):
        found[:, k] = np.interp(shares, steps, _COLORS[:, k])
    return found
