# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a surface is inside other parts of it, where nothing can see it."""

import numpy as np

from ..base.native import package
from ..surface.arrays import Floats, SurfaceArrays

_PLACES = 400  # that are looked at, spread evenly over the area
_MOST_FACES = 200_000  # more take too long for a default
MADE_OF_PARTS = 0.02  # hidden share from which a surface counts as made of parts


def hidden_share(arrays: SurfaceArrays) -> float:
    """About which share of the area sees nothing of the sky, 0 to 1.

    0 for very many faces, and for a surface that nothing can be scattered on.
    """
    if not 0 < len(arrays.faces) <= _MOST_FACES:
        return 0.0
    try:
        surface = package().Surface(arrays.vertices, arrays.faces)
    except ValueError:  # the solver says what is wrong with it
        return 0.0
    sums = np.cumsum(_areas(arrays))
    wanted = (np.arange(_PLACES) + 0.5) / _PLACES * sums[-1]
    faces = np.searchsorted(sums, wanted).astype(np.int32)
    seen = package().exposure(surface, faces, np.full((_PLACES, 3), 1.0 / 3.0))
    return float((seen == 0.0).mean())


def parts_cross(arrays: SurfaceArrays) -> bool:
    """Whether faces of the surface pass through each other."""
    surface = package().Surface(arrays.vertices, arrays.faces)
    try:
        # At this length nothing is cut but where faces cross.
        joined = package().refine_outside(surface, np.sqrt(surface.area), openness=0.0)
    except ValueError:  # nothing is seen
        return False
    return len(joined.surface.faces) > len(arrays.faces)


def _areas(arrays: SurfaceArrays) -> Floats:
    a, b, c = (arrays.vertices[arrays.faces[:, k]] for k in range(3))
    areas: Floats = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return areas
