# SPDX-License-Identifier: GPL-3.0-or-later
"""Binding to the rest position: for surfaces whose modifiers make other faces in every frame.

A point keeps where it sits on the rest shape, the surface before its modifiers, and one more place
a little ahead, in the direction that it has on the surface now. A baked key stores both by the
corners of its triangle on the rest shape.

Mirror and Array lay several faces on one place of the rest shape. They make them run after run, all
as long; Subdivision keeps the order. So a place also has a part: the number of its run.
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

_AHEAD = 0.05  # of the first edge
_ELSEWHERE = 1e-3  # of the surface's size: a point found so far off was found somewhere else
_MOST_PARTS = 64


@dataclass(frozen=True)
class AtRest:
    """Where points sit on a rest shape."""

    columns: Columns  # named as in REST_ATTRIBUTES
    parts: int  # of the rest shape


def at_rest(binding: Binding, surface: SurfaceArrays) -> AtRest:
    """Where points are on the rest shape; ScatterError where several places of it coincide."""
    divided = with_distinct_parts(binding, surface)
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
    found = Shape(surface).nearest(places, np.asarray(columns["dapple_part"]))
    ahead = (np.asarray(columns["dapple_ahead"], dtype=np.float64) - places)[:, :, None]
    shares = np.linalg.pinv(np.stack(_edges(found, surface.rest), axis=2)) @ ahead
    direction = (np.stack(_edges(found, surface.vertices), axis=2) @ shares)[:, :, 0]
    local = frames(found, surface.vertices, shading(surface))
    return replace(found, angle=local.angle(direction))


def rebound_at_rest(binding: Binding, before: SurfaceArrays, after: SurfaceArrays) -> Binding:
    """The binding to the same places of the rest shape, of points bound to other faces."""
    return bound_at_rest(rest_columns(binding, before), after)


def with_distinct_parts(binding: Binding, surface: SurfaceArrays) -> SurfaceArrays:
    """The surface with as few parts of its rest shape as keep the places of these points distinct.

    ScatterError where none do.
    """
    first = Shape(surface).elsewhere(binding, surface.vertices)
    if first is None:
        return surface
    for parts in range(2, _MOST_PARTS + 1):
        divided = replace(surface, rest_parts=parts)
        if len(surface.faces) % parts == 0 and _tells_apart(binding, divided):
            return divided
    raise ScatterError(first)


def _tells_apart(binding: Binding, surface: SurfaceArrays) -> bool:
    try:
        return Shape(surface).elsewhere(binding, surface.vertices) is None
    except ScatterError:  # a part of it has no area
        return False


class Shape:
    """The rest shape of a surface, where places are looked for."""

    def __init__(self, surface: SurfaceArrays) -> None:
        assert surface.rest is not None
        self._surface, self._rest = surface, surface.rest
        self._native: dict[int, Any] = {}  # by part

    def nearest(self, places: Floats, parts: Ints) -> Binding:
        """Binding to the places nearest to those on the rest shape, each in its own part."""
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
        """Which point its rest position puts farthest off, if one is put to another place."""
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
    """Parts (n,) of the points, however the faces are cut: where runs meet, vertices are shared."""
    first = np.zeros(len(surface.vertices), dtype=np.int32)  # part with the vertex
    first[surface.faces[::-1].ravel()] = np.repeat(surface.parts[::-1], 3)
    found: Ints = first[binding.corners].max(axis=1, initial=0)
    return found
