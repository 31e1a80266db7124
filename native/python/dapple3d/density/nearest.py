# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances to meshes and segments, and the segments of a border.

Segments are given to the native search as triangles that are hardly wider than them.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .._native import Surface, project, reached_by_solids
from .arrays import Flags, Floats, Ints, longest_edges, shaped
from .normals import vertex_normals

_DEPTH = 1e-3  # how far a face may reach into a body, of the longest edge: less is contact
_THIN = 1e-9  # width of the triangle of a segment, relative to the size of all segments
Mesh = tuple[Floats, Ints]  # vertices (v, 3) and faces (m, 3)


class Body:
    """A mesh that may have an inside."""

    def __init__(self, vertices: Floats, faces: Ints) -> None:
        self._mesh = Surface(vertices, faces)
        self._normals = vertex_normals(vertices, faces)
        self.closed = bool(self._mesh.topology.closed)
        self._box = vertices[faces].min(axis=(0, 1)), vertices[faces].max(axis=(0, 1))

    def outside(self, points: Floats) -> Floats:
        """Distances (k,) from the mesh, less than 0 inside."""
        closest = project(self._mesh, points)
        distance: Floats = np.array(closest.distances)
        if self.closed:
            corners = self._normals[self._mesh.faces[closest.faces]]
            normals = np.einsum("nk,nkd->nd", closest.barycentric, corners)
            inside = np.einsum("nd,nd->n", points - closest.positions, normals) < 0.0
            distance[inside] *= -1.0
        return distance

    def beyond(self, points: Floats) -> Floats:
        """Distances (k,) from the box around the mesh, which are no larger than from the mesh."""
        low, high = self._box
        found: Floats = np.linalg.norm(np.maximum(low - points, points - high).clip(0.0), axis=1)
        return found

    def touches(self, points: Floats, faces: Ints, margin: float) -> Flags:
        """Which faces (m, 3) of vertices (v, 3) come nearer to the mesh than a margin, or cross it
        where it is closed. Corners that are inside do not count.
        """
        found = np.zeros(len(faces), dtype=bool)
        if not len(faces) or (margin == 0.0 and not self.closed):
            return found
        depth = _DEPTH * float(longest_edges(points, faces).max())
        within = max(margin - depth, 0.0)
        places = self._mesh.vertices - max(depth - margin, 0.0) * self._normals
        corners, own = places[self._mesh.faces], points[faces].reshape(-1, 3)
        low, high = own.min(axis=0) - within, own.max(axis=0) + within
        near = ((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)).all(axis=1)
        solids = corners[near].reshape(-1, 3), np.full(np.count_nonzero(near), 3)
        found[:] = reached_by_solids(points, faces, *solids, margin=within) != 0
        return found

    def clear(self, distances: Floats, points: Floats) -> None:
        """Set the distances to 0 of points that are inside."""
        if self.closed:
            low, high = self._box
            there = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
            distances[there[self.outside(points[there]) < 0.0]] = 0.0


class Lines:
    """Segments (k, 2, 3), of which some may be points."""

    def __init__(self, segments: Floats) -> None:
        self._segments, count = segments, len(segments)
        width = _THIN * max(float(np.abs(segments).max()), float(np.ptp(segments)), 1e-30)
        begin, end = segments[:, 0], segments[:, 1]
        across = np.argsort(np.abs(end - begin), axis=1, kind="stable")[:, :2]
        corners = np.stack([begin, end, end], axis=1)
        for corner in (1, 2):
            corners[np.arange(count), corner, across[:, corner - 1]] += width
        faces = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
        self._mesh = Surface(corners.reshape(-1, 3), faces, weld=None)

    def distances(self, points: Floats) -> Floats:
        """Distances (n,) of points (n, 3) to the nearest segment."""
        begin, end = self._segments[project(self._mesh, points).faces].transpose(1, 0, 2)
        ahead, there = end - begin, points - begin
        length = np.maximum((ahead * ahead).sum(axis=1), 1e-300)
        share = np.clip((there * ahead).sum(axis=1) / length, 0.0, 1.0)
        found: Floats = np.linalg.norm(there - share[:, None] * ahead, axis=1)
        return found


class Nearest:
    """The nearest of meshes and segments; inside closed meshes the distance is 0.

    Args:
        meshes: vertices (v, 3) and faces (m, 3) of each.
        segments: (s, 2, 3); one without length is a point.
        plan: whether all is seen from above: only horizontal distances count, and a mesh is its
            outline with what that encloses.

    Raises:
        ValueError: there are neither meshes nor segments, or as `dapple.Surface` for a mesh.
    """

    def __init__(
        self, meshes: Sequence[Mesh] = (), segments: ArrayLike | None = None, plan: bool = False
    ) -> None:
        segments = (
            np.empty((0, 2, 3)) if segments is None else shaped("segments", segments, -1, 2, 3)
        )
        if not len(meshes) and not len(segments):
            raise ValueError("there is neither a mesh nor a segment to measure a distance to")
        self._scale = np.array([1.0, 1.0, 0.0 if plan else 1.0])
        self._bodies = [] if plan else [Body(*mesh) for mesh in meshes]
        joined = _joined(meshes)
        if plan:
            joined, segments = _in_plan(joined, segments * self._scale)
        self._meshes = Surface(*joined, weld=None) if len(joined[1]) else None
        self._lines = Lines(segments) if len(segments) else None

    def distances(self, points: Floats) -> Floats:
        """Distances (n,) of points (n, 3)."""
        points = points * self._scale
        found = np.full(len(points), np.inf)
        if self._meshes is not None:
            found = np.minimum(found, project(self._meshes, points).distances)
        if self._lines is not None:
            found = np.minimum(found, self._lines.distances(points))
        for body in self._bodies:
            body.clear(found, points)
        return found


def _in_plan(mesh: Mesh, segments: Floats) -> tuple[Mesh, Floats]:
    """A mesh seen from above; faces that are seen from the side are lines."""
    vertices, faces = mesh[0] * [1.0, 1.0, 0.0], mesh[1]
    if not len(faces):
        return mesh, segments
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    size = float(np.ptp(vertices, axis=0).max())
    thin = np.abs(np.cross(b - a, c - a)[:, 2]) <= (_THIN * size) ** 2
    sides = [np.stack([one[thin], other[thin]], axis=1) for one, other in ((a, b), (b, c), (c, a))]
    return (vertices, faces[~thin]), np.concatenate([segments, *sides])


def _joined(meshes: Sequence[Mesh]) -> Mesh:
    if not meshes:
        return np.empty((0, 3)), np.empty((0, 3), dtype=np.int32)
    counts = [len(vertices) for vertices, _ in meshes]
    firsts = np.cumsum([0, *counts[:-1]]).astype(np.int32)
    faces = [faces + first for (_, faces), first in zip(meshes, firsts, strict=True)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(faces)


def border_edges(vertices: Floats, faces: Ints) -> Floats:
    """Edges (k, 2, 3) of vertices (v, 3) that only one face (m, 3) has.

    Edges at the same place are one edge, so that seams are no border.
    """
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    alone = edges[_once(edges)]
    used = np.unique(alone)
    if not len(used):
        return np.empty((0, 2, 3))
    _, place = np.unique(vertices[used] + 0.0, axis=0, return_inverse=True)
    ends = place.reshape(-1).astype(np.int32)[np.searchsorted(used, alone)]
    joined = np.sort(ends, axis=1)
    found: Floats = vertices[alone[_once(joined)]]
    return found


def _once(edges: Ints) -> Ints:
    """Indices of the edges (k, 2) that occur once."""
    keys = edges[:, 0].astype(np.int64) << 32 | edges[:, 1]
    _, first, counts = np.unique(keys, return_index=True, return_counts=True)
    found: Ints = first[counts == 1]
    return found
