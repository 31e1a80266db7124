# SPDX-License-Identifier: GPL-3.0-or-later
"""How densely a surface is covered: values of its vertices, and what its shape says, multiplied."""

from typing import Any

import numpy as np

from .frames import vertex_normals
from .native import package
from .settings import DensitySettings, Settings
from .surface import Floats, SurfaceArrays

_FLOOR = 0.02  # of the largest density, where curvature alone thins


def names_of(settings: Settings) -> list[str]:
    """Values of the vertices that the settings ask for, by the name of their attribute."""
    named = [settings.density.attribute, *(kind.density for kind in settings.classes)]
    return sorted({name for name in named if name})


def native_surface(arrays: SurfaceArrays, settings: Settings) -> Any:
    """The surface with its density, as a dapple.Surface."""
    density = density_of(arrays, settings.density)
    return package().Surface(arrays.vertices, arrays.faces, density)


def class_density(surface: Any, arrays: SurfaceArrays, name: str) -> Floats | None:
    """The density (v,) of a class with values of its own; None where it has the surface's.

    surface is native_surface() of the arrays.
    """
    if not name:
        return None
    own = arrays.weights[name]
    return own if surface.density is None else own * surface.density


def density_of(arrays: SurfaceArrays, settings: DensitySettings) -> Floats | None:
    """The density (v,) of the vertices; None where it is the same everywhere."""
    terms = []
    if settings.attribute:
        terms.append(arrays.weights[settings.attribute])
    if settings.curvature > 0.0:
        terms.append(_by_curvature(arrays, settings.curvature))
    if settings.use_slope:
        up = vertex_normals(arrays.vertices, arrays.faces)[:, 2]
        angle = np.arccos(np.clip(up, -1.0, 1.0))
        terms.append(window(angle, settings.slope_from, settings.slope_to, settings.slope_fade))
    if settings.use_height:
        height = arrays.vertices[:, 2]
        terms.append(window(height, settings.height_from, settings.height_to, settings.height_fade))
    return np.prod(terms, axis=0) if terms else None


def at_points(density: Floats | None, corners: Any, barycentric: Floats) -> Floats:
    """Density (n,) of bound points, as a share of the largest of any vertex."""
    if density is None or not len(corners) or density.max() <= 0.0:
        return np.ones(len(corners))
    found: Floats = np.einsum("nk,nk->n", barycentric, density[corners]) / density.max()
    return found


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
