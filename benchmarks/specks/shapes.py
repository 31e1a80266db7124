# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies, what lies around them, and what is wrong with scans of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mesh = tuple[Array, NDArray[np.int64]]

TETRAHEDRON: Mesh = (
    np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float),
    np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]),
)
OCTAHEDRON: Mesh = (
    np.vstack([np.eye(3), -np.eye(3)]),
    np.array(
        [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    ),
)


def sphere(level: int) -> Mesh:
    """Of radius 1, with 8 * 4**level faces of about the same size."""
    vertices, faces = OCTAHEDRON
    for _ in range(level):
        ends = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), 1)
        edges, number = np.unique(ends, axis=0, return_inverse=True)
        ab, bc, ca = (len(vertices) + part for part in np.split(number.ravel(), 3))
        middles = vertices[edges].mean(1)
        vertices = np.vstack([vertices, middles])
        a, b, c = faces.T
        corners = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = np.vstack([np.column_stack(face) for face in corners])
    return vertices / np.linalg.norm(vertices, axis=1)[:, None], faces


def moved(mesh: Mesh, size: float, place: Array) -> Mesh:
    return mesh[0] * size + place, mesh[1]


def joined(parts: list[Mesh]) -> Mesh:
    first = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    faces = [faces + start for (_, faces), start in zip(parts, first, strict=False)]
    return np.vstack([vertices for vertices, _ in parts]), np.vstack(faces)


def around(count: int, random: np.random.Generator) -> Array:
    """Places beside a sphere of radius 1."""
    ways = random.normal(size=(count, 3))
    return np.asarray(
        ways / np.linalg.norm(ways, axis=1)[:, None] * random.uniform(1.1, 2.0, (count, 1))
    )


def sheet(cells: int, thickness: float) -> Mesh:
    """A wavy square, with another one below it and a rim where it has a thickness."""
    line = np.linspace(0, 1, cells + 1)
    x, y = (k.ravel() for k in np.meshgrid(line, line, indexing="ij"))
    row, column = (k.ravel() for k in np.indices((cells, cells)))
    a = row * (cells + 1) + column
    b = a + cells + 1
    top = np.vstack([np.column_stack([a, b, b + 1]), np.column_stack([a, b + 1, a + 1])])
    vertices = np.column_stack([x, y, 0.1 * np.sin(5 * x) * np.cos(4 * y)])
    if thickness == 0:
        return vertices, top
    count = len(vertices)
    edges = np.vstack([top[:, [0, 1]], top[:, [1, 2]], top[:, [2, 0]]])
    _, first, times = np.unique(np.sort(edges, 1), axis=0, return_index=True, return_counts=True)
    p, q = edges[first[times == 1]].T
    rim = np.vstack(
        [np.column_stack([q, p, p + count]), np.column_stack([q, p + count, q + count])]
    )
    below = vertices - [0, 0, thickness]
    return np.vstack([vertices, below]), np.vstack([top, top[:, ::-1] + count, rim])


def circles(size: int, random: np.random.Generator) -> Array:
    """Line art: circles one pixel wide, 1 on 0."""
    image = np.zeros((size, size))
    rows, columns = np.indices(image.shape)
    for row, column, radius in random.uniform([0, 0, 20], [size, size, size / 3], (40, 3)):
        image[np.abs(np.hypot(rows - row, columns - column) - radius) < 0.5] = 1
    return image
