# SPDX-License-Identifier: GPL-3.0-or-later
"""Binding to the rest position: for surfaces whose modifiers make other faces in every frame.

A point keeps where it sits on the rest shape, the surface before its modifiers, and one more place
a little ahead, in the direction that it has on the surface now. A baked key tells both by the
corners of its triangle on the rest shape.

Mirror and Array lay several faces on one place of the rest shape. They make them run after run, all
as long; Subdivision keeps the order. So a place also has a part: the number of its run.
"""

from dataclasses import dataclass, replace

import numpy as np

from .binding import bound_nearest
from .errors import ScatterError
from .frames import frames, vertex_normals
from .records import Binding, Columns
from .solve import named
from .surface import Floats, Ints, SurfaceArrays

_AHEAD = 0.05  # of the first edge
_ELSEWHERE = 1e-3  # of the surface's size: a point found so far off was found somewhere else
_MOST_PARTS = 64


@dataclass(frozen=True)
class AtRest:
    """Where points sit on a rest shape."""

    columns: Columns  # named as in REST_ATTRIBUTES
    parts: int  # of the rest shape


def at_rest(binding: Binding, surface: SurfaceArrays) -> AtRest:
    """Where points are on the rest shape; ScatterError where that does not tell them apart."""
    divided = told_apart(binding, surface)
    return AtRest(rest_columns(binding, divided), divided.rest_parts)


def rest_columns(binding: Binding, surface: SurfaceArrays) -> Columns:
    """Columns named as in REST_ATTRIBUTES, of points bound to a surface with a rest shape."""
    assert surface.rest is not None
    places, ahead = binding.positions(surface.rest), _ahead(binding, surface.rest, surface)
    parts = _parts(binding, surface)
    return {"dapple_rest": places, "dapple_ahead": places + _AHEAD * ahead, "dapple_part": parts}


def bound_at_rest(columns: Columns, surface: SurfaceArrays) -> Binding:
    """The binding of points to a surface with other faces, by their places on its rest shape."""
    assert surface.rest is not None
    places = np.asarray(columns["dapple_rest"], dtype=np.float64)
    found = _nearest(places, np.asarray(columns["dapple_part"]), surface)
    ahead = (np.asarray(columns["dapple_ahead"], dtype=np.float64) - places)[:, :, None]
    shares = np.linalg.pinv(np.stack(_edges(found, surface.rest), axis=2)) @ ahead
    direction = (np.stack(_edges(found, surface.vertices), axis=2) @ shares)[:, :, 0]
    local = frames(found, surface.vertices, vertex_normals(surface.vertices, surface.faces))
    return replace(found, carry=local.angle(direction))


def told_apart(binding: Binding, surface: SurfaceArrays) -> SurfaceArrays:
    """The surface with as few parts of its rest shape as tell the places of these points apart.

    ScatterError where none do.
    """
    first = _elsewhere(binding, surface)
    if first is None:
        return surface
    count = len(surface.faces)
    for parts in range(2, _MOST_PARTS + 1):
        divided = replace(surface, rest_parts=parts)
        if count % parts == 0 and _elsewhere(binding, divided) is None:
            return divided
    point, apart = first
    raise ScatterError(
        f"Surface '{surface.name}': point {point} has the rest position of another place, "
        f"{apart:.3g} away (a modifier makes copies or a thickness): use Match Subdivision and set "
        "Bind To to Faces, or apply that modifier"
    )


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


def _elsewhere(binding: Binding, surface: SurfaceArrays) -> tuple[int, float] | None:
    """The point that its rest position puts farthest off, if one is put to another place."""
    assert surface.rest is not None
    parts = _parts(binding, surface)
    found = _nearest(binding.positions(surface.rest), parts, surface)
    seen = found.positions(surface.vertices)
    apart = np.linalg.norm(seen - binding.positions(surface.vertices), axis=1)
    size = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    if not (apart > _ELSEWHERE * size).any():
        return None
    point = int(np.argmax(apart))
    return point, float(apart[point])


def _parts(binding: Binding, surface: SurfaceArrays) -> Ints:
    """Parts (n,) of the points, however the faces are cut: where runs meet, vertices are shared."""
    first = np.zeros(len(surface.vertices), dtype=np.int32)  # part with the vertex
    first[surface.faces[::-1].ravel()] = np.repeat(surface.parts[::-1], 3)
    found: Ints = first[binding.corners].max(axis=1, initial=0)
    return found


def _nearest(places: Floats, parts: Ints, surface: SurfaceArrays) -> Binding:
    """Binding to the places nearest on the rest shape, each in its own part."""
    assert surface.rest is not None
    corners, weights = np.zeros((len(places), 3), np.int32), np.zeros((len(places), 3))
    for part in np.unique(parts):
        there, faces = parts == part, surface.faces[surface.parts == part]
        with named(surface.name):
            found = bound_nearest(
                places[there], replace(surface, vertices=surface.rest, faces=faces)
            )
        corners[there], weights[there] = found.corners, found.barycentric
    return Binding(corners, weights, np.zeros(len(places)))
