# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that an artist has placed: attached to the surface where they were put."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .forward import pointing
from .frames import carried
from .records import Binding, unbound
from .solve import nearest_binding
from .surface import Floats, SurfaceArrays


@dataclass(frozen=True)
class Attached:
    """All points of a scatter, some of them where they were placed."""

    binding: Binding
    positions: Floats  # (n, 3) in world space; those that were not placed are where they were
    touched: Floats  # (k, 3) where points were placed, and where they were before


def attached(
    before: Binding,
    positions: Floats,
    placed: NDArray[np.bool_],
    surface: SurfaceArrays,
    forward: str = "NONE",
) -> Attached:
    """Attach the placed points, which are at positions (n, 3), to the nearest places of a surface.

    Points that were attached before keep their directions as far as the normals let them.
    """
    corners, weights, carry = before.corners.copy(), before.barycentric.copy(), before.carry.copy()
    moved, places = placed & ~unbound(before), positions.copy()
    left = _only(before, moved)
    if placed.any():
        nearest = nearest_binding(positions[placed], surface)
        corners[placed], weights[placed] = nearest.corners, nearest.barycentric
        carry[placed] = 0.0
        places[placed] = nearest.positions(surface.vertices)
    found = Binding(corners, weights, carry)
    if moved.any():
        now = _only(found, moved)
        carry[moved] = carried(left, now, surface.vertices, surface.faces).carry
    if placed.any():
        carry[placed] = pointing(_only(found, placed), surface, forward).carry
    touched = np.concatenate([places[placed], left.positions(surface.vertices)])
    return Attached(found, places, touched)


def _only(binding: Binding, rows: NDArray[np.bool_]) -> Binding:
    return Binding(binding.corners[rows], binding.barycentric[rows], binding.carry[rows])
