# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that break mesh code, as strategies of hypothesis."""

from collections.abc import Callable

import numpy as np
import shapes
from hypothesis import strategies as st
from shapes import Mesh

Build = Callable[[np.random.Generator, int], Mesh]


def soup(random: np.random.Generator, size: int) -> Mesh:
    """Triangles anywhere, through each other."""
    return random.uniform(-1, 1, (3 * size, 3)), np.arange(3 * size).reshape(-1, 3)


def crumpled(random: np.random.Generator, size: int) -> Mesh:
    """A sheet folded at random."""
    vertices, faces = shapes.grid(1 + size)
    return vertices + random.normal(0, 0.2, vertices.shape), faces


def hat(random: np.random.Generator, size: int) -> Mesh:
    """A fan around one pointed vertex: slender faces."""
    around = 2 * np.pi * np.arange(size + 2) / (size + 2)
    rim = np.column_stack([np.cos(around), np.sin(around), 0 * around])
    a = np.arange(size + 2)
    fan = np.column_stack([a, (a + 1) % (size + 2), np.full_like(a, size + 2)])
    return np.vstack([rim, [[0, 0, random.uniform(0, 8)]]]), fan


def needles(random: np.random.Generator, size: int) -> Mesh:
    """Faces a million times as long as wide."""
    vertices, faces = shapes.grid(1 + size)
    return vertices * [1e6, 1, 1], faces


def collapsed(random: np.random.Generator, size: int) -> Mesh:
    """Some faces have no area: two equal corners, or three in a line."""
    vertices, faces = shapes.grid(2 + size)
    faces = faces.copy()
    chosen = random.choice(len(faces), len(faces) // 4, replace=False)
    faces[chosen, 1] = faces[chosen, 0]
    vertices[random.integers(len(vertices), size=3)] = vertices[0]
    return vertices, faces


def repeated(random: np.random.Generator, size: int) -> Mesh:
    """Some faces twice, and some of these turned over."""
    vertices, faces = shapes.grid(1 + size)
    again = faces[random.integers(len(faces), size=1 + size)]
    return vertices, np.vstack([faces, again[:, :: random.choice([1, -1])]])


def flipped(random: np.random.Generator, size: int) -> Mesh:
    """Neighbors that are not turned alike."""
    vertices, faces = shapes.torus(4 + size, 4)
    faces = faces.copy()
    chosen = random.random(len(faces)) < 0.5
    faces[chosen] = faces[chosen, ::-1]
    return vertices, faces


def fin(random: np.random.Generator, size: int) -> Mesh:
    """Several sheets along one edge."""
    tips = random.uniform(-1, 1, (2 + size, 3)) * [0, 1, 1] + [0.5, 0, 0]
    sheets = [[0, 1, 2 + k] for k in range(2 + size)]
    return np.vstack([[[0, 0, 0], [1, 0, 0]], tips]), np.array(sheets)


def bow_tie(random: np.random.Generator, size: int) -> Mesh:
    """Sheets that share one vertex only."""
    corners = random.uniform(-1, 1, (2 * (1 + size), 3))
    pairs = 1 + np.arange(2 * (1 + size)).reshape(-1, 2)
    return np.vstack([np.zeros((1, 3)), corners]), np.column_stack(
        [np.zeros(len(pairs), int), pairs]
    )


def sheets(random: np.random.Generator, size: int) -> Mesh:
    """Two sheets, nearer to each other than any samples; or one twice."""
    vertices, faces = shapes.grid(1 + size)
    above = vertices + np.array([0, 0, random.choice([0.0, 1e-9, 1e-3])])
    return np.vstack([vertices, above]), np.vstack([faces, faces + len(vertices)])


def islands(random: np.random.Generator, size: int) -> Mesh:
    """Many components of different sizes, and vertices of no face."""
    parts = [np.eye(3) * 10 ** random.uniform(-3, 0) + 2 * k for k in range(1 + 4 * size)]
    faces = np.arange(3 * len(parts)).reshape(-1, 3)
    return np.vstack([*parts, random.uniform(-9, 9, (3, 3))]), faces


def split(random: np.random.Generator, size: int) -> Mesh:
    """Each face has vertices of its own, as in an STL file."""
    vertices, faces = shapes.torus(4 + size, 4)
    return vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)


def cube(random: np.random.Generator, size: int) -> Mesh:
    """Faces much larger than cells, whose corners are symmetric: ties."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, np.array([q[:3] for q in quads] + [[q[0], q[2], q[3]] for q in quads])


FAMILIES: tuple[Build, ...] = (
    *(soup, crumpled, hat, needles, collapsed, repeated, flipped, fin, bow_tie, sheets, islands),
    *(split, cube),
)


def turned(random: np.random.Generator) -> np.ndarray:
    """A rotation."""
    q, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


@st.composite
def meshes(draw: st.DrawFn) -> Mesh:
    """One of a family, somewhere, of any size."""
    build = draw(st.sampled_from(FAMILIES), label="family")
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1), label="seed"))
    vertices, faces = build(random, draw(st.integers(1, 6), label="size"))
    extent = 10.0 ** draw(st.integers(-6, 6), label="extent")
    away = draw(st.sampled_from([0.0, 1.0, 1e3, 1e6]), label="away")
    return extent * (vertices + away), faces.astype(np.int32)


@st.composite
def densities(draw: st.DrawFn, mesh: Mesh) -> tuple[np.ndarray | None, str]:
    """None, or one at vertices, faces or corners; it may be 0 nearly everywhere."""
    where = draw(st.sampled_from(["none", "vertices", "faces", "corners"]), label="density at")
    if where == "none":
        return None, "vertices"
    vertices, faces = mesh
    shape = {"vertices": len(vertices), "faces": len(faces), "corners": (len(faces), 3)}[where]
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1), label="seed of the density"))
    values = random.uniform(0, 1, shape) ** draw(st.sampled_from([1, 8]), label="contrast")
    values[random.random(shape) < draw(st.sampled_from([0.0, 0.5, 0.9]), label="share of 0")] = 0
    return values * 10.0 ** draw(st.integers(-8, 8), label="unit"), where
