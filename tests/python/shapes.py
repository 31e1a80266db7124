# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes for the tests, as (vertices, faces)."""

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


def grid(cells: int = 4) -> Mesh:
    """The unit square in the plane z = 0."""
    x, y = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, 1, cells + 1))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    row, column = (index.ravel() for index in np.indices((cells, cells)))
    a = row * (cells + 1) + column
    b, c, d = a + 1, a + cells + 2, a + cells + 1
    return vertices, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(
        "i4"
    )


def torus(around: int = 40, tube: int = 20) -> Mesh:
    """Radii 1 and 0.4."""
    row, column = (index.ravel() for index in np.indices((around, tube)))
    u, v = 2 * np.pi * row / around, 2 * np.pi * column / tube
    ring = 1 + 0.4 * np.cos(v)
    vertices = np.column_stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)])
    a = row * tube + column
    b = (row + 1) % around * tube + column
    c = (row + 1) % around * tube + (column + 1) % tube
    d = row * tube + (column + 1) % tube
    return vertices, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(
        "i4"
    )


def tube(path: np.ndarray, radius: float, sides: int = 8) -> Mesh:
    """Along a path that nowhere turns back, closed at both ends."""
    along = np.gradient(path, axis=0)
    u = np.cross(along, (0.3, 0.5, 0.8))
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(along, u)
    v /= np.linalg.norm(v, axis=1)[:, None]
    turn = 2 * np.pi * np.arange(sides) / sides
    rings = path[:, None] + radius * (
        np.cos(turn)[:, None] * u[:, None] + np.sin(turn)[:, None] * v[:, None]
    )
    row, side = (index.ravel() for index in np.indices((len(path) - 1, sides)))
    a, b = row * sides + side, row * sides + (side + 1) % sides
    caps = [[0, k + 1, k] for k in range(1, sides - 1)]
    caps += [[end := (len(path) - 1) * sides, end + k, end + k + 1] for k in range(1, sides - 1)]
    faces = [np.column_stack([a, b, b + sides]), np.column_stack([a, b + sides, a + sides]), caps]
    return rings.reshape(-1, 3), np.vstack(faces).astype("i4")


def bent(vertices: np.ndarray, time: float) -> np.ndarray:
    """Bend and swell, growing with time."""
    x, y, z = vertices.T
    angle = 0.3 * np.sin(time) * x
    swell = 1 + 0.1 * np.sin(time) * np.sin(2 * x)
    return np.column_stack(
        [
            x,
            swell * (np.cos(angle) * y - np.sin(angle) * z),
            swell * (np.sin(angle) * y + np.cos(angle) * z),
        ]
    )


def on_faces(
    vertices: np.ndarray, faces: np.ndarray, which: np.ndarray, weights: np.ndarray
) -> np.ndarray:
    """The points with these weights on these faces."""
    return np.einsum("nk,nkd->nd", weights, vertices[faces[which]])


def random_points(mesh: Mesh, count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Positions on random faces, and the faces."""
    random = np.random.default_rng(seed)
    which = random.integers(0, len(mesh[1]), count).astype("i4")
    return on_faces(*mesh, which, random.dirichlet([1, 1, 1], count)), which
