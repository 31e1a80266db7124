# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies whose faces change, remeshed frame after frame: a Markdown table.

Each frame goes on from the one before (MeshSequence), and is remeshed by itself for comparison.
"""

import time
from collections.abc import Callable
from itertools import islice

import dapple3d as dapple
import numpy as np

from benchmarks.tracking.changing import CHANGING, Changing
from benchmarks.tracking.implicit import Array, capsule, mesh_by_step, step_for

LENGTH = 24  # frames
FACES = 12_000
COUNT = 2_000
HEAD = (
    "| sequence | vertices | unmoved | new on a frame | smallest angle, mean of the triangles' | "
    "valence 6 | flaws | time, a remesh by itself = 1 |\n" + "|---" * 8 + "|"
)


def carved(length: int = LENGTH, faces: int = FACES) -> Changing:
    """A round bar into which a ball bites deeper on each frame; the rest does not change."""
    high = np.array([1.4, 0.6, 0.6])
    start, end = np.array([-0.9, 0.0, 0.0]), np.array([0.9, 0.0, 0.0])

    def field_of(frame: int) -> Callable[[Array], Array]:
        middle = np.array([0.4, 0.0, 1.1 - 0.4 * frame / length])

        def field(points: Array) -> Array:
            bar = capsule(points, start, end, (0.4, 0.4))
            return np.maximum(bar, 0.5 - np.linalg.norm(points - middle, axis=1))

        return field

    step = step_for(field_of(0), -high, high, faces)
    return Changing("carved", length, lambda k: mesh_by_step(field_of(k), -high, high, step))


def row(body: Changing) -> str:
    """A line of the table."""
    frames = [dapple.Surface(*mesh) for mesh in islice(body.frames(), LENGTH)]
    sequence = dapple.MeshSequence(frames[0], COUNT)
    capacity = frames[0].capacity / COUNT
    found, ratios = [], []
    for surface in frames[1:]:
        start = time.perf_counter()
        found.append(sequence.advance(surface))
        middle = time.perf_counter()
        dapple.remesh(surface, round(surface.capacity / capacity))
        ratios.append((middle - start) / (time.perf_counter() - middle))
    counts = [len(one.ids) for one in found if one]
    reports = [one.mesh.report for one in found if one]
    kept = [one.kept / len(one.ids) for one in found if one]
    born = [one.born / len(one.ids) for one in found if one]
    cells = [
        f"{body.name}, {LENGTH} frames",
        f"{min(counts):,} to {max(counts):,}",
        f"{100 * np.mean(kept):.0f} %",
        f"{100 * np.mean(born):.1f} %",
        f"{min(one.smallest_angle for one in reports):.1f}, "
        f"{np.mean([one.mean_smallest_angle for one in reports]):.1f}",
        f"{100 * np.mean([one.valence_6 for one in reports]):.0f} %",
        f"{sum(one.flaws for one in reports)}",
        f"{np.median(ratios):.2f}",
    ]
    return f"| {' | '.join(cells)} |"


def table() -> None:
    """Print a line for each sequence."""
    print(HEAD)
    for make in (carved, *CHANGING.values()):
        print(row(make(LENGTH, FACES)), flush=True)
