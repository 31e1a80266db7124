# SPDX-License-Identifier: GPL-3.0-or-later
"""A density as colors on the triangles of a surface; computed by a worker."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.native import named, package
from ..settings.values import Settings
from ..surface.arrays import Floats, SurfaceArrays
from .masked_surface import MaskedSurface, masked_surface_of

Singles = NDArray[np.float32]
_LIFT = 2e-3  # above the surface, of its size
_ALPHA = 0.75
# From nothing to the most: dark, teal, yellow.
_COLORS = np.array([[0.10, 0.06, 0.25], [0.13, 0.55, 0.55], [0.99, 0.90, 0.15]])
_STEPS = np.linspace(0.0, 1.0, len(_COLORS))


@dataclass(frozen=True)
class Colored:
    """A density as colors, and what the brightest of them stands for."""

    positions: Singles  # (3 m, 3) corners of triangles
    colors: Singles  # (3 m, 4)
    most: float  # of the density
    points: float = 0.0  # on a unit of area where the density is 1; 0: not known


def computed(
    arrays: SurfaceArrays, settings: Settings, values: str, alone: bool, context: Any
) -> Colored:
    """For a class whose density has these values, or for a term of the density alone: the brightest
    color is 1 then, or more where there is more.
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
    """Places (k,) in 0..1 and colors (k, 4) from none to the most, as a legend shows them."""
    found = colored(_STEPS)
    found[:, 3] = 1.0
    return _STEPS, found


def colored(shares: Floats) -> Singles:
    """Colors (n, 4) of shares (n,) of the largest density."""
    found = np.full((len(shares), 4), _ALPHA, dtype=np.float32)
    for k in range(3):
        found[:, k] = np.interp(shares, _STEPS, _COLORS[:, k])
    return found
