# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed triangle meshes of implicit surfaces f(x) = 0, with f < 0 inside."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Faces = NDArray[np.int32]
Field = Callable[[Array], Array]
"""Values (m,) at points (m, 3); about a distance near the surface."""

RELAXATIONS = 12


def capsule(points: Array, start: Array, end: Array, radii: tuple[float, float]) -> Array:
    """Distance of points (m, 3) from a capsule whose radius is linear along its axis."""
    axis = end - start
    along = np.clip((points - start) @ axis / (axis @ axis), 0, 1)
    nearest = start + along[:, None] * axis
    return np.linalg.norm(points - nearest, axis=1) - (radii[0] + along * (radii[1] - radii[0]))


def rounded_box(points: Array, half: Array, radius: float) -> Array:
    """Distance of points (m, 3) from a box about the origin with rounded edges."""
    outside = np.abs(points) - (half - radius)
    inner = np.minimum(outside.max(axis=1), 0)
    return np.linalg.norm(np.maximum(outside, 0), axis=1) + inner - radius


def blend(distances: Array, width: float) -> Array:
    """Smooth union (m,) of fields (k, m): the exponential minimum, without overflow."""
    least = distances.min(axis=0)
    return least - width * np.log(np.exp((least - distances) / width).sum(axis=0))


def mesh(field: Field, low: Array, high: Array, faces: int) -> tuple[Array, Faces]:
    """Vertices (v, 3) and about so many faces (m, 3) of the surface within the box low..high.

    ValueError where so few do not tell the parts of the surface apart.
    """
    vertices, quads = _surface_nets(field, low, high, step_for(field, low, high, faces))
    if not _closed(quads):
        raise ValueError(f"{faces} faces: too few for this surface, some edge joins more than two")
    vertices = _relaxed(field, vertices, quads)
    return vertices, _triangles(vertices, quads)


def step_for(field: Field, low: Array, high: Array, faces: int) -> float:
    """The lattice's step that makes about so many faces of the surface."""
    step = float(np.linalg.norm(high - low)) / 50
    found = len(_surface_nets(field, low, high, step)[1])
    return step * float((2 * found / faces) ** 0.5)


def mesh_by_step(field: Field, low: Array, high: Array, step: float) -> tuple[Array, Faces]:
    """Vertices (v, 3) and faces (m, 3), over a lattice of this step that begins at `low`."""
    vertices, quads = _surface_nets(field, low, high, step)
    vertices = _relaxed(field, vertices, quads)
    return vertices, _triangles(vertices, quads)


def _surface_nets(field: Field, low: Array, high: Array, step: float) -> tuple[Array, Faces]:
    """Vertices (v, 3) and quads (q, 4), one vertex in each grid cell that the surface passes.

    S. F. Gibson, Constrained elastic surface nets, MICCAI 1998.
    """
    counts = np.ceil((high - low) / step).astype(int) + 1
    grid = np.stack(np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"), axis=-1)
    values = field((low + step * grid).reshape(-1, 3)).reshape(counts)
    total = np.zeros((*(counts - 1), 3))
    crossings = np.zeros(counts - 1)
    for axis in range(3):
        _add_crossings(values, axis, total, crossings)
    active = crossings > 0
    index = np.full(active.shape, -1)
    index[active] = np.arange(np.count_nonzero(active))
    inside = total[active] / crossings[active, None]
    vertices = low + step * (np.argwhere(active) + inside)
    return vertices, np.vstack([_quads(values, axis, index) for axis in range(3)]).astype(np.int32)


def _add_crossings(values: Array, axis: int, total: Array, crossings: Array) -> None:
    """Add the crossings on the four edges of each cell along the axis, relative to the cell."""
    near, far = (np.moveaxis(values, axis, 0)[part] for part in (slice(-1), slice(1, None)))
    crossed = (near < 0) != (far < 0)
    where = np.where(crossed, near / np.where(crossed, near - far, 1), 0)
    sums, hits = np.moveaxis(total, axis, 0), np.moveaxis(crossings, axis, 0)
    others = [k for k in range(3) if k != axis]
    for a in (0, 1):
        for b in (0, 1):
            rows = slice(a, a + hits.shape[1]), slice(b, b + hits.shape[2])
            hit = crossed[:, rows[0], rows[1]]
            hits += hit
            sums[..., axis] += where[:, rows[0], rows[1]]
            sums[..., others[0]] += a * hit
            sums[..., others[1]] += b * hit


def _quads(values: Array, axis: int, index: NDArray[np.int64]) -> NDArray[np.int64]:
    """The quads (q, 4) across the grid edges along the axis, turned outward."""
    order = [axis, (axis + 1) % 3, (axis + 2) % 3]
    inside = np.transpose(values, order) < 0
    cells = np.transpose(index, order)
    enters = inside[:-1] != inside[1:]
    i, j, k = np.argwhere(enters[:, 1:-1, 1:-1]).T
    corners = np.stack(
        [cells[i, j + b, k + c] for b, c in ((0, 0), (1, 0), (1, 1), (0, 1))], axis=1
    )
    leaves = inside[i, j + 1, k + 1]
    return np.where(leaves[:, None], corners, corners[:, ::-1])


def _closed(quads: Faces) -> bool:
    """Whether every edge lies between exactly two quads."""
    edges = np.sort(np.vstack([quads[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1)
    return bool((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())


def _relaxed(field: Field, vertices: Array, quads: Faces) -> Array:
    """Even out the vertices: toward their neighbors' mean, then back onto the surface."""
    edges = np.vstack([quads[:, [k, (k + 1) % 4]] for k in range(4)])
    degree = np.bincount(edges[:, 0], minlength=len(vertices))[:, None]
    for _ in range(RELAXATIONS):
        mean = np.zeros_like(vertices)
        np.add.at(mean, edges[:, 0], vertices[edges[:, 1]])
        vertices = _on_surface(field, 0.5 * (vertices + mean / degree))
    return vertices


def _on_surface(field: Field, points: Array) -> Array:
    """One Newton step of points (m, 3) along the gradient toward field = 0."""
    small = 1e-5
    gradient = np.stack(
        [(field(points + e) - field(points - e)) / (2 * small) for e in small * np.eye(3)], axis=1
    )
    squared = np.maximum((gradient**2).sum(axis=1), 0.1)
    return points - (field(points) / squared)[:, None] * gradient


def _triangles(vertices: Array, quads: Faces) -> Faces:
    """Each quad split along its shorter diagonal."""
    a, b, c, d = quads.T
    first = np.linalg.norm(vertices[a] - vertices[c], axis=1)
    short = (first <= np.linalg.norm(vertices[b] - vertices[d], axis=1))[:, None]
    one = np.where(short, np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    other = np.where(short, np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    return np.vstack([one, other]).astype(np.int32)
