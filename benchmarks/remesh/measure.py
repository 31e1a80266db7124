# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of a remesh, the same for every package."""

from typing import Any, NamedTuple

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
_STEPS = 4  # places along each side of a triangle at which distances are taken


class Figures(NamedTuple):
    """What the table shows."""

    vertices: int
    nonmanifold: int  # edges with more than two triangles
    euler: int
    smallest: float  # angle, degrees
    mean: float  # of the smallest angle of each triangle
    below_30: float  # share of triangles
    valence_6: float  # share of vertices inside
    distance: float  # largest, of either mesh to the other, in parts of the diagonal


def figures(vertices: Array, faces: Array, old: tuple[Array, Array]) -> Figures:
    """Measure a mesh beside the one that it is made from."""
    used = np.unique(faces)
    edges, uses = _edges(faces)
    angles = _smallest_angles(vertices[faces])
    diagonal = np.linalg.norm(np.ptp(old[0], axis=0))
    there, back = (farthest(a, b) for a, b in ((old, (vertices, faces)), ((vertices, faces), old)))
    return Figures(
        vertices=len(used),
        nonmanifold=int((uses > 2).sum()),
        euler=len(used) - len(edges) + len(faces),
        smallest=float(angles.min()),
        mean=float(angles.mean()),
        below_30=float((angles < 30).mean()),
        valence_6=_regular(edges, uses, len(vertices)),
        distance=float(max(there, back) / diagonal),
    )


def euler_of(faces: Array) -> int:
    """Vertices - edges + faces."""
    return len(np.unique(faces)) - len(_edges(faces)[0]) + len(faces)


def _edges(faces: Array) -> tuple[Array, Array]:
    sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    found: tuple[Array, Array] = np.unique(sides, axis=0, return_counts=True)
    return found


def _smallest_angles(corners: Array) -> Array:
    rolled = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    cross = np.linalg.norm(np.cross(rolled, back), axis=2)
    angles: Array = np.degrees(np.arctan2(cross, (rolled * back).sum(axis=2))).min(axis=1)
    return angles


def _regular(edges: Array, uses: Array, count: int) -> float:
    valence = np.bincount(edges.ravel(), minlength=count)
    border = np.zeros(count, bool)
    border[edges[uses == 1]] = True
    inside = (valence > 0) & ~border
    return float((valence[inside] == 6).mean())


def farthest(first: tuple[Array, Array], second: tuple[Array, Array]) -> float:
    """The largest distance of places all over the first mesh from the second."""
    corners = first[0][first[1]]
    shares = [
        (a / _STEPS, b / _STEPS, 1 - (a + b) / _STEPS)
        for a in range(_STEPS + 1)
        for b in range(_STEPS + 1 - a)
    ]
    points = np.concatenate([np.einsum("k,fkx->fx", np.array(row), corners) for row in shares])
    return float(dapple.project(dapple.Surface(*second), points).distances.max())
