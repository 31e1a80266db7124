# SPDX-License-Identifier: GPL-3.0-or-later
"""A density as colors on the triangles of a surface; computed in a worker."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.native import named, package
from ..settings.values import Settings
from ..surface.arrays import Floats, SurfaceArrays
from .masked_surface import MaskedSurface, masked_surface_of

Singles = NDArray[np.float32]
_LIFT = 2e-3  # height above the surface, relative to its size
_ALPHA = 0.75
# From nothing to the most: dark, teal, yellow.
_COLORS = np.array([[0.10, 0.06, 0.25], [0.13, 0.55, 0.55], [0.99, 0.90, 0.15]])
_STEPS = np.linspace(0.0, 1.0, len(_COLORS))


@dataclass(frozen=True)
class Colored:
    """A density as colors, and the value of the brightest color."""

    positions: Singles  # (3 m, 3) corners of triangles
    colors: Singles  # (3 m, 4)
    most: float  # largest density
    points: float = 0.0  # points per area where the density is 1; 0 if unknown


def computed(
    arrays: SurfaceArrays, settings: Settings, values: str, alone: bool, context: Any
) -> Colored:
    """Colors for an object type whose density has these values, or for a single term.

    For a single term the brightest color is 1, or the maximum if that is larger.
    """
    with named(arrays.name):
        masked = masked_surface_of(arrays, settings, context)
        density = masked.corner_density(values)
    vertices, faces = masked.surface.vertices, masked.surface.faces
    lift = _LIFT * float(np.linalg.norm(np.ptp(arrays.vertices, axis=0)))
    lifted = (vertices + lift * package().density.vertex_normals(vertices, faces)).astype(
        np.float32
    )
    most = max(float(density.max()), 1.0 if alone else 1e-300)
    colors = colored(density.ravel() / most)
    points = 0.0 if alone or settings.object_types else _points(masked, settings)
    return Colored(lifted[faces].reshape(-1, 3), colors, most, points)


def _points(masked: MaskedSurface, settings: Settings) -> float:
    return float(settings.per_area or settings.count / max(masked.surface.capacity, 1e-300))


def ramp() -> tuple[Floats, Singles]:
    """Positions (k,) in 0..1 and colors (k, 4) of the legend."""
    found = colored(_STEPS)
    found[:, 3] = 1.0
    return _STEPS, found


def colored(shares: Floats) -> Singles:
    """Colors (n, 4) of densities (n,) relative to the largest one."""
    found = np.full((len(shares), 4), _ALPHA, dtype=np.float32)
    for k in range(3):
        found[:, k] = np.interp(shares, _STEPS, _COLORS[:, k])
    return found
