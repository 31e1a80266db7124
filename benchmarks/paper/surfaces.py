# SPDX-License-Identifier: GPL-3.0-or-later
"""Figs. 6 to 8: lambda, a density from the curvature, and spectra on a surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import dapple3d as dapple
import numpy as np

from benchmarks.compare.cases import mesh_files
from benchmarks.compare.tables import say
from benchmarks.paper.drawing import Array, draw_radial, half_frequency, peak, sheet, show
from benchmarks.paper.plane import qualities
from benchmarks.paper.scene import Scene, view
from benchmarks.paper.setting import PICTURE_ONLY, WAYS, Plate, Row, Setting, fastest, row
from benchmarks.tracking.animations import GENERATED

PASTEL = np.array(
    [[0.80, 0.87, 0.95], [0.98, 0.88, 0.77], [0.84, 0.93, 0.82], [0.95, 0.83, 0.86], [1, 1, 0.86]]
)
DOT = np.array([[0.62, 0.20, 0.13]])
WEIGHTS = (0.0, 10.0, 30.0, 100.0, 1000.0)  # which ones the paper drew is not in its text
QUICK_WEIGHTS = (0.0, 30.0)
TIMED = 30.0
SHORT = dict(zip(WAYS, ("preset", "default"), strict=True))


@dataclass(frozen=True)
class Body:
    """A surface, and how it is looked at."""

    name: str
    surface: dapple.Surface
    eye: Array

    def scene(self, width: int = 380) -> Scene:
        return Scene(self.surface.vertices, self.surface.faces, self.eye, width=width)


def body(setting: Setting) -> Body:
    """The bunny of the folder; without one a generated four-legged body."""
    return _body(setting.folder, setting.size(20_000, 6000))


@cache
def _body(folder: Path, faces: int) -> Body:
    found = mesh_files(folder).get("bunny") if folder.is_dir() else None
    if found:
        return Body("bunny", dapple.Surface(*dapple.read_mesh(found)), view("y", -15, 12))
    made = GENERATED["walk"](1, faces)
    return Body("creature", dapple.Surface(made.frames[0], made.faces), view("z", 25, 18))


def runs_of(
    surface: dapple.Surface, count: int, seeds: int, setting: Setting, **options: Any
) -> list[dapple.Samples]:
    """One set of samples for each seed."""
    return setting.each_seed(
        lambda seed: dapple.sample(surface, count, seed=seed, threads=1, **options), seeds
    )


def mixed(count: int) -> Array:
    """Pale colors (count, 3), neighbors in number being unlike."""
    return PASTEL[np.arange(count) * 2 % len(PASTEL)]


def figure_6(setting: Setting) -> Plate:
    """Cells and samples of a surface at several lambda."""
    one, count = body(setting), setting.size(2000, 300)
    weights = setting.size(WEIGHTS, QUICK_WEIGHTS)
    scene, radius = one.scene(), 0.25 * one.surface.spacing(count)
    figure, axes = sheet(2, len(weights), 2.9)
    rows = []
    for column, weight in enumerate(weights):
        say(f"fig. 6: {one.name}, lambda {weight:g}")
        times = 3 if weight == TIMED else 1
        found = [
            fastest(sampled(one.surface, count, options | {"capacity_weight": weight}), times)
            for options in WAYS.values()
        ]
        sites = found[0].positions
        show(axes[0][column], scene.cells(sites, mixed(count)), f"preset, lambda {weight:g}")
        show(axes[1][column], scene.dots(sites, np.repeat(DOT, count, axis=0), radius), "samples")
        values = [qualities([samples.report]) for samples in found]
        remark = "Less regular as lambda grows (psi6), as in the paper; a different body."
        quantity = f"{one.name}, {count:,} samples, lambda {weight:g}: alpha min, variation, psi6"
        rows.append(row(quantity, PICTURE_ONLY, values, remark))
        if weight == TIMED:
            rows.append(time_row(one, count, found))
    figure.savefig(setting.picture(6))
    return Plate(6, f"{one.name} at several lambda", setting.picture(6), rows)


def sampled(
    surface: dapple.Surface, count: int, options: dict[str, Any]
) -> Callable[[], dapple.Samples]:
    return lambda: dapple.sample(surface, count, threads=1, **options)


def time_row(one: Body, count: int, found: list[dapple.Samples]) -> Row:
    values = [
        f"{samples.report.seconds:.1f} s, {samples.report.evaluations} evaluations"
        for samples in found
    ]
    return row(
        f"time of {count:,} samples on one thread, lambda {TIMED:g}, best of three",
        "about 16 s",
        values,
        f"A different machine and body: {len(one.surface.faces):,} faces here; the paper's dog "
        "is not available, and its number of faces is not given.",
    )


def figure_7(setting: Setting) -> Plate:
    """Samples that follow a density from the curvature."""
    one, count = body(setting), setting.size(4000, 400)
    density = dapple.curvature_density(one.surface)
    dense = one.surface.with_density(density)
    found = []
    for way, options in WAYS.items():
        say(f"fig. 7: {one.name}, {way}")
        found.append(dapple.sample(dense, count, threads=1, **options))
    scene = one.scene(460)
    figure, axes = sheet(1, 3, 3.6)
    samples = found[0]
    at = np.einsum("nk,nk->n", samples.barycentric, density[dense.faces[samples.faces]])
    # The spacing that a density phi asks for: of as many sites on the area that has phi all over.
    radii = 0.25 * np.sqrt(2 / np.sqrt(3) * dense.capacity / count / at)
    pictures = [
        scene.values(density),
        scene.cells(samples.positions, mixed(count)),
        scene.dots(samples.positions, np.repeat(DOT, count, axis=0), radii),
    ]
    titles = ["density from the curvature", "cells, preset", "samples, preset"]
    for place, picture, title in zip(axes[0], pictures, titles, strict=True):
        show(place, picture, title)
    figure.savefig(setting.picture(7))
    values = [qualities([samples.report]) for samples in found]
    rows = [
        row(
            f"{one.name}, {count:,} samples by curvature: alpha min, variation, psi6",
            PICTURE_ONLY,
            values,
            "A different body than the paper's cat, and our own density: the paper does not say "
            "how it computes density from curvature.",
        )
    ]
    return Plate(7, f"{one.name} by its curvature", setting.picture(7), rows)


def figure_8(setting: Setting) -> Plate:
    """Radial mean and anisotropy of differentials on a surface, for several lambda."""
    one, count = body(setting), setting.size(2000, 300)
    seeds = setting.size(3, 1)
    weights = setting.size(WEIGHTS, QUICK_WEIGHTS)
    cases: dict[str, dict[str, Any]] = {
        f"lambda {weight:g}": {"capacity_weight": weight} for weight in weights
    }
    cases["Poisson-disk start"] = {"max_evaluations": 1, "start": "poisson"}
    figure, axes = sheet(len(WAYS), len(cases), 2.5)
    rows, before = [], [np.inf] * len(WAYS)
    for column, (name, extra) in enumerate(cases.items()):
        values, heights = [], []
        for line, (way, options) in zip(axes, WAYS.items(), strict=True):
            say(f"fig. 8: {name}, {way}")
            runs = runs_of(one.surface, count, seeds, setting, **options | extra)
            spectrum = dapple.surface_spectrum(one.surface, runs, threads=setting.threads)
            draw_radial(line[column], spectrum.radial_power, 1.0, f"{name}, {SHORT[way]}")
            low = half_frequency(spectrum.radial_power, 1.0)
            heights.append(peak(spectrum.radial_power))
            values.append(f"{low:.3f}, {heights[-1]:.2f}")
        quantity = f"{name}: power at half of sqrt(n / area), and at its peak"
        rows.append(row(quantity, PICTURE_ONLY, values, remark_8(name, heights, before)))
        before = heights
    figure.savefig(setting.picture(8))
    return Plate(8, f"spectra on the {one.name}", setting.picture(8), rows)


def remark_8(name: str, heights: list[float], before: list[float]) -> str:
    """before: the peaks at the previous lambda."""
    if name == "lambda 0":
        return "A CVT: the high peak comes from its regular pattern."
    if name.startswith("lambda"):
        if all(now < last for now, last in zip(heights, before, strict=True)):
            return "A lower peak than at the previous lambda, as in the plane."
        return "The peak of the preset, the default or both is not lower, unlike in the plane."
    return (
        "Represents dart throwing; retiling and Bowers et al. from the paper's picture are not run."
    )
