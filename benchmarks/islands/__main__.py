# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples a wavy ground under masks with islands; prints a Markdown table beside the whole ground.

Run through benchmarks/islands/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from benchmarks.compare.tables import say, table

Array = NDArray[np.float64]
SIDE, CELLS, COUNT = 100.0, 500, 20_000  # a spacing of 0.55 where half of it is masked
VARIATION, FINE, ALPHA, RATIO = 0.008, 0.012, 0.6, 2.2  # the goals; FINE for the finest masks
FRAMES = 12  # of a moving ground
EDGE = 0.1  # of the range of the noise, over which a soft mask falls to 0


def ground() -> tuple[Array, NDArray[np.int64]]:
    line = np.linspace(0, SIDE, CELLS + 1)
    x, y = (k.ravel() for k in np.meshgrid(line, line, indexing="ij"))
    row, column = (k.ravel() for k in np.indices((CELLS, CELLS)))
    a = row * (CELLS + 1) + column
    b = a + CELLS + 1
    faces = np.vstack([np.column_stack([a, b, b + 1]), np.column_stack([a, b + 1, a + 1])])
    return np.column_stack([x, y, 2 * np.sin(x / 6) * np.cos(y / 7)]), faces


def noise(size: float) -> Array:
    """At the vertices, in 0..1, of waves twice as long as the patches."""
    shape, step = (CELLS + 1, CELLS + 1), SIDE / CELLS
    spectrum = np.fft.rfft2(np.random.default_rng(0).normal(size=shape))
    frequency = np.hypot(np.fft.fftfreq(shape[0], step)[:, None], np.fft.rfftfreq(shape[1], step))
    ring = np.exp(-((2 * size * frequency - 1) ** 2) / 0.1)
    values = np.fft.irfft2(spectrum * ring, shape)
    return np.asarray((values - values.min()) / np.ptp(values)).ravel()


def soft(values: Array) -> Array:
    return np.clip((values - np.median(values)) / EDGE + 0.5, 0, 1)


def octaves() -> Array:
    return noise(1) + 0.5 * noise(0.5)


MASKS: dict[str, tuple[Callable[[], Array], bool, float]] = {
    "whole": (lambda: np.ones((CELLS + 1) ** 2), False, VARIATION),
    "patches of 20": (lambda: soft(noise(20)), False, VARIATION),
    "patches of 5": (lambda: soft(noise(5)), False, VARIATION),
    "patches of 2": (lambda: soft(noise(2)), False, VARIATION),
    "patches of 1": (lambda: soft(noise(1)), False, FINE),
    "two octaves": (lambda: soft(octaves()), False, FINE),
    "hard patches of 5": (lambda: soft(noise(5)), True, VARIATION),
    "hard patches of 2": (lambda: soft(noise(2)), True, VARIATION),
    "hard patches of 1": (lambda: soft(noise(1)), True, FINE),
}


@dataclass(frozen=True)
class Found:
    """What is measured of points, whoever made them."""

    positions: Array
    report: dapple.Report


def main() -> None:
    parser = argparse.ArgumentParser(prog="benchmarks/islands/run.sh", description=__doc__)
    parser.add_argument("--only", choices=MASKS, help="one mask, beside the whole ground")
    parser.add_argument("--seeds", type=int, default=1, help="how many, from 0 on")
    parser.add_argument("--pictures", type=Path, help="a folder for pictures from above")
    parser.add_argument("--node", action="store_true", help="Blender's Poisson Disk beside them")
    parser.add_argument("--moving", action="store_true", help="frames of a ground that swells")
    given = parser.parse_args()
    vertices, faces = ground()
    base = dapple.Surface(vertices, faces)
    if given.moving:
        return print_moving(base, given.only)
    rows: list[list[str]] = []
    whole = 0.0
    for name, (density, hard, variation) in MASKS.items():
        if given.only not in (None, name) and name != "whole":
            continue
        say(name)
        surface = masked(base, faces, density(), hard=hard)
        runs = [measured(surface, seed) for seed in range(given.seeds)]
        seconds = median(run[0] for run in runs)
        whole = whole or seconds
        rows.append(row(name, runs, seconds / whole, variation))
        if given.pictures:
            draw(runs[0][1].positions, given.pictures / f"{name.replace(' ', '-')}.png")
        if given.node:
            found = by_node(surface)
            rows.append(row("  Poisson Disk", [found], found[0] / whole, np.inf))
            if given.pictures:
                draw(found[1].positions, given.pictures / f"{name.replace(' ', '-')}-node.png")
    head = ("mask", "seconds", "ratio", "evaluations", "variation", "by whole numbers", "alpha min")
    print(table((*head, "goals"), rows))
    print(f"\n{COUNT} samples on {len(faces)} faces, medians over {given.seeds} seeds. Goals:")
    print(f"variation {VARIATION} ({FINE} for patches of 1 and two octaves) beyond what whole")
    print(f"numbers ask for, alpha min {ALPHA}, {RATIO} times the time of the whole ground.")


def masked(
    base: dapple.Surface, faces: NDArray[np.integer], density: Array, *, hard: bool
) -> dapple.Surface:
    if density.min() == density.max():
        return base
    if hard:
        at_faces = (density[faces].mean(1) > 0.5).astype(float)
        return dapple.Surface(base.vertices, faces, density=at_faces, density_at="faces")
    return dapple.Surface(base.vertices, faces, density=density)


def measured(surface: dapple.Surface, seed: int) -> tuple[float, dapple.Samples]:
    begin = time.perf_counter()
    samples = dapple.sample(surface, COUNT, seed=seed)
    return time.perf_counter() - begin, samples


def by_node(surface: dapple.Surface) -> tuple[float, Found]:
    """About as many points of Blender's node, whose Density Factor the mask is."""
    import bpy

    from benchmarks.tracking.scatter_node import ScatterNode

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    density = surface.density
    masked = None if density is None else density.ravel()
    node = ScatterNode(bpy, surface.vertices, surface.faces, surface.area, COUNT, masked)
    begin = time.perf_counter()
    points = node.points(surface.vertices)
    seconds = time.perf_counter() - begin
    places = dapple.project(surface, points)
    samples = dapple.Samples(surface, places.faces, places.barycentric)
    return seconds, Found(samples.positions, dapple.analyze(surface, samples))


def print_moving(base: dapple.Surface, only: str | None) -> None:
    """A table of tracked frames, beside those of the whole ground."""
    rows: list[list[str]] = []
    whole = 0.0
    for name, (density, hard, _) in MASKS.items():
        if only not in (None, name) and name != "whole":
            continue
        say(name)
        surface = masked(base, base.faces, density(), hard=hard)
        tracker = dapple.Tracker(surface, dapple.sample(surface, COUNT))
        reports = []
        for frame in range(1, FRAMES + 1):
            reports.append(tracker.advance(swollen(surface.vertices, frame)).report)
        seconds = median(report.seconds for report in reports)
        whole = whole or seconds
        rows.append(
            [
                *(name, f"{1000 * seconds:.0f}", f"{seconds / whole:.1f}"),
                f"{median(report.evaluations for report in reports):.0f}",
                f"{max(report.capacity_variation for report in reports):.4f}",
                f"{max(report.whole_count_variation for report in reports):.4f}",
                f"{min(report.alpha_min for report in reports):.2f}",
            ]
        )
    head = ("mask", "ms a frame", "ratio", "evaluations", "variation", "by whole numbers")
    print(table((*head, "alpha min"), rows))
    print(f"\n{COUNT} samples, {FRAMES} frames: medians of time and evaluations, else the worst.")


def swollen(vertices: Array, frame: int) -> Array:
    """The ground with hills that rise and wander."""
    x, y = vertices[:, 0], vertices[:, 1]
    hills = np.sin(x / 6 + 0.05 * frame) * np.cos(y / 7) * (2 + 0.1 * frame)
    return np.column_stack([x, y, hills])


def row(
    name: str, runs: Sequence[tuple[float, dapple.Samples | Found]], ratio: float, variation: float
) -> list[str]:
    reports = [samples.report for _, samples in runs]
    found = median(report.capacity_variation for report in reports)
    whole = median(report.whole_count_variation for report in reports)
    alpha = min(report.alpha_min for report in reports)
    goals = {
        "variation": found <= variation + whole,
        "alpha min": alpha >= ALPHA,
        "time": ratio <= RATIO,
    }
    missed = ", ".join(goal for goal, met in goals.items() if not met)
    judged = f"missed: {missed}" if missed else "met"
    return [
        *(name, f"{median(seconds for seconds, _ in runs):.1f}", f"{ratio:.1f}"),
        f"{median(report.evaluations for report in reports):.0f}",
        *(f"{found:.4f}", f"{whole:.4f}", f"{alpha:.2f}"),
        "-" if np.isinf(variation) else judged,
    ]


def draw(positions: Array, path: Path, size: int = 1600) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    picture = Image.new("L", (size, size), 255)
    pen = ImageDraw.Draw(picture)
    for x, y in positions[:, :2] * (size / SIDE):
        pen.ellipse((x - 3, y - 3, x + 3, y + 3), fill=0)
    picture.save(path)


if __name__ == "__main__":
    main()
