# SPDX-License-Identifier: GPL-3.0-or-later
"""How densely a surface is covered: values of its vertices, and what its shape says, multiplied."""

import numpy as np

from .frames import vertex_normals
from .native import package
from .settings import DensitySettings, Settings
from .surface import Floats, SurfaceArrays

_FLOOR = 0.02  # of the largest density, where curvature alone thins


def names_of(settings: Settings) -> list[str]:
    """Values of the vertices that the settings ask for, by the name of their attribute."""
    density = settings.density
    named = [density.attribute, density.blocked, *(kind.density for kind in settings.classes)]
    return sorted({name for name in named if name})


def vertex_terms(arrays: SurfaceArrays, settings: DensitySettings) -> Floats | None:
    """Product (v,) of the terms that are known at vertices; None where there is none."""
    terms = []
    if settings.attribute:
        terms.append(arrays.weights[settings.attribute])
    if settings.blocked:
        terms.append(1.0 - np.clip(arrays.weights[settings.blocked], 0.0, 1.0))
    if settings.curvature > 0.0:
        terms.append(_by_curvature(arrays, settings.curvature))
    if settings.use_slope:
        up = vertex_normals(arrays.vertices, arrays.faces)[:, 2]
        angle = np.arccos(np.clip(up, -1.0, 1.0))
        terms.append(window(angle, settings.slope_from, settings.slope_to, settings.slope_fade))
    return np.prod(terms, axis=0) if terms else None


def window(values: Floats, low: float, high: float, fade: float) -> Floats:
    """1 from low to high, falling to 0 over the length fade on either side."""
    outside = np.maximum(low - values, values - high)
    if fade <= 0.0:
        return (outside <= 0.0).astype(np.float64)
    return np.clip(1.0 - outside / fade, 0.0, 1.0)


def _by_curvature(arrays: SurfaceArrays, influence: float) -> Floats:
    plain = package().Surface(arrays.vertices, arrays.faces)
    curved: Floats = package().curvature_density(plain, floor=_FLOOR)
    return 1.0 - influence + influence * curved
