# SPDX-License-Identifier: GPL-3.0-or-later
"""Binding to the rest position: for surfaces whose modifiers make other faces in every frame.

A point keeps where it sits on the rest shape, the surface before its modifiers, and one more place
a little ahead, in the direction that it has on the surface now.
"""

from dataclasses import replace

import numpy as np

from .binding import bound_nearest
from .errors import ScatterError
from .frames import frames, vertex_normals
from .records import Binding, Columns
from .solve import named
from .surface import Floats, SurfaceArrays

_AHEAD = 0.05  # of the first edge
_ELSEWHERE = 1e-3  # of the surface's size: a point found so far off was found somewhere else


def rest_columns(binding: Binding, rest: Floats, surface: SurfaceArrays) -> Columns:
    """Columns named as in REST_ATTRIBUTES; rest (v, 3) are the vertices' rest positions.

    ScatterError where the rest shape does not tell places apart.
    """
    places = binding.positions(rest)
    _check_unique(binding, places, rest, surface)
    return {"dapple_rest": places, "dapple_ahead": places + _AHEAD * _ahead(binding, rest, surface)}


def _ahead(binding: Binding, rest: Floats, surface: SurfaceArrays) -> Floats:
    """Directions (n, 3) of the points in their triangles, as long as the first edges, at rest."""
    normals = vertex_normals(surface.vertices, surface.faces)
    direction = frames(binding, surface.vertices, normals).direction(binding.carry)
    first, second = _edges(binding, surface.vertices)
    length = np.linalg.norm(first, axis=1, keepdims=True)
    both = np.stack([first, second], axis=2)  # (n, 3, 2): the direction as a sum of both edges
    shares = np.linalg.pinv(both) @ (length * direction)[:, :, None]
    found: Floats = (np.stack(_edges(binding, rest), axis=2) @ shares)[:, :, 0]
    return found


def _edges(binding: Binding, vertices: Floats) -> tuple[Floats, Floats]:
    a, b, c = (vertices[binding.corners[:, k]] for k in range(3))
    return b - a, c - a


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
