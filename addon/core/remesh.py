# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh of even triangles on another one, and what its vertices, corners and faces take over."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .base.errors import ScatterError
from .base.native import named, package
from .surface.arrays import Floats, Ints, normals_of
from .surface.mesh_snapshot import RawImage, image_density

_LEAST_DENSITY = 0.01  # of the largest: at ten times its spacing the surface is still covered
_INWARD = 1e-3  # of the way from a corner on a line to the middle of its triangle
_ALIKE = 0.05  # difference of the cosines of two faces that are turned alike
_BESIDE = 0.5  # of that way: how far above or below its triangle a place is asked for, too
_OUTSIDE = 0.05  # of a triangle, that a corner may lie outside
_CUTTING = 0.1  # share of the progress for cutting triangles by an image

Options = dict[str, float]  # of the package's remesh(), by name


@dataclass(frozen=True)
class Pixels:
    """An image or its UDIM tiles, the same for all frames of an animation."""

    images: tuple[RawImage, ...]
    channel: str

    @cached_property
    def density(self) -> dict[str, Any]:
        """Its fields of the package's MaskedSurface; ScatterError if it cannot be a density."""
        return image_density(self.images, self.channel)


@dataclass(frozen=True)
class Picture:
    """An image on a mesh."""

    pixels: Pixels
    uv: Floats  # (t, 3, 2) at the corners of the triangles


@dataclass(frozen=True)
class OldMesh:
    """The mesh that is replaced."""

    name: str  # of the object, for messages
    vertices: Floats  # (v, 3) in world space
    faces: Ints  # (t, 3) the triangles that its polygons are cut into
    lines: Ints  # (k, 2) edges that stay: seams, borders of materials, marked ones
    density: Floats | None = None  # as placed_values() gives it; None: the same everywhere
    picture: Picture | None = None  # by which it is multiplied


@dataclass(frozen=True)
class Ground:
    """What is remeshed: the old triangles with their density, in pieces where an image needs it."""

    old: Any  # the package's Surface of the old triangles
    surface: Any  # that of the pieces
    lines: Ints  # (k, 2) edges of the pieces that stay
    masked: Any = None  # the package's MaskedSurface; None: each piece is a whole triangle

    def on_old(self, pieces: Ints, weights: Floats) -> tuple[Ints, Floats]:
        """Places on pieces (n,), by weights (n, 3) of their corners, as those on old triangles."""
        if self.masked is None:
            return pieces, weights
        parents, corners = self.masked.pieces
        return parents[pieces], np.einsum("nk,nkd->nd", weights, corners[pieces])

    def vertices(self, old: Floats) -> Floats:
        """Vertices of the pieces once the old ones are at (v, 3)."""
        return old if self.masked is None else np.asarray(self.masked.vertices(old))


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
    ground: Ground
    made: Any  # what the package's remesh() has returned
    max_distance: float  # that was asked for; 0: none
    left_out: int  # vertices of the old mesh that no face has

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
        ground = ground_of(old, count, context)
        given = {"edges": ground.lines, "context": rest_of(context, old)}
        made = package().remesh(ground.surface, count, **given, **options)
        return with_sources(ground, old, made, options["max_distance"])


def rest_of(context: Any, old: OldMesh) -> Any:
    """The share of a context that is left after ground_of()."""
    return context if old.picture is None else context.part(_CUTTING, 1.0)


def ground_of(old: OldMesh, count: int, context: Any) -> Ground:
    """What is remeshed with so many vertices. ScatterError if its density is 0 everywhere."""
    surface = package().Surface(old.vertices, old.faces)
    if old.density is not None:
        if old.density.max() == 0.0:
            raise ScatterError(f"'{old.name}': the density is 0 everywhere")
        surface = _with_density(surface, old.density)
    if old.picture is None:
        return Ground(surface, surface, old.lines)
    masked = package().density.MaskedSurface(
        surface,
        count=count,
        uv=old.picture.uv,
        context=context.part(0.0, _CUTTING),
        **old.picture.pixels.density,
    )
    cut = _with_density(masked.surface, masked.corner_density())
    return Ground(surface, cut, _lines_of_pieces(old, masked), masked)


def _with_density(surface: Any, density: Floats) -> Any:
    """The surface with a density that is large enough everywhere for the surface to be covered."""
    values, at = package().density.placed(np.maximum(density, _LEAST_DENSITY * density.max()))
    return surface.with_density(values, density_at=at)


def _lines_of_pieces(old: OldMesh, masked: Any) -> Ints:
    """The edges (k, 2) of pieces that lie on lines of the old mesh."""
    pieces, (parents, weights) = np.array(masked.surface.faces), masked.pieces
    size = len(old.vertices)
    wanted = _keys(old.lines, size)
    found = [np.empty((0, 2), np.int32)]
    for opposite in range(3):
        sides = old.faces[:, [(opposite + 1) % 3, (opposite + 2) % 3]]
        is_line = np.isin(_keys(sides, size), wanted)[parents]
        for corner in range(3):
            ends = [corner, (corner + 1) % 3]
            along = is_line & (weights[:, ends, opposite] == 0.0).all(axis=1)
            found.append(np.sort(pieces[along][:, ends], axis=1))
    return np.unique(np.concatenate(found), axis=0)


def _keys(edges: Ints, size: int) -> Any:
    """A number (k,) for each edge (k, 2) between `size` vertices, whichever end is first."""
    ends = np.sort(edges, axis=1).astype(np.int64)
    return ends[:, 0] * size + ends[:, 1]


def with_sources(ground: Ground, old: OldMesh, made: Any, max_distance: float) -> NewMesh:
    """What the package's remesh() of a ground has made, and its places on the old mesh."""
    faces, vertices = np.array(made.faces), np.array(made.vertices)
    middles = vertices[faces].mean(axis=1)
    surface = ground.old
    face_source = package().project(surface, middles).faces
    source, weights = ground.on_old(np.array(made.source_faces), np.array(made.barycentric))
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
        ground=ground,
        made=made,
        max_distance=max_distance,
        left_out=len(old.vertices) - len(np.unique(old.faces)),
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
