# SPDX-License-Identifier: GPL-3.0-or-later
"""What an evaluation costs where faces are large, sheets overlap or sites crowd, against a sphere.

The ratio is of processor times in one run, as many samples on both sides, one thread. A whole
sampling is divided by its evaluations, so that what is prepared once counts once.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

from benchmarks.compare.tables import say, table

Mesh = tuple[NDArray[np.float64], NDArray[np.int32]]
_ROUNDS = 3
_EVALUATIONS = 12
_GOAL = 1.5


def main() -> None:
    options = _options()
    bodies: dict[str, Callable[[], Mesh]] = {"room": room, "overlapping sheets": sheets}
    rows = []
    for count in options.counts:
        base = per_evaluation(sphere(), count)
        for name, make in bodies.items():
            say(f"{name}, {count} samples")
            taken = per_evaluation(make(), count)
            ratio = taken / base
            judged = "met" if ratio <= _GOAL else f"over {_GOAL}"
            rows.append(
                [
                    name,
                    str(count),
                    f"{1e3 * base:.1f}",
                    f"{1e3 * taken:.1f}",
                    f"{ratio:.2f}",
                    judged,
                ]
            )
    head = ("body", "samples", "sphere, ms", "this, ms", "ratio", "goal")
    print(table(head, rows))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/zoo/run.sh --cost", description=__doc__)
    parser.add_argument("--counts", type=int, nargs="+", default=[1000, 10_000, 100_000])
    return parser.parse_args()


def per_evaluation(mesh: Mesh, count: int) -> float:
    """Median processor seconds of a sampling, divided by its evaluations."""
    surface, taken = dapple.Surface(*mesh), []
    for seed in range(_ROUNDS):
        start = time.process_time()
        report = dapple.sample(
            surface, count, seed=seed, threads=1, max_evaluations=_EVALUATIONS
        ).report
        taken.append((time.process_time() - start) / report.evaluations)
    return float(np.median(taken))


def room() -> Mesh:
    """A cube of twelve faces with three walls through its middle."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    vertices, quads = [corners], list(sides)
    for axis in range(3):
        wall = np.full((4, 3), 0.5)
        wall[:, (axis + 1) % 3], wall[:, (axis + 2) % 3] = (0, 1, 1, 0), (0, 0, 1, 1)
        first = 4 * axis + 8
        quads.append((first, first + 1, first + 2, first + 3))
        vertices.append(wall)
    return np.vstack(vertices), _cut(np.array(quads))


def sphere(side: int = 32) -> Mesh:
    """A cube's grids, blown up: 12 side^2 faces."""
    angle = np.tan((2 * np.arange(side + 1) / side - 1) * np.pi / 4)
    u, v = (a.ravel() for a in np.meshgrid(angle, angle, indexing="ij"))
    points: list[NDArray[np.float64]] = []
    quads: list[NDArray[np.int64]] = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            face = np.empty((len(u), 3))
            face[:, axis], face[:, (axis + 1) % 3], face[:, (axis + 2) % 3] = sign, u, sign * v
            quads.append(_grid_quads(side) + len(u) * len(points))
            points.append(face / np.linalg.norm(face, axis=1)[:, None])
    return np.vstack(points), _cut(np.vstack(quads))  # the seams lie at the same places


def sheets(count: int = 30, side: int = 8) -> Mesh:
    """Squares that lie over each other in one plane, turned at random."""
    random = np.random.default_rng(0)
    line = np.linspace(-0.5, 0.5, side + 1)
    square = np.stack(np.meshgrid(line, line, indexing="ij"), -1).reshape(-1, 2)
    vertices, quads = [], []
    for k in range(count):
        cos, sin = np.cos(angle := random.uniform(0, 2 * np.pi)), np.sin(angle)
        turned = square @ np.array([[cos, -sin], [sin, cos]]).T + random.uniform(-0.2, 0.2, 2)
        vertices.append(np.column_stack([turned, np.zeros(len(square))]))
        quads.append(_grid_quads(side) + k * len(square))
    return np.vstack(vertices), _cut(np.vstack(quads))


def _grid_quads(side: int) -> NDArray[np.int64]:
    row, column = (a.ravel() for a in np.indices((side, side)))
    first = row * (side + 1) + column
    return np.column_stack([first, first + side + 1, first + side + 2, first + 1])


def _cut(quads: NDArray[np.int64]) -> NDArray[np.int32]:
    return np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)


if __name__ == "__main__":
    main()
