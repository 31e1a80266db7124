# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies whose faces change, remeshed frame after frame: a Markdown table.

Each frame goes on from the one before (MeshSequence), and is remeshed by itself for comparison.
"""

import time
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import dapple3d as dapple
import numpy as np

from benchmarks.tracking.changing import CHANGING, Changing, Mesh

LENGTH = 24  # frames
FACES = 12_000
COUNT = 2_000
HEAD = (
    "| sequence | vertices | unmoved | new on a frame | smallest angle, mean of the triangles' | "
    "valence 6 | flaws | time of a frame, of a remesh by itself |\n" + "|---" * 8 + "|"
)


@dataclass(frozen=True)
class Carved(Changing):
    """A mesh of a file with a dent that becomes deeper."""

    @classmethod
    def of_file(cls, path: Path) -> "Carved":
        found = dapple.read_mesh(path)
        vertices, faces = np.asarray(found.vertices), np.asarray(found.faces)
        size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
        middle = vertices[vertices[:, 1].argmax()]

        def mesh(frame: int) -> Mesh:
            ball = 0.25 * size * frame / LENGTH
            ways = vertices - middle
            far = np.linalg.norm(ways, axis=1, keepdims=True)
            pushed = middle + ways * np.maximum(ball / np.maximum(far, 1e-12), 1.0)
            return pushed, faces[: len(faces) - frame % 2]

        return cls(path.stem, LENGTH, mesh)


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


def table(meshes: Path) -> None:
    """Print a line for each sequence; the bunny is left out if its file is missing."""
    print(HEAD)
    bodies = [make(LENGTH, FACES) for make in CHANGING.values()]
    if (meshes / "bunny.ply").is_file():
        bodies.append(Carved.of_file(meshes / "bunny.ply"))
    for body in bodies:
        print(row(body), flush=True)
