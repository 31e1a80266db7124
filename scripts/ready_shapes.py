# SPDX-License-Identifier: GPL-3.0-or-later
"""Small things made of numbers alone, for the scatters that ship as assets; radius about 1.

What these functions make is CC0, as the manifest says: nothing of it comes from elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Profile = Sequence[tuple[float, float]]  # (radius, height), from below


@dataclass
class Shape:
    """Vertices, and faces with the index of their material."""

    vertices: list[tuple[float, float, float]] = field(default_factory=list)
    faces: list[tuple[int, ...]] = field(default_factory=list)
    materials: list[int] = field(default_factory=list)

    def add(self, vertices: Array, faces: Iterable[Sequence[int]], material: int = 0) -> None:
        """One more piece, of one material."""
        first = len(self.vertices)
        self.vertices += [(float(x), float(y), float(z)) for x, y, z in vertices]
        for face in faces:
            self.faces.append(tuple(first + int(k) for k in face))
            self.materials.append(material)


def lathe(profile: Profile, sides: int, star: float = 1.0) -> tuple[Array, list[tuple[int, ...]]]:
    """A profile turned about z, with closed ends; every other side has a part of the radius."""
    turns = 2.0 * math.pi * np.arange(sides) / sides
    reach = np.where(np.arange(sides) % 2 == 0, 1.0, star)
    rings = [
        np.column_stack([r * reach * np.cos(turns), r * reach * np.sin(turns), np.full(sides, z)])
        for r, z in profile
    ]
    faces: list[tuple[int, ...]] = [
        (
            ring * sides + side,
            ring * sides + (side + 1) % sides,
            (ring + 1) * sides + (side + 1) % sides,
            (ring + 1) * sides + side,
        )
        for ring in range(len(profile) - 1)
        for side in range(sides)
    ]
    last = (len(profile) - 1) * sides
    faces += [tuple(reversed(range(sides))), tuple(range(last, last + sides))]
    return np.vstack(rings), faces


def blade(
    turn: float, height: float, lean: float, width: float, parts: int = 5
) -> tuple[Array, list[tuple[int, ...]]]:
    """A leaf of grass that bends outward, and ends in a tip."""
    t = np.linspace(0.0, 1.0, parts + 1)[:-1]
    out, up = lean * t**1.8, height * (t - 0.22 * lean * t**2.5)
    half = 0.5 * width * np.sqrt(1.0 - t) * (0.75 + 0.5 * np.sin(math.pi * t))
    fold = -0.35 * half  # the middle lies deeper than the edges
    left = np.column_stack([out, half, up])
    middle = np.column_stack([out - fold, 0.0 * t, up])
    right = np.column_stack([out, -half, up])
    tip = np.array([[lean, 0.0, height * (1.0 - 0.22 * lean)]])
    rows = parts
    faces: list[tuple[int, ...]] = []
    for k in range(rows - 1):
        for low in (0, rows):
            faces.append((low + k, low + rows + k, low + rows + k + 1, low + k + 1))
    for low in (0, rows):
        faces.append((low + rows - 1, low + 2 * rows - 1, 3 * rows))
    return turned(np.vstack([left, middle, right, tip]), turn), faces


def turned(vertices: Array, turn: float) -> Array:
    """The same about z."""
    c, s = math.cos(turn), math.sin(turn)
    return vertices @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def moved(vertices: Array, x: float, y: float, z: float) -> Array:
    """The same elsewhere."""
    return vertices + np.array([x, y, z])


def tuft(seed: int, blades: int, height: float) -> Shape:
    """Leaves of grass from one root."""
    random, made = np.random.default_rng(seed), Shape()
    for k in range(blades):
        turn = 2.0 * math.pi * (k + 0.7 * random.random()) / blades * 1.618
        lean, tall = 0.15 + 0.8 * random.random(), height * (0.6 + 0.5 * random.random())
        vertices, faces = blade(turn, tall, lean, 0.16 + 0.06 * random.random())
        root = 0.16 * random.random()
        made.add(moved(vertices, root * math.cos(turn), root * math.sin(turn), -0.05), faces)
    return made


def flower(seed: int, stems: int) -> Shape:
    """Flowers among some leaves; materials: leaf, petal, middle."""
    random, made = np.random.default_rng(seed), tuft(seed, 7, 0.9)
    for k in range(stems):
        turn = 2.0 * math.pi * (k + 0.5 * random.random()) / stems
        lean, tall = 0.25 + 0.25 * random.random(), 1.3 + 0.5 * random.random()
        made.add(*blade(turn, tall, lean, 0.07))
        place = np.array([lean * math.cos(turn), lean * math.sin(turn), tall * (1 - 0.22 * lean)])
        for petal in range(7):
            made.add(_petal(2.0 * math.pi * petal / 7.0) + place, [(0, 1, 2, 3), (0, 3, 4, 5)], 1)
        vertices, faces = lathe([(0.09, 0.0), (0.1, 0.04), (0.05, 0.09)], 8)
        made.add(vertices + place, faces, 2)
    return made


def _petal(turn: float) -> Array:
    outline = [(0.05, 0, 0.02), (0.2, -0.07, 0.06), (0.32, -0.05, 0.05)]
    outline += [(0.35, 0, 0.04), (0.32, 0.05, 0.05), (0.2, 0.07, 0.06)]
    return turned(np.array(outline), turn)


def pebble(seed: int, flat: float) -> Shape:
    """A smooth stone, sunk a little."""
    random, made = np.random.default_rng(seed), Shape()
    angles = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 11)[1:-1]
    vertices, faces = lathe([(math.cos(a), math.sin(a)) for a in angles], 18)
    bumps = np.zeros(len(vertices))
    for _ in range(6):
        along, phase = random.normal(size=3), 6.3 * random.random()
        bumps += 0.09 * np.sin(1.3 * vertices @ along + phase)
    stone = vertices * (1.0 + bumps)[:, None] * [1.0, 0.62 + 0.25 * random.random(), flat]
    stone /= np.linalg.norm(stone[:, :2], axis=1).max()
    made.add(moved(stone, 0.0, 0.0, 0.45 * flat), faces)
    return made


def plate() -> Shape:
    """A scale with its tip at +x, which rises over the next one; made of one material."""
    made, across = Shape(), 9
    v = np.linspace(-1.0, 1.0, across)
    rows = []
    for u in np.linspace(-0.9, 1.0, 10):
        half = 0.82 * max(1.0 - max(u, 0.0) ** 2.2, 0.0) ** 0.6 * (1.0 - 0.35 * min(u, 0.0) ** 2)
        dome = 0.30 * (1.0 - v**2) * (1.0 - 0.5 * u * u) + 0.05 * np.exp(-((v / 0.16) ** 2))
        rim = 0.10 * (u + 0.9)  # higher toward the tip
        rows.append(np.column_stack([np.full(across, u), half * v, dome + rim]))
    vertices = np.vstack(rows)
    top = _strip(10, across)
    made.add(vertices, top)
    made.add(vertices * [1.0, 1.0, 0.9] - [0.0, 0.0, 0.07], [face[::-1] for face in top])
    count = len(vertices)
    rims = [(b, a, count + a, count + b) for edge in _edges(10, across) for a, b in pairwise(edge)]
    made.faces += rims
    made.materials += [0] * len(rims)
    return made


def _strip(rows: int, across: int) -> list[tuple[int, ...]]:
    return [
        (r * across + k, (r + 1) * across + k, (r + 1) * across + k + 1, r * across + k + 1)
        for r in range(rows - 1)
        for k in range(across - 1)
    ]


def _edges(rows: int, across: int) -> list[list[int]]:
    """The sides of a strip, and its end."""
    side = [r * across for r in range(rows)]
    return [side[::-1], [k + across - 1 for k in side], list(range(across))]


def stud() -> Shape:
    """A dome on a washer; materials: dome, washer."""
    made = Shape()
    made.add(*lathe([(1.0, -0.12), (1.0, 0.06), (0.94, 0.12), (0.7, 0.13)], 24), 1)
    angles = np.linspace(0.0, 0.5 * math.pi, 7)[:-1]
    profile = [(0.68, 0.08), *((0.68 * math.cos(a), 0.14 + 0.5 * math.sin(a)) for a in angles)]
    made.add(*lathe([*profile, (0.06, 0.64)], 24))
    return made


def conifer(seed: int, height: float, whorls: int) -> Shape:
    """Whorls of branches on a trunk; materials: needles, bark."""
    random, made = np.random.default_rng(seed), Shape()
    made.add(*lathe([(0.13, -0.15), (0.1, 0.25 * height), (0.05, 0.8 * height)], 8), 1)
    for k in range(whorls):
        t = k / whorls
        low, high = height * (0.12 + 0.80 * t), height * (0.12 + 0.80 * t + 1.35 / whorls)
        reach = (1.0 - t) ** 0.8 * (0.93 + 0.07 * random.random()) + 0.1
        profile = [
            (0.35 * reach, low + 0.10),
            (reach, low - 0.10),
            (0.72 * reach, low + 0.12),
            (0.34 * reach, low + 0.42 * (high - low)),
            (0.03, high),
        ]
        vertices, faces = lathe(profile, 16, 0.74)
        made.add(turned(vertices, 6.3 * random.random()), faces)
    return made


def mushroom(seed: int, caps: Sequence[tuple[float, float, float, float]], dots: int) -> Shape:
    """Mushrooms at (x, y) of a size and height; materials: cap, stem, dots."""
    random, made = np.random.default_rng(seed), Shape()
    for x, y, size, tall in caps:
        place = [x, y, 0.0]
        stem = [(0.26, -0.1), (0.22, 0.15), (0.16, 0.6 * tall), (0.15, tall)]
        vertices, faces = lathe([(size * r, z) for r, z in stem], 12)
        made.add(vertices + place, faces, 1)
        under = [(0.14, 0.02), (0.62, -0.04), (0.9, -0.12), (0.94, -0.06)]
        over = [(math.cos(a), 0.62 * math.sin(a)) for a in np.linspace(0.05, 1.5, 8)]
        cap = [(size * 0.92 * r, tall + size * z) for r, z in [*under, *over]]
        vertices, faces = lathe(cap, 20)
        made.add(vertices + place, faces)
        for k in range(dots):
            turn, down = 2.4 * k + random.random(), 0.15 + 0.95 * math.sqrt(k / max(dots, 1))
            made.add(_dot(size, tall, turn, 0.5 * math.pi - down, random.random()) + place, _DOT, 2)
    return made


_DOT = [tuple(range(7)), *((k, 7, (k + 1) % 7) for k in range(7))]


def _dot(size: float, tall: float, turn: float, angle: float, chance: float) -> Array:
    """A wart on a cap: a ring around the place, and its middle above."""
    wide = size * (0.08 + 0.06 * chance)
    rings = 2.0 * math.pi * np.arange(7) / 7.0
    flat = np.column_stack([wide * np.cos(rings), wide * np.sin(rings), 0.0 * rings])
    bump = np.vstack([flat, [(0.0, 0.0, 0.45 * wide)]])
    lean = math.atan2(math.cos(angle), math.sin(angle) / 0.62)
    c, s = math.cos(lean), math.sin(lean)
    tilted = bump @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    place = size * 0.925 * np.array([math.cos(angle), 0.0, 0.62 * math.sin(angle)])
    return moved(turned(tilted + place, turn), 0.0, 0.0, tall)
