# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes, motions and pictures whose bytes are the same on every machine.

Only + - * / and square roots, which IEEE 754 rounds in one way, make them: a sine or a sum of
another NumPy or C library may end in other bits.
"""

import math
from collections.abc import Iterable

import numpy as np
from shapes import Mesh

Point = tuple[float, float, float]


def as_mesh(vertices: Iterable[Point], faces: Iterable[tuple[int, ...]]) -> Mesh:
    return np.array(list(vertices), np.float64), np.array(list(faces), np.int32)


def turned(t: float) -> tuple[float, float]:
    """Cosine and sine of the angle whose half has the tangent t."""
    return (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)


def circle(quarter: int) -> list[tuple[float, float]]:
    """4 quarter points around the unit circle, nearly evenly."""
    first = [turned(k / quarter) for k in range(quarter)]
    second = [(-y, x) for x, y in first]
    return first + second + [(-x, -y) for x, y in first + second]


def numbers(count: int, seed: int) -> list[float]:
    """Evenly distributed in [0, 1): the MINSTD generator."""
    state, found = seed, []
    for _ in range(count):
        state = state * 48271 % 2147483647
        found.append((state >> 7) / 2**24)
    return found


def block(cells: tuple[int, int, int]) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """The faces of a box of so many unit cells, outward; its corners have whole coordinates."""
    index: dict[tuple[int, ...], int] = {}
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, cells[axis]):
            for i in range(cells[u]):
                for j in range(cells[v]):
                    ring = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        corner = [side] * 3
                        corner[u], corner[v] = i + di, j + dj
                        ring.append(index.setdefault(tuple(corner), len(index)))
                    a, b, c, d = ring if side else ring[::-1]
                    faces += [(a, b, c), (a, c, d)]
    return list(index), faces


def cube() -> Mesh:
    """Twelve faces, the sides 2."""
    vertices, faces = block((1, 1, 1))
    return as_mesh([(2.0 * x - 1, 2.0 * y - 1, 2.0 * z - 1) for x, y, z in vertices], faces)


def box(cells: int = 4) -> Mesh:
    """3 x 2 x 1, sharp edges, 22 cells^2 squares of two faces."""
    vertices, faces = block((3 * cells, 2 * cells, cells))
    return as_mesh([(x / cells, y / cells, z / cells) for x, y, z in vertices], faces)


def sphere(cells: int = 8) -> Mesh:
    """A cube blown up to radius 1."""
    vertices, faces = block((cells, cells, cells))

    def blown(*corner: int) -> Point:
        x, y, z = (2 * value / cells - 1 for value in corner)
        length = math.sqrt(x * x + y * y + z * z)
        return x / length, y / length, z / length

    return as_mesh([blown(*corner) for corner in vertices], faces)


def torus(waves: float = 0.0, around: int = 8, tube: int = 4) -> Mesh:
    """Radii 1 and 0.4; waves: how high eight waves around it are, of the tube."""
    ring, section = circle(around), circle(tube)
    vertices, faces = [], []
    for cosine, sine in ring:
        wave = cosine
        for _ in range(3):
            wave = 2 * wave * wave - 1  # double angle
        radius = 0.4 * (1 + waves * wave)
        for out, up in section:
            reach = 1 + radius * out
            vertices.append((reach * cosine, reach * sine, radius * up))
    rows, columns = len(ring), len(section)
    for i in range(rows):
        for j in range(columns):
            a, d = i * columns + j, i * columns + (j + 1) % columns
            b, c = (i + 1) % rows * columns + j, (i + 1) % rows * columns + (j + 1) % columns
            faces += [(a, b, c), (a, c, d)]
    return as_mesh(vertices, faces)


def wavy() -> Mesh:
    return torus(0.25, 16, 5)


def sheet(cells: int = 8) -> Mesh:
    """The unit square, with a saddle's height."""
    vertices = [
        (j / cells, i / cells, 0.5 * (i / cells - 0.5) * (j / cells - 0.5))
        for i in range(cells + 1)
        for j in range(cells + 1)
    ]
    faces = []
    for i in range(cells):
        for j in range(cells):
            a, d = i * (cells + 1) + j, (i + 1) * (cells + 1) + j
            faces += [(a, a + 1, d + 1), (a, d + 1, d)]
    return as_mesh(vertices, faces)


def split(mesh: Mesh) -> Mesh:
    """Each face with vertices of its own."""
    vertices, faces = mesh
    return vertices[faces].reshape(-1, 3), np.arange(3 * len(faces), dtype=np.int32).reshape(-1, 3)


def soup(count: int = 120) -> Mesh:
    """Triangles that cross each other anyhow."""
    values = iter(numbers(12 * count, 7))
    vertices = []
    for _ in range(count):
        middle = [next(values) for _ in range(3)]
        vertices += [tuple(at + 0.4 * (next(values) - 0.5) for at in middle) for _ in range(3)]
    return as_mesh(vertices, [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(count)])


def two_bodies() -> Mesh:
    """A torus and a small sphere in its hole."""
    (ring, ring_faces), (ball, ball_faces) = torus(), sphere(5)
    return np.vstack([ring, 0.3 * ball]), np.vstack([ring_faces, ball_faces + len(ring)]).astype(
        np.int32
    )


def twisted(vertices: np.ndarray, much: float) -> np.ndarray:
    """Turned about the x axis, the more the farther out, and swollen on one side."""
    x, y, z = (column.copy() for column in vertices.T)
    cosine, sine = turned(0.2 * much * x)
    swell = 1 + 0.1 * much * x * x
    return np.column_stack([x, swell * (cosine * y - sine * z), swell * (sine * y + cosine * z)])


def grown(vertices: np.ndarray, much: float) -> np.ndarray:
    """Longer along x where x > 0, and as it was elsewhere."""
    x = vertices[:, 0]
    return np.column_stack([x + np.where(x > 0, much * x, 0.0), vertices[:, 1:]])


def slope(mesh: Mesh) -> np.ndarray:
    """A density at the vertices: from about 1 to about 9 across the mesh."""
    x = mesh[0][:, 0]
    across = (x - x.min()) / (x.max() - x.min())
    return 1 + 8 * across * across


def spot(mesh: Mesh, inside: float) -> np.ndarray:
    """A density at the vertices: `inside` around the first one, 1 elsewhere."""
    away = mesh[0] - mesh[0][0]
    squares = away[:, 0] * away[:, 0] + away[:, 1] * away[:, 1] + away[:, 2] * away[:, 2]
    return np.where(squares < 0.25, inside, 1.0)


def picture(rows: int = 24, columns: int = 32) -> np.ndarray:
    """Hills in [0, 1], with a white and a black square."""
    row, column = np.indices((rows, columns)) / np.array([rows, columns]).reshape(2, 1, 1)
    image = 16 * row * (1 - row) * column * (1 - column)
    image[2:6, 2:6], image[-6:-2, -6:-2] = 1.0, 0.0
    return image


def colored() -> np.ndarray:
    image = picture()
    return np.stack([image, image[::-1], image[:, ::-1]], axis=2)


def flat_uv(mesh: Mesh) -> np.ndarray:
    """x and y of the sheet as texture coordinates."""
    return mesh[0][mesh[1]][:, :, :2].copy()
