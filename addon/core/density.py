# SPDX-License-Identifier: GPL-3.0-or-later
"""How densely a surface is covered: values of its vertices, and what its shape says, multiplied."""

import numpy as np

from .aspect import aspect_factors
from .frames import vertex_normals
from .masks import mask_of
from .native import package
from .settings import DensitySettings, Settings
from .surface import Floats, SurfaceArrays

_FLOOR = 0.02  # of the largest density, where curvature alone thins


def names_of(settings: Settings) -> list[str]:
    """Values of the vertices that the settings ask for, by the name of their attribute."""
    density = settings.density
    named = [density.attribute, density.blocked, *(kind.density for kind in settings.classes)]
    return sorted({name for name in named if name})


def density_of(arrays: SurfaceArrays, settings: DensitySettings) -> Floats | None:
    """Product of the terms that are known at vertices (v,), or at the corners of faces (m, 3) where
    these differ at a vertex; None where there is none.
    """
    terms = _vertex_terms(arrays, settings)
    found = np.prod(terms, axis=0) if terms else None
    aspect = mask_of(settings, "aspect")
    if aspect is None:
        return found
    factors = aspect_factors(arrays, aspect, settings.aspect_direction)
    return factors if found is None else factors * found[arrays.faces]


def _vertex_terms(arrays: SurfaceArrays, settings: DensitySettings) -> list[Floats]:
    terms = []
    if settings.attribute:
        terms.append(arrays.weights[settings.attribute])
    if settings.blocked:
        terms.append(1.0 - np.clip(arrays.weights[settings.blocked], 0.0, 1.0))
    if settings.curvature > 0.0:
        terms.append(_by_curvature(arrays, settings.curvature))
    slope = mask_of(settings, "slope")
    if slope is not None:
        up = vertex_normals(arrays.vertices, arrays.faces)[:, 2]
        terms.append(slope.factors(np.arccos(np.clip(up, -1.0, 1.0))))
    return terms


def _by_curvature(arrays: SurfaceArrays, influence: float) -> Floats:
    plain = package().Surface(arrays.vertices, arrays.faces)
    curved: Floats = package().curvature_density(plain, floor=_FLOOR)
    return 1.0 - influence + influence * curved
