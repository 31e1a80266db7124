# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that an artist has placed: attached to the surface where they were put."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..surface.arrays import Floats, SurfaceArrays
from ..surface.frames import carried, shading
from ..surface.records import Binding, unbound
from .forward import pointing
from .solve import nearest_binding


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
    moved, places = placed & ~unbound(before), positions.copy()
    left, found = before.rows_at(moved), before
    if placed.any():
        nearest = nearest_binding(positions[placed], surface)
        found = found.with_rows(placed, nearest)
        places[placed] = nearest.positions(surface.vertices)
    if moved.any():
        now = carried(left, found.rows_at(moved), surface.vertices, shading(surface))
        found = found.with_rows(moved, now)
    if placed.any():
        found = found.with_rows(placed, pointing(found.rows_at(placed), surface, forward))
    touched = np.concatenate([places[placed], left.positions(surface.vertices)])
    return Attached(found, places, touched)
