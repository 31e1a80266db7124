# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples a wavy ground with mixtures of classes; prints a Markdown table beside one class.

Run through benchmarks/mixtures/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from benchmarks.compare.tables import say, table
from benchmarks.islands.__main__ import COUNT, SIDE, ground, masked, noise, soft

OVERLAP = 1e-3  # of the wanted distance: less counts as none
COLORS = ((120, 70, 30), (40, 120, 60), (60, 90, 170))


@dataclass(frozen=True)
class Mixture:
    """Counts and radii, and the goals: at most so many times the time of one class, and variations
    of each class and of all, and alpha min of all.
    """

    classes: tuple[tuple[int, float], ...]
    ratio: float
    variations: tuple[float, ...] = ()
    together: float = 1.0
    alpha: float = 0.0
    mask: float | None = None  # size of the patches


FIRST = ((300, 1.0), (2_000, 0.4), (10_000, 0.0))
MIXTURES = {
    "trees, bushes, grass": Mixture(FIRST, 2.7, (0.006, 0.018, 0.041), 0.015, 0.63),
    "the same, masked": Mixture(FIRST, 5.4, (0.03, 0.03, 0.045), mask=5.0),
    "discs for all": Mixture(((300, 1.0), (3_000, 0.4), (27_000, 0.1)), 6.2),
    "three alike": Mixture(((4_000, 0.0),) * 3, 1.9),
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="benchmarks/mixtures/run.sh", description=__doc__)
    parser.add_argument("--only", choices=MIXTURES, help="one mixture, beside one class")
    parser.add_argument("--seeds", type=int, default=1, help="how many, from 0 on")
    parser.add_argument("--two-stages", action="store_true", help="as in the paper")
    parser.add_argument("--pictures", type=Path, help="a folder for pictures from above")
    given = parser.parse_args()
    vertices, faces = ground()
    base = dapple.Surface(vertices, faces)
    alone = [timed(partial(dapple.sample, base, COUNT, seed=seed)) for seed in range(given.seeds)]
    one = median(seconds for seconds, _ in alone)
    rows: list[list[str]] = []
    for name, mixture in MIXTURES.items():
        if given.only not in (None, name):
            continue
        say(name)
        surface = base
        if mixture.mask is not None:
            surface = masked(base, faces, soft(noise(mixture.mask)), hard=False)
        wanted = [dapple.SampleClass(count, radius=radius) for count, radius in mixture.classes]
        sampled = partial(dapple.sample_classes, surface, wanted, two_stages=given.two_stages)
        runs = [timed(partial(sampled, seed=seed)) for seed in range(given.seeds)]
        rows.append(row(name, mixture, runs, one))
        if given.pictures:
            draw(runs[0][1], mixture, given.pictures / f"{name.replace(', ', '-')}.png")
    head = ("mixture", "seconds", "ratio", "evaluations", "variation of each", "of all")
    print(table((*head, "alpha min of all", "worst overlap", "goals"), rows))
    print(
        f"\nMedians over {given.seeds} seeds; ratio: to {COUNT} samples of one class, {one:.1f} s."
    )


def timed(work: Callable[[], dapple.Samples]) -> tuple[float, dapple.Samples]:
    begin = time.perf_counter()
    samples = work()
    return time.perf_counter() - begin, samples


def row(
    name: str, mixture: Mixture, runs: list[tuple[float, dapple.Samples]], one: float
) -> list[str]:
    reports = [samples.report for _, samples in runs]
    ratio = median(seconds for seconds, _ in runs) / one
    each = [median_of(reports, k, "capacity_variation") for k in range(len(mixture.classes))]
    whole = [median_of(reports, k, "whole_count_variation") for k in range(len(mixture.classes))]
    together = median(report.capacity_variation for report in reports)
    alpha = min(report.alpha_min for report in reports)
    overlap = max(report.worst_overlap for report in reports)
    goals = {
        "time": ratio <= mixture.ratio,
        "variation of each": all(
            a <= b + c for a, b, c in zip(each, mixture.variations, whole, strict=False)
        ),
        "variation of all": together <= mixture.together,
        "alpha min": alpha >= mixture.alpha,
        "overlap": overlap <= OVERLAP,
    }
    missed = ", ".join(goal for goal, met in goals.items() if not met)
    return [
        *(name, f"{median(seconds for seconds, _ in runs):.1f}", f"{ratio:.1f}"),
        f"{median(report.evaluations for report in reports):.0f}",
        " ".join(f"{variation:.3f}" for variation in each),
        *(f"{together:.4f}", f"{alpha:.2f}", f"{overlap:.4f}"),
        f"missed: {missed}" if missed else "met",
    ]


def median_of(reports: list[dapple.Report], k: int, name: str) -> float:
    return float(median(getattr(report.classes[k], name) for report in reports))


def draw(samples: dapple.Samples, mixture: Mixture, path: Path, size: int = 2000) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    picture = Image.new("RGB", (size, size), (255, 255, 255))
    pen, scale = ImageDraw.Draw(picture), size / SIDE
    places: NDArray[np.float64] = samples.positions[:, :2] * scale
    for (x, y), k in zip(places, samples.classes, strict=True):
        radius = max(mixture.classes[k][1] * scale, 3.0)
        pen.ellipse((x - radius, y - radius, x + radius, y + radius), fill=COLORS[k])
    picture.save(path)


if __name__ == "__main__":
    main()
