# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges stippled pictures; prints Markdown tables, progress on stderr, and writes the pictures.

measure.py describes how dots are compared with the picture. Run through benchmarks/stipple/run.sh,
which sets everything up first.
"""

from __future__ import annotations

import argparse
import resource
from pathlib import Path
from time import perf_counter

import dapple3d as dapple
import numpy as np
import skimage.data
from dapple3d import stippling
from numpy.typing import NDArray
from skimage.transform import resize

from benchmarks.compare.tables import say, table
from benchmarks.stipple.measure import (
    Quality,
    as_drawn,
    error_diffusion,
    ordered_dither,
    quality,
)

GRAY_DOTS = 10_000
COLOR_DOTS = 280_000  # of Fig. 15
HEAD = ["picture", "method", "dots", "s", "evaluations", "PSNR", "SSIM", "PSNR drawn", "SSIM drawn"]
Array = NDArray[np.float64]


def row(
    name: str,
    method: str,
    count: int,
    seconds: float,
    found: Quality,
    evaluations: int | None = None,
    drawn: Quality | None = None,
) -> list[str]:
    return [
        *(name, method, f"{count:,}", f"{seconds:.1f}"),
        "" if evaluations is None else str(evaluations),
        *(f"{found.psnr:.1f} dB", f"{found.ssim:.3f}"),
        *((f"{drawn.psnr:.1f} dB", f"{drawn.ssim:.3f}") if drawn else ("", "")),
    ]


def gray(given: argparse.Namespace) -> list[list[str]]:
    """10,000 dots for the 512 x 512 pixels of scikit-image's camera."""
    picture = skimage.data.camera() / 255.0
    rows = []
    for seed in range(given.seeds):
        say(f"camera, seed {seed}")
        dots = dapple.stipple(picture, GRAY_DOTS, seed=seed, threads=given.threads)
        report = dots.report
        rows.append(
            row(
                *("camera", f"dapple, seed {seed}", len(dots), report.seconds),
                *(quality(picture, dots.positions), report.evaluations, as_drawn(picture, dots)),
            )
        )
    for suffix in ("png", "svg", "pdf"):
        stippling.write(dots, given.pictures / f"camera.{suffix}")
    for name, method in (
        ("error diffusion", error_diffusion),
        ("ordered dither", ordered_dither),
    ):
        say(f"camera, {name}")
        start = perf_counter()
        positions = method(picture, GRAY_DOTS)
        seconds = perf_counter() - start
        rows.append(row("camera", name, len(positions), seconds, quality(picture, positions)))
    return rows


def astronaut() -> Array:
    """1024 x 768 pixels, the upper three quarters of scikit-image's astronaut, enlarged."""
    return np.clip(resize(skimage.data.astronaut()[:384] / 255.0, (768, 1024), order=1), 0.0, 1.0)


def color(given: argparse.Namespace) -> list[list[str]]:
    picture = astronaut()
    rows = []
    for method, most in (("dapple", 200), ("its start: error diffusion", 1)):
        say(f"astronaut, {method}")
        dots = dapple.stipple(picture, COLOR_DOTS, max_evaluations=most, threads=given.threads)
        report = dots.report
        if method == "dapple":
            print_classes(dots)
            for suffix in ("png", "svg", "pdf"):
                stippling.write(dots, given.pictures / f"astronaut.{suffix}")
        rows.append(
            row(
                *("astronaut", method, len(dots), report.seconds),
                *(quality(picture, dots.positions, dots.classes), report.evaluations),
                as_drawn(picture, dots),
            )
        )
    return rows


def print_classes(dots: stippling.Dots) -> None:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"Color: {dots.report.seconds:.0f} s, at most {peak:.1f} GB of memory.\n")
    sets = [*zip(dots.inks, dots.report.classes, strict=True), ("all", dots.report)]
    rows = [
        [name, f"{one.count:,}"]
        + [f"{x:.4f}" for x in (one.alpha_min, one.alpha_mean, one.capacity_variation)]
        for name, one in sets
    ]
    print(table(["ink", "dots", "alpha min", "alpha mean", "capacity variation"], rows), "\n")


def main() -> None:
    parser = argparse.ArgumentParser(prog="benchmarks/stipple/run.sh", description=__doc__)
    parser.add_argument("--only", choices=["gray", "color"])
    parser.add_argument("--seeds", type=int, default=3, help="of the gray picture, from 0 on")
    parser.add_argument("--threads", type=int, default=0, help="0: all processors")
    parser.add_argument("--pictures", type=Path, default=Path("build/stipple"), metavar="FOLDER")
    given = parser.parse_args()
    if given.seeds < 1:
        parser.error(f"--seeds {given.seeds}: at least one is needed")
    given.pictures.mkdir(parents=True, exist_ok=True)
    rows = gray(given) if given.only != "color" else []
    if given.only != "gray":
        rows += color(given)
    print(table(HEAD, rows))


if __name__ == "__main__":
    main()
