# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples wires, ropes, ribbons and plates thinner than the spacing; prints a Markdown table.

Run through benchmarks/thin/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from statistics import median

import dapple3d as dapple
import numpy as np

from benchmarks.compare.tables import say, table

Mesh = tuple[np.ndarray, np.ndarray]
VARIATION, EVALUATIONS = 0.01, 40  # the goals


def tube(path: np.ndarray, radius: float, sides: int = 8, *, closed: bool = False) -> Mesh:
    """Along a path that nowhere turns back."""
    count = len(path)
    along = np.roll(path, -1, 0) - np.roll(path, 1, 0) if closed else np.gradient(path, axis=0)
    u = np.cross(along, (0.3, 0.5, 0.8))
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(along, u)
    v /= np.linalg.norm(v, axis=1)[:, None]
    turn = 2 * np.pi * np.arange(sides)[:, None] / sides
    rings = path[:, None] + radius * (np.cos(turn) * u[:, None] + np.sin(turn) * v[:, None])
    row, side = (k.ravel() for k in np.indices((count if closed else count - 1, sides)))
    a, b = row * sides + side, row * sides + (side + 1) % sides
    c, d = (b + sides) % (count * sides), (a + sides) % (count * sides)
    faces = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return rings.reshape(-1, 3), faces


def joined(parts: list[Mesh]) -> Mesh:
    sizes = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    faces = [faces + size for (_, faces), size in zip(parts, sizes, strict=False)]
    return np.vstack([vertices for vertices, _ in parts]), np.vstack(faces)


def fence(radius: float = 0.002, segments: int = 1) -> Mesh:
    x = np.linspace(0, 2, segments + 1)
    return joined(
        [tube(np.column_stack([x, 0 * x + y, 0 * x]), radius) for y in np.arange(20) / 10]
    )


def rope(radius: float) -> Mesh:
    turns = 6 * np.pi * np.linspace(0, 1, 301)
    return tube(np.column_stack([np.cos(turns), np.sin(turns), turns / 12]), radius)


def ring(radius: float) -> Mesh:
    turns = 2 * np.pi * np.arange(200) / 200
    path = np.column_stack([np.cos(turns), np.sin(turns), 0.3 * np.sin(2 * turns)])
    return tube(path, radius, closed=True)


def ribbon(width: float) -> Mesh:
    x = np.linspace(0, 4, 201)
    low = np.column_stack([x, 0.2 * np.sin(3 * x), 0 * x])
    a = np.arange(200)
    faces = [np.column_stack([a, a + 1, a + 202]), np.column_stack([a, a + 202, a + 201])]
    return np.vstack([low, low + np.array([0, 0, width])]), np.vstack(faces)


def box(size: tuple[float, float, float]) -> Mesh:
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)]) * size
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


BODIES: dict[str, tuple[Callable[[], Mesh], int]] = {
    "fence of 20 wires": (fence, 200),
    "fence, wires of 50 segments": (lambda: fence(segments=50), 200),
    "fence, spacing 1/38 of the gaps": (lambda: fence(2e-5, 20), 200),
    "rope": (lambda: rope(0.01), 100),
    "rope, thin": (lambda: rope(1e-4), 200),
    "rope, thick": (lambda: rope(0.03), 300),
    "rope, long": (lambda: rope(0.002), 1000),
    "ring": (lambda: ring(0.005), 100),
    "ribbon": (lambda: ribbon(0.01), 100),
    "ribbon, as wide as the spacing": (lambda: ribbon(0.04), 100),
    "bar of 12 faces": (lambda: box((4, 0.01, 0.002)), 50),
    "plank of 12 faces": (lambda: box((4, 0.06, 0.002)), 60),
    "plate of 12 faces": (lambda: box((1, 1, 0.002)), 500),
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="benchmarks/thin/run.sh", description=__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="how many, from 0 on")
    parser.add_argument("--only", choices=BODIES, help="one body")
    given = parser.parse_args()
    rows = [row(name, given.seeds) for name in BODIES if given.only in (None, name)]
    head = ("body", "points", "variation", "worst", "evaluations", "worst", "thin share", "goals")
    print(table(head, rows))
    print(f"\nOver {given.seeds} seeds. Goals: variation {VARIATION}, {EVALUATIONS} evaluations.")


def row(name: str, seeds: int) -> list[str]:
    say(name)
    make, count = BODIES[name]
    surface = dapple.Surface(*make())
    reports = [dapple.sample(surface, count, seed=seed).report for seed in range(seeds)]
    variations = [report.capacity_variation for report in reports]
    evaluations = [report.evaluations for report in reports]
    met = sum(
        report.capacity_variation <= VARIATION and report.evaluations <= EVALUATIONS
        for report in reports
    )
    return [
        *(name, str(count), f"{median(variations):.4f}", f"{max(variations):.4f}"),
        *(f"{median(evaluations):.0f}", str(max(evaluations))),
        f"{median(report.thin_share for report in reports):.2f}",
        "met" if met == seeds else f"met by {met} of {seeds}",
    ]


if __name__ == "__main__":
    main()
