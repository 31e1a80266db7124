# SPDX-License-Identifier: GPL-3.0-or-later
"""The terms of a density, computed by the package's density functions."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..base.native import package
from ..settings.values import MATERIAL, DensitySettings, Settings, materials_of
from ..surface.arrays import Floats, SurfaceArrays, turn_of
from ..surface.frames import corner_normals

_LOOK = (
    0.02  # longest edge of faces of which the corners tell what hides them, in sizes of the surface
)
_FLOOR = 0.02  # smallest density by curvature, relative to the largest


def names_of(settings: Settings) -> list[str]:
    """Attributes and vertex groups that the settings use."""
    density = settings.density
    named = [
        density.attribute,
        density.blocked_areas,
        *(kind.density for kind in settings.object_types),
    ]
    return sorted({name for name in named if name})


def has_mask(settings: DensitySettings, name: str) -> bool:
    """Whether this mask has an effect."""
    return bool(getattr(settings, f"use_{name}") and getattr(settings, f"{name}_strength") > 0.0)


def range_of(settings: DensitySettings, name: str) -> Any:
    """The dapple.density.Range of this mask; None if it has no effect."""
    if not has_mask(settings, name):
        return None
    ends = ("min", "max", "falloff", "invert", "strength")
    return package().density.Range(*(getattr(settings, f"{name}_{end}") for end in ends))


def density_of(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays | None = None
) -> Floats | None:
    """Product of the terms that are known on the original faces.

    At vertices (v,), or on faces (m, 1) or corners (m, 3) if a term needs it; None if there is no
    term. In later frames of a bake the curvature is that of the first frame.
    """
    terms = [*_stored_terms(arrays, settings), *_terms_by_shape(arrays, settings, first or arrays)]
    return package().density.product(terms, arrays.faces) if terms else None


def _stored_terms(arrays: SurfaceArrays, settings: DensitySettings) -> Iterator[Floats]:
    """Values stored with the surface."""
    if settings.attribute:
        yield arrays.weights[settings.attribute]
    if settings.blocked_areas:
        yield 1.0 - np.clip(arrays.weights[settings.blocked_areas], 0.0, 1.0)
    if materials_of(settings):
        chosen = arrays.weights[MATERIAL]
        wanted = 1.0 - chosen if settings.material_invert else chosen
        yield 1.0 - settings.material_strength * (1.0 - wanted)


def _terms_by_shape(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays
) -> Iterator[Floats]:
    if settings.curvature > 0.0:
        yield _by_curvature(first, settings.curvature)
    slope, aspect = range_of(settings, "slope"), range_of(settings, "aspect")
    if slope is not None or aspect is not None:
        normals = corner_normals(arrays)
    if slope is not None:
        yield package().density.slope(normals, slope)
    if aspect is not None:
        yield package().density.aspect(normals, aspect, settings.aspect_direction)


def _by_curvature(arrays: SurfaceArrays, influence: float) -> Floats:
    plain = package().Surface(arrays.vertices, arrays.faces)
    curved: Floats = package().curvature_density(plain, floor=_FLOOR)
    return 1.0 - influence + influence * curved


def fields_of(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays | None = None
) -> list[Any]:
    """The dapple.density.Field of each term that is independent of faces.

    In later frames of a bake, border and noise are those of the first frame.
    """
    around, density, found = arrays.around, package().density, []
    if (within := range_of(settings, "height")) is not None:
        found.append(density.Height(within, float(np.abs(arrays.vertices[:, 2]).max(initial=0.0))))
    found += _distances(arrays, settings, first)
    if (within := range_of(settings, "noise")) is not None:
        found.append(_noise(within, settings, (first or arrays).matrix, first is not None))
    if around.camera is not None:
        found.append(_camera(arrays, settings))
    found += [density.Obstacle(*mesh, settings.avoid_margin) for mesh in around.obstacles]
    if len(around.hulls):
        found.append(density.Solids(around.hulls, around.hull_counts, settings.avoid_margin))
    return found


def _camera(arrays: SurfaceArrays, settings: DensitySettings) -> Any:
    """The field of the camera's view, without what is hidden from it if the settings say so."""
    around, meshes, longest = arrays.around, [], np.inf
    if settings.camera_hidden:
        meshes = [(arrays.vertices, arrays.faces), *around.hiding]
        longest = _LOOK * float(np.linalg.norm(np.ptp(arrays.vertices, axis=0)))
    return package().density.Camera(around.camera, settings.camera_margin, meshes, longest)


def _distances(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays | None
) -> Iterator[Any]:
    """Fields of the distances to objects and to the border; empty if there are none."""
    around, density, begin = arrays.around, package().density, first or arrays
    within = range_of(settings, "distance")
    if within is not None and (around.targets or len(around.lines)):
        nearest = density.Nearest(around.targets, around.lines, settings.ignore_height)
        yield density.Distance(within, nearest)
    within = range_of(settings, "border")
    if within is not None:
        border = density.border_edges(begin.vertices, begin.faces)
        if len(border):
            yield density.Distance(within, density.Nearest((), border), rides=first is not None)


def _noise(within: Any, settings: DensitySettings, matrix: Floats, rides: bool) -> Any:
    """The noise field, in the axes of the surface's object and with lengths of the world."""
    return package().density.Noise(
        within,
        size=settings.noise_size,
        detail=settings.noise_detail,
        seed=settings.noise_seed,
        origin=matrix[:3, 3],
        axes=turn_of(matrix),
        rides=rides,
    )
