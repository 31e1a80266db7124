# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh of even triangles on another one, and what its vertices, corners and faces take over."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base.errors import ScatterError
from .base.native import named, package
from .surface.arrays import Floats, Ints, normals_of

_LEAST_DENSITY = 0.01  # of the largest: at ten times its spacing the surface is still covered
_INWARD = 1e-3  # of the way from a corner on a line to the middle of its triangle
_ALIKE = 0.05  # difference of the cosines of two faces that are turned alike
_BESIDE = 0.5  # of that way: how far above or below its triangle a place is asked for, too
_OUTSIDE = 0.05  # of a triangle, that a corner may lie outside

Options = dict[str, float]  # of the package's remesh(), by name


@dataclass(frozen=True)
class OldMesh:
    """The mesh that is replaced."""

    name: str  # of the object, for messages
    vertices: Floats  # (v, 3) in world space
    faces: Ints  # (t, 3) the triangles that its polygons are cut into
    lines: Ints  # (k, 2) edges that stay: seams, borders of materials, marked ones
    density: Floats | None = None  # as placed_values() gives it; None: the same everywhere


@dataclass(frozen=True)
class NewMesh:
    """The new triangles, and their places on the old ones."""

    faces: Ints  # (m, 3)
    source: Ints  # (n,) the old triangle that each vertex lies on
    weights: Floats  # (n, 3) of its corners
    corner_source: Ints  # (m, 3) the same for the corners: the old triangle on their side of a line
    corner_weights: Floats  # (m, 3, 3)
    face_source: Ints  # (m,) the old triangle at the middle of each
    lines: Ints  # (k, 2) edges along lines
    line_source: Ints  # (k, 2) the vertices of the old edge that each lies on
    surface: Any  # the package's, of the old mesh
    made: Any  # what the package's remesh() has returned
    max_distance: float  # that was asked for; 0: none

    @property
    def report(self) -> Any:
        """The package's figures of the new mesh."""
        return self.made.report

    def at_vertices(self, values: NDArray[Any], faces: Ints) -> Floats:
        """Values (v,) or (v, w) of the old vertices at the new ones."""
        corners = values[faces[self.source]].astype(np.float64)
        weights = self.weights.reshape(-1, 3, *(1,) * (corners.ndim - 2))
        return (corners * weights).sum(axis=1)

    def at_corners(self, values: NDArray[Any]) -> Floats:
        """Values (t, 3) or (t, 3, w) of the corners of the old triangles at the new corners."""
        corners = values[self.corner_source].astype(np.float64)
        ones = (1,) * (corners.ndim - 3)
        weights = self.corner_weights.reshape(*self.corner_weights.shape, *ones)
        return (corners * weights).sum(axis=2)

    def nearest_vertices(self, faces: Ints) -> Ints:
        """The old vertex nearest to each new one in its triangle, for what cannot be mixed."""
        corner = self.weights.argmax(axis=1)
        return faces[self.source, corner]


def remeshed(old: OldMesh, count: int, options: Options, context: Any) -> NewMesh:
    """Remesh, and find the old faces and edges under each part of the new mesh."""
    if len(old.faces) == 0:
        raise ScatterError(f"'{old.name}' has no faces: a new mesh needs a surface")
    with named(old.name):
        surface = surface_of(old)
        made = package().remesh(surface, count, edges=old.lines, context=context, **options)
        return with_sources(surface, old, made, options["max_distance"])


def surface_of(old: OldMesh) -> Any:
    """The package's Surface with the density. ScatterError if that is 0 everywhere."""
    surface = package().Surface(old.vertices, old.faces)
    if old.density is None:
        return surface
    most = old.density.max()
    if most == 0.0:
        raise ScatterError(f"'{old.name}': the density is 0 everywhere")
    values, at = package().density.placed(np.maximum(old.density, _LEAST_DENSITY * most))
    return surface.with_density(values, density_at=at)


def with_sources(surface: Any, old: OldMesh, made: Any, max_distance: float) -> NewMesh:
    """What the package's remesh() of that surface has made, and its places on the old mesh."""
    faces, vertices = np.array(made.faces), np.array(made.vertices)
    middles = vertices[faces].mean(axis=1)
    face_source = package().project(surface, middles).faces
    source, weights = np.array(made.source_faces), np.array(made.barycentric)
    corner_source, corner_weights = source[faces], weights[faces]
    on_line = np.array(made.features)[faces] > 0
    places, triangles = vertices[faces[on_line]], np.nonzero(on_line)[0]
    inward = _INWARD * (middles[triangles] - places)
    beside = _faces_along(
        surface, old, places + inward, inward, normals_of(vertices[faces])[triangles]
    )
    corner_source[on_line] = beside
    corner_weights[on_line] = _weights_at(places, old.vertices[old.faces[beside]])
    lines = np.array(made.lines)
    return NewMesh(
        faces=faces,
        source=source,
        weights=weights,
        corner_source=corner_source,
        corner_weights=corner_weights,
        face_source=np.array(face_source),
        lines=lines,
        line_source=_old_edges(surface, old, vertices[lines].mean(axis=1)),
        surface=surface,
        made=made,
        max_distance=max_distance,
    )


def _faces_along(surface: Any, old: OldMesh, points: Floats, ways: Floats, normals: Floats) -> Ints:
    """The old face (n,) at each point of a triangle.

    Triangles of curved sides cut below them, where the face beyond a crease may be nearer. Of the
    faces nearest to the point and to others above and below it, the one turned most alike counts.
    """
    aside = _BESIDE * np.linalg.norm(ways, axis=1, keepdims=True) * normals
    found = np.array([package().project(surface, points + k * aside).faces for k in (0, 1, -1)])
    turns = [
        np.abs((normals_of(old.vertices[old.faces[one]]) * normals).sum(axis=1)) for one in found
    ]
    gains = np.array(turns) - [[0.0], [_ALIKE], [_ALIKE]]
    best: Ints = found[gains.argmax(axis=0), np.arange(len(points))]
    return best


def _weights_at(points: Floats, corners: Floats) -> Floats:
    """Barycentric coordinates (n, 3) of points (n, 3) beside triangles (n, 3, 3). Those far outside
    are drawn in, as on triangles narrower than the distance."""
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    uu, uv, vv = (u * u).sum(1), (u * v).sum(1), (v * v).sum(1)
    p = points - a
    pu, pv = (p * u).sum(1), (p * v).sum(1)
    area = uu * vv - uv * uv
    safe = np.where(area > 0, area, 1.0)
    second = np.where(area > 0, (vv * pu - uv * pv) / safe, 0.0)
    third = np.where(area > 0, (uu * pv - uv * pu) / safe, 0.0)
    weights = np.stack([1 - second - third, second, third], axis=1).clip(-_OUTSIDE, 1 + _OUTSIDE)
    found: Floats = weights / weights.sum(axis=1, keepdims=True)
    return found


def _old_edges(surface: Any, old: OldMesh, middles: Floats) -> Ints:
    """The old edges (k, 2) nearest to points on lines."""
    if len(middles) == 0:
        return np.empty((0, 2), np.int32)
    found = package().project(surface, middles)
    corner = np.asarray(found.barycentric).argmin(axis=1)
    corners = old.faces[np.asarray(found.faces)]
    rows = np.arange(len(corners))
    ends = np.stack([corners[rows, (corner + 1) % 3], corners[rows, (corner + 2) % 3]], axis=1)
    return np.sort(ends, axis=1).astype(np.int32)
