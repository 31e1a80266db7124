# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals at the vertices of a mesh."""

import numpy as np

from .arrays import Floats, Ints

_TINY = 1e-30


def vertex_normals(vertices: Floats, faces: Ints) -> Floats:
    """Unit normals (v, 3): the normals of the faces (m, 3), weighted by their corner angles.

    They do not depend on how planar polygons are cut into triangles.
    """
    corners = vertices[faces]
    normals = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    total = np.zeros_like(vertices)
    for k in range(3):
        ahead = _unit(corners[:, (k + 1) % 3] - corners[:, k])
        behind = _unit(corners[:, (k + 2) % 3] - corners[:, k])
        weight = np.arccos(np.clip(np.einsum("nd,nd->n", ahead, behind), -1.0, 1.0))
        for axis in range(3):
            total[:, axis] += np.bincount(
                faces[:, k], weight * normals[:, axis], minlength=len(vertices)
            )
    return _unit(total)


def _unit(vectors: Floats) -> Floats:
    lengths = np.sqrt(np.einsum("nd,nd->n", vectors, vectors))
    return vectors / np.maximum(lengths, _TINY)[:, None]
