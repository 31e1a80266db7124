# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples models made of parts with and without what is hidden; prints a Markdown table.

Run through benchmarks/outside/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

import dapple3d as dapple
import numpy as np

from benchmarks.compare.components import components
from benchmarks.compare.tables import say, table
from benchmarks.specks.shapes import Mesh, joined, moved, sphere

EDGE = 0.1  # of the spacing, at the border of what is hidden
CROWDED = 0.6  # spacings: nearer pairs on different parts are too near


def figure() -> Mesh:
    """Balls like the parts of a figure: a body, a head, arms and legs."""
    parts = [((0, 0, 0), 1.0), ((0, 0, 1.3), 0.6), ((0.9, 0, 0.4), 0.4), ((-0.9, 0, 0.4), 0.4)]
    parts += [((0.4, 0, -1.0), 0.45), ((-0.4, 0, -1.0), 0.45)]
    return joined([moved(sphere(3), size, np.array(at)) for at, size in parts])


def parts_of(mesh: Mesh) -> np.ndarray:
    """The connected part (m,) of each face."""
    _, places = np.unique(mesh[0], axis=0, return_inverse=True)
    return components(places.ravel()[mesh[1]].astype(np.int32))


def hidden(surface: dapple.Surface, samples: dapple.Samples) -> int:
    """How many samples see nothing of the sky."""
    seen = dapple.exposure(surface, samples.faces, samples.barycentric)
    return int((seen == 0.0).sum())


def nearest_across(parts: np.ndarray, samples: dapple.Samples) -> np.ndarray:
    """Distance (n,) of each sample to the nearest one on another part; inf if there is none."""
    own, found = parts[samples.faces], np.full(len(samples), np.inf)
    for k, place in enumerate(samples.positions):
        others = samples.positions[own != own[k]]
        if len(others):
            found[k] = np.linalg.norm(others - place, axis=1).min()
    return found


def rows(name: str, mesh: Mesh, count: int, seeds: int) -> list[list[str]]:
    surface, parts = dapple.Surface(*mesh), parts_of(mesh)
    begin = time.perf_counter()
    refined = dapple.refine_outside(surface, EDGE * surface.spacing(count))
    cutting = time.perf_counter() - begin
    return [
        row(name, "all", surface, None, parts, count, seeds, 0.0),
        row(name, "outside", surface, refined, parts, count, seeds, cutting),
    ]


def row(
    name: str,
    which: str,
    surface: dapple.Surface,
    refined: dapple.Refined | None,
    parts: np.ndarray,
    count: int,
    seeds: int,
    cutting: float,
) -> list[str]:
    solved = surface if refined is None else refined.surface
    spacing = float(np.sqrt(2.0 * solved.capacity / (np.sqrt(3.0) * count)))
    inside, across, near, variation, seconds = [], [], [], [], []
    for seed in range(seeds):
        begin = time.perf_counter()
        samples = dapple.sample(solved, count, seed=seed)
        seconds.append(time.perf_counter() - begin)
        variation.append(samples.report.capacity_variation)
        here = samples if refined is None else refined.to_original(samples)
        inside.append(hidden(surface, here))
        found = nearest_across(parts, here) / spacing
        across.append(found.min())
        near.append(int((found < CROWDED).sum()) // 2)
    return [
        name,
        f"{len(surface.faces):,}",
        which,
        str(max(inside)),
        f"{min(across):.2f}",
        str(max(near)),
        f"{max(variation):.3f}",
        f"{cutting:.2f}",
        f"{statistics.median(seconds):.2f}",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=1500)
    parser.add_argument("--seeds", type=int, default=3)
    given = parser.parse_args()
    found: list[tuple[str, Mesh]] = []
    for path in given.meshes:
        vertices, faces = dapple.read_mesh(path)
        found.append((path.stem, (vertices, faces.astype(np.int64))))
    found = found or [("figure of balls", figure())]
    head = ["model", "faces", "points", "hidden", "nearest across parts, spacings"]
    head += [f"pairs below {CROWDED}", "variation", "cutting, s", "sampling, s"]
    lines = [line for name, mesh in found for line in rows(name, mesh, given.count, given.seeds)]
    say(f"{given.count} points; the worst of {given.seeds} seeds")
    say(table(head, lines))


if __name__ == "__main__":
    main()
