# SPDX-License-Identifier: GPL-3.0-or-later
"""Binding to the rest position: for surfaces whose modifiers make other faces in every frame.

A point keeps where it sits on the rest shape, the surface before its modifiers, and one more place
a little ahead along the first edge of its triangle, which gives it a direction.
"""

from dataclasses import replace

import numpy as np

from .binding import bound_nearest
from .errors import ScatterError
from .records import Binding, Columns
from .solve import named
from .surface import Floats, SurfaceArrays

_AHEAD = 0.05  # of the edge
_ELSEWHERE = 1e-3  # of the surface's size: a point found so far off was found somewhere else


def rest_columns(binding: Binding, rest: Floats, surface: SurfaceArrays) -> Columns:
    """Columns named as in REST_ATTRIBUTES; rest (v, 3) are the vertices' rest positions.

    ScatterError where the rest shape does not tell places apart.
    """
    places = binding.positions(rest)
    edge = rest[binding.corners[:, 1]] - rest[binding.corners[:, 0]]
    _check_unique(binding, places, rest, surface)
    return {"dapple_rest": places, "dapple_ahead": places + _AHEAD * edge}


def _check_unique(binding: Binding, places: Floats, rest: Floats, surface: SurfaceArrays) -> None:
    with named(surface.name):
        found = bound_nearest(places, replace(surface, vertices=rest))
    seen = found.positions(surface.vertices)
    apart = np.linalg.norm(seen - binding.positions(surface.vertices), axis=1)
    size = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    if (apart > _ELSEWHERE * size).any():
        point = int(np.argmax(apart))
        raise ScatterError(
            f"Surface '{surface.name}': point {point} has the rest position of another place, "
            f"{apart[point]:.3g} away (a Mirror or Array modifier makes such copies): apply that "
            "modifier, or set Bind To to Faces"
        )
