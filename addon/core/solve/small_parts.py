# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a surface that are too small for a whole point.

Points do not move from one part to another, so a part whose area is worth half a point has one
point or none. That makes areas uneven however long the solver works.
"""

import numpy as np
from numpy.typing import NDArray

from ..density.masked_surface import MaskedSurface
from ..surface.arrays import Floats

_WHOLE = 0.9  # of a point's area; larger parts are nearly as good as whole


def small_parts(masked: MaskedSurface, count: int) -> list[NDArray[np.int64]]:
    """Faces (k,) of each connected part of the original surface that has a density, but nowhere
    enough of it for one of so many points.
    """
    surface = masked.surface
    islands, parents = surface.islands, masked.pieces[0]
    parts = masked.original.with_density(None).islands
    capacities = _capacities(masked)
    there = (islands >= 0) & (parts[parents] >= 0)
    if not there.any() or not count:
        return []
    most = np.bincount(islands[there], capacities[there])
    needed = _WHOLE * capacities.sum() / count
    of_piece, is_large = parts[parents[there]], most[islands[there]] >= needed
    some = np.bincount(of_piece, minlength=parts.max() + 1) > 0
    large = np.bincount(of_piece, is_large, minlength=parts.max() + 1) > 0
    order = np.argsort(parts, kind="stable")
    faces = np.split(order, np.searchsorted(parts[order], np.arange(parts.max() + 1)))[1:]
    return [faces[part] for part in np.flatnonzero(some & ~large)]


def _capacities(masked: MaskedSurface) -> Floats:
    """Integrals (m,) of the density over the faces that were cut."""
    surface = masked.surface
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    found: Floats = areas * masked.corner_density().mean(axis=1)
    return found
