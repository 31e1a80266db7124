# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of a surface is inside other parts of it, where nothing can see it."""

from typing import Any

import numpy as np

from ..base.native import package
from ..surface.arrays import SurfaceArrays

_PLACES = 400  # that are looked at, spread evenly over the area
_MOST_FACES = 200_000  # more take too long for a default
_LEAST = 0.02  # hidden share from which a surface counts as made of parts


def share_in_parts(arrays: SurfaceArrays, several: bool) -> float:
    """About which share of the area is inside other parts, 0 to 1.

    Parts are the objects of a surface of `several`, or what passes through each other in one: the
    inner shell of a solidified body is no part. 0 for a share that does not count, for very many
    faces, and for a surface that nothing can be scattered on.
    """
    if not 0 < len(arrays.faces) <= _MOST_FACES:
        return 0.0
    try:
        surface = package().Surface(arrays.vertices, arrays.faces)
    except ValueError:  # the solver says what is wrong with it
        return 0.0
    share = _hidden_share(surface)
    return share if share >= _LEAST and (several or _has_crossing_faces(surface)) else 0.0


def _hidden_share(surface: Any) -> float:
    """About which share of the area sees nothing of the sky."""
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    sums = np.cumsum(np.linalg.norm(np.cross(b - a, c - a), axis=1))
    wanted = (np.arange(_PLACES) + 0.5) / _PLACES * sums[-1]
    faces = np.searchsorted(sums, wanted).astype(np.int32)
    seen = package().exposure(surface, faces, np.full((_PLACES, 3), 1.0 / 3.0))
    return float((seen == 0.0).mean())


def _has_crossing_faces(surface: Any) -> bool:
    try:
        # At this length nothing is cut but where faces cross.
        joined = package().refine_outside(surface, np.sqrt(surface.area), openness=0.0)
    except ValueError:  # nothing is seen
        return False
    return len(joined.surface.faces) > len(surface.faces)
