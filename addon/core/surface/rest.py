# SPDX-License-Identifier: GPL-3.0-or-later
"""Binding to the rest position, for surfaces whose modifiers change the faces in every frame.

A point stores its place on the rest shape, the surface before its modifiers, and one more place a
little ahead, in the direction that it has on the surface now. A baked keyframe stores both by the
corners of its triangle on the rest shape. Mirror and Array place several faces on one place of the
rest shape. They create ranges of faces of equal length, and Subdivision keeps their order. So a
place also has a part: the number of its range.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import named, package
from .arrays import Floats, Ints, SurfaceArrays
from .binding import attached_to
from .frames import frames, shading
from .records import Binding, Columns

_AHEAD = 0.05  # relative to the length of the first edge
_ELSEWHERE = 1e-3  # relative to the surface's size: a point found farther away is at a wrong place
_INSIDE = 1e-5  # relative to the surface's size: distance of places from the borders of their faces
_MOST_PARTS = 64


@dataclass(frozen=True)
class AtRest:
    """Places of points on a rest shape."""

    columns: Columns  # named as in REST_ATTRIBUTES
    parts: int  # parts of the rest shape


def at_rest(binding: Binding, surface: SurfaceArrays) -> AtRest:
    """Places of points on the rest shape; ScatterError if several places of it coincide."""
    divided = with_distinct_parts(binding, surface)
    return AtRest(rest_columns(binding, divided), divided.rest_parts)


def rest_columns(binding: Binding, surface: SurfaceArrays) -> Columns:
    """Columns named as in REST_ATTRIBUTES, for points bound to a surface with a rest shape."""
    assert surface.rest is not None
    places = off_borders(binding, surface.rest).positions(surface.rest)
    ahead = _ahead(binding, surface.rest, surface)
    parts = _parts(binding, surface)
    return {"dapple_rest": places, "dapple_ahead": places + _AHEAD * ahead, "dapple_part": parts}


def bound_at_rest(columns: Columns, surface: SurfaceArrays) -> Binding:
    """Binding of points to a surface with other faces, by their places on the rest shape."""
    assert surface.rest is not None
    places = np.asarray(columns["dapple_rest"], dtype=np.float64)
    found = Shape(surface).nearest(places, np.asarray(columns["dapple_part"]))
    ahead = (np.asarray(columns["dapple_ahead"], dtype=np.float64) - places)[:, :, None]
    shares = np.linalg.pinv(np.stack(_edges(found, surface.rest), axis=2)) @ ahead
    direction = (np.stack(_edges(found, surface.vertices), axis=2) @ shares)[:, :, 0]
    local = frames(found, surface.vertices, shading(surface))
    return replace(found, angle=local.angle(direction))


def rebound_at_rest(binding: Binding, before: SurfaceArrays, after: SurfaceArrays) -> Binding:
    """Binding to other faces at the same places of the rest shape."""
    return bound_at_rest(rest_columns(binding, before), after)


def with_distinct_parts(binding: Binding, surface: SurfaceArrays) -> SurfaceArrays:
    """The surface with the fewest parts of its rest shape that keep these points distinct.

    ScatterError if there is no such number.
    """
    assert surface.rest is not None
    binding = off_borders(binding, surface.rest)
    first = Shape(surface).elsewhere(binding, surface.vertices)
    if first is None:
        return surface
    for parts in range(2, _MOST_PARTS + 1):
        divided = replace(surface, rest_parts=parts)
        if len(surface.faces) % parts == 0 and _tells_apart(binding, divided):
            return divided
    raise ScatterError(first)


def off_borders(binding: Binding, rest: Floats) -> Binding:
    """Move points slightly off the borders of their faces.

    Faces that were split along an edge, as some file formats do, meet there at rest, even if a
    modifier moves them apart. A place on the edge itself could be on either of them.
    """
    a, b, c = (rest[binding.corners[:, k]] for k in range(3))
    longest = np.linalg.norm([b - a, c - b, a - c], axis=2).max(axis=0, initial=1e-30)
    size = float(np.linalg.norm(np.ptp(rest, axis=0))) if len(rest) else 0.0
    least = np.minimum(_INSIDE * size / longest, 0.05)[:, None]
    weights = np.where(binding.barycentric < least, least, binding.barycentric)
    weights /= weights.sum(axis=1, keepdims=True)
    placed = binding.barycentric.any(axis=1, keepdims=True)
    return replace(binding, barycentric=np.where(placed, weights, binding.barycentric))


def _tells_apart(binding: Binding, surface: SurfaceArrays) -> bool:
    try:
        return Shape(surface).elsewhere(binding, surface.vertices) is None
    except ScatterError:  # a part has no area
        return False


class Shape:
    """The rest shape of a surface, in which places are searched."""

    def __init__(self, surface: SurfaceArrays) -> None:
        assert surface.rest is not None
        self._surface, self._rest = surface, surface.rest
        self._native: dict[int, Any] = {}  # by part

    def nearest(self, places: Floats, parts: Ints) -> Binding:
        """Binding to the nearest places on the rest shape, each in its own part."""
        found, weights = np.zeros(len(places), np.int32), np.zeros((len(places), 3))
        for part in np.unique(parts).tolist():
            there = parts == part
            faces = np.flatnonzero(self._surface.parts == part)
            with named(self._surface.name):
                if part not in self._native:
                    self._native[part] = package().Surface(self._rest, self._surface.faces[faces])
                closest = package().project(self._native[part], places[there])
            found[there], weights[there] = faces[closest.faces], closest.barycentric
        return attached_to(self._surface, found, weights)

    def elsewhere(self, binding: Binding, vertices: Floats) -> str | None:
        """The point that its rest position puts at the wrong place by the largest distance; None if
        none.
        """
        found = self.nearest(binding.positions(self._rest), _parts(binding, self._surface))
        seen = found.positions(vertices) - binding.positions(vertices)
        apart = np.linalg.norm(seen, axis=1)
        if not (apart > _ELSEWHERE * float(np.linalg.norm(np.ptp(vertices, axis=0)))).any():
            return None
        point = int(np.argmax(apart))
        return (
            f"Surface '{self._surface.name}': point {point} has the rest position of another "
            f"place, {apart[point]:.3g} away (a modifier makes copies or a thickness): use Match "
            "Subdivision and set Attach To to Faces, or apply that modifier"
        )


def _ahead(binding: Binding, rest: Floats, surface: SurfaceArrays) -> Floats:
    """Directions (n, 3) of the points in their triangles, as long as the first edges, at rest."""
    local = frames(binding, surface.vertices, shading(surface))
    edges = np.stack(_edges(binding, surface.vertices), axis=2)  # (n, 3, 2)
    # In the triangle's plane, below the direction as one looks along the normal.
    both = np.concatenate([edges, local.normal[:, :, None]], axis=2)
    shares = (np.linalg.pinv(both) @ local.direction(binding.angle)[:, :, None])[:, :2]
    lengths = (
        np.linalg.norm(edges @ shares, axis=1) / np.linalg.norm(edges[:, :, 0], axis=1)[:, None]
    )
    shares /= np.maximum(lengths, 1e-30)[:, :, None]
    found: Floats = (np.stack(_edges(binding, rest), axis=2) @ shares)[:, :, 0]
    return found


def _edges(binding: Binding, vertices: Floats) -> tuple[Floats, Floats]:
    a, b, c = (vertices[binding.corners[:, k]] for k in range(3))
    return b - a, c - a


def _parts(binding: Binding, surface: SurfaceArrays) -> Ints:
    """Parts (n,) of the points, however faces are cut; ranges share vertices where they meet."""
    first = np.zeros(len(surface.vertices), dtype=np.int32)  # first part with each vertex
    first[surface.faces[::-1].ravel()] = np.repeat(surface.parts[::-1], 3)
    found: Ints = first[binding.corners].max(axis=1, initial=0)
    return found
