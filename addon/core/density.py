# SPDX-License-Identifier: GPL-3.0-or-later
"""How densely a surface is covered: values that it has, and what its shape says, multiplied."""

from collections.abc import Iterator
from functools import reduce

import numpy as np

from .aspect import aspect_factors
from .frames import corner_normals
from .masks import mask_of
from .native import package
from .settings import MATERIAL, DensitySettings, Settings, materials_of
from .surface import Floats, Ints, SurfaceArrays

_FLOOR = 0.02  # of the largest density, where curvature alone thins


def names_of(settings: Settings) -> list[str]:
    """Attributes and vertex groups that the settings ask for."""
    density = settings.density
    named = [density.attribute, density.blocked, *(kind.density for kind in settings.classes)]
    return sorted({name for name in named if name})


def density_of(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays | None = None
) -> Floats | None:
    """Product of the terms that are known on the faces that were read: at vertices (v,), or on
    faces (m, 1) or at their corners (m, 3) where some term is; None where there is none.

    Of a later frame of a bake with its first one, on which the surface has its curvature.
    """
    terms = [*_stored_terms(arrays, settings), *_terms_by_shape(arrays, settings, first or arrays)]
    return product(terms, arrays.faces) if terms else None


def product(values: list[Floats], faces: Ints) -> Floats:
    """Of values at vertices (v,), on faces (m, 1) and at their corners (m, 3)."""
    of_vertices = [one for one in values if one.ndim == 1]
    found = [one for one in values if one.ndim == 2]
    if of_vertices:
        smooth: Floats = np.prod(of_vertices, axis=0)
        found.append(smooth[faces] if found else smooth)
    return reduce(np.multiply, found)


def _stored_terms(arrays: SurfaceArrays, settings: DensitySettings) -> Iterator[Floats]:
    """Values that the surface has."""
    if settings.attribute:
        yield arrays.weights[settings.attribute]
    if settings.blocked:
        yield 1.0 - np.clip(arrays.weights[settings.blocked], 0.0, 1.0)
    if materials_of(settings):
        chosen = arrays.weights[MATERIAL]
        wanted = 1.0 - chosen if settings.material_invert else chosen
        yield 1.0 - settings.material_strength * (1.0 - wanted)


def _terms_by_shape(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays
) -> Iterator[Floats]:
    if settings.curvature > 0.0:
        yield _by_curvature(first, settings.curvature)
    slope, aspect = mask_of(settings, "slope"), mask_of(settings, "aspect")
    if slope is not None or aspect is not None:
        normals = corner_normals(arrays)
    if slope is not None:
        yield slope.factors(np.arccos(np.clip(normals[:, :, 2], -1.0, 1.0)))
    if aspect is not None:
        yield aspect_factors(normals, aspect, settings.aspect_direction)


def _by_curvature(arrays: SurfaceArrays, influence: float) -> Floats:
    plain = package().Surface(arrays.vertices, arrays.faces)
    curved: Floats = package().curvature_density(plain, floor=_FLOOR)
    return 1.0 - influence + influence * curved
