# SPDX-License-Identifier: GPL-3.0-or-later
"""The least flow that undoes what a deformation does to areas: how smooth a slide can be at all.

Samples that stay evenly spaced slide into what grows and out of what shrinks. Of all flows that
keep the density, the one without turns is the least (Helmholtz): the gradient of phi, where the
Laplacian of phi is how much faster a place grows than the whole surface. No neighbors and no cells
take part in it, so what a tracker's samples slide more, or less smoothly, is its own.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.sparse import csr_matrix, identity  # type: ignore[import-untyped]
from scipy.sparse.linalg import spsolve  # type: ignore[import-untyped]

from benchmarks.tracking.animations import Animation
from benchmarks.tracking.implicit import Array, Faces

ANCHOR = 1e-9  # of the Laplacian's diagonal: phi is determined but for a constant


def least_flow(animation: Animation, count: int) -> tuple[float, float]:
    """Mean slide and mean jerk over a period, in spacings of so many samples."""
    order = [0, *animation.order(animation.period)]
    slides = [
        _slide(animation.frames[before], animation.frames[now], animation.faces, count)
        for before, now in itertools.pairwise(order)
    ]
    weights = _areas(animation.frames[0], animation.faces)
    return _mean(slides, weights), _mean(np.diff(slides, axis=0), weights)


def _slide(before: Array, now: Array, faces: Faces, count: int) -> Array:
    """In spacings, along two axes of each face that the surface carries: (m, 2)."""
    growth = _growth(before, now, faces)
    areas = _areas(now, faces)
    hats = _hat_gradients(now, faces)
    flow = np.einsum("mkd,mk->md", hats, _potential(hats, areas, faces, growth)[faces])
    spacing = np.sqrt(2 / np.sqrt(3) * areas.sum() / count)
    return np.asarray(np.einsum("mad,md->ma", _axes(now, faces), flow) / spacing)


def _growth(before: Array, now: Array, faces: Faces) -> Array:
    """Of each face's share of the area, as a logarithm."""
    then, today = _areas(before, faces), _areas(now, faces)
    return np.asarray(np.log(today / today.sum()) - np.log(then / then.sum()))


def _potential(hats: Array, areas: Array, faces: Faces, growth: Array) -> Array:
    """Of each vertex; linear on faces (finite elements)."""
    size = int(faces.max()) + 1
    third = np.repeat(areas / 3, 3)
    load = np.bincount(faces.ravel(), third * np.repeat(growth, 3), size)
    load -= np.bincount(faces.ravel(), third, size) * load.sum() / areas.sum()
    stiffness = np.einsum("mid,mjd,m->mij", hats, hats, areas)
    rows, columns = np.repeat(faces, 3, axis=1), np.tile(faces, (1, 3))
    matrix = csr_matrix((stiffness.ravel(), (rows.ravel(), columns.ravel())), (size, size))
    anchored = matrix + ANCHOR * matrix.diagonal().mean() * identity(size)
    return np.asarray(spsolve(anchored.tocsc(), load))


def _crosses(vertices: Array, faces: Faces) -> Array:
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return np.cross(b - a, c - a)


def _areas(vertices: Array, faces: Faces) -> Array:
    return np.asarray(np.linalg.norm(_crosses(vertices, faces), axis=1) / 2)


def _hat_gradients(vertices: Array, faces: Faces) -> Array:
    """Of the functions that are 1 at one corner and 0 at the others: (m, 3, 3)."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    crosses = _crosses(vertices, faces)
    opposite = np.stack([c - b, a - c, b - a], axis=1)
    return np.asarray(np.cross(crosses[:, None], opposite) / (crosses**2).sum(1)[:, None, None])


def _axes(vertices: Array, faces: Faces) -> Array:
    first = vertices[faces[:, 1]] - vertices[faces[:, 0]]
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(_crosses(vertices, faces), first)
    second /= np.linalg.norm(second, axis=1)[:, None]
    return np.stack([first, second], axis=1)


def _mean(vectors: Array | list[Array], weights: Array) -> float:
    """Length, over faces by area and over frames."""
    return float(np.mean([np.average(np.linalg.norm(v, axis=1), weights=weights) for v in vectors]))
