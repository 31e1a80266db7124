# SPDX-License-Identifier: GPL-3.0-or-later
"""Figs. 10 to 13: several classes, on the torus and on a surface."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import mean
from typing import TYPE_CHECKING, Any

import dapple3d as dapple
import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from benchmarks.compare.tables import say
from benchmarks.paper.drawing import (
    CLASS_COLORS,
    Array,
    bare,
    draw_periodogram,
    draw_points,
    draw_radial,
    half_frequency,
    peak,
    sheet,
    show,
)
from benchmarks.paper.plane import qualities
from benchmarks.paper.setting import PICTURE_ONLY, WAYS, Plate, Row, Setting, row
from benchmarks.paper.surfaces import body

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COUNTS = {10: (1000, 1000), 11: (500, 1500), 12: (400, 800, 1600)}
CENTRAL = 0.6  # side of the part that is drawn, as in the paper
TORUS = "Our own counts: the paper uses Wei's, which its text does not give."
SPECTRAL = "A lower peak than with one class (Fig. 5), because the classes compete."
SURFACE = "A different body than the paper's, whose counts are not given either."
OPTIONS = {name: {**options, "two_stages": name != "our default"} for name, options in WAYS.items()}
"""The paper's preset is Algorithm 3: each class alone, then all."""


def sets_of(positions: Array, classes: NDArray[np.int32], count: int) -> list[Array]:
    """The points of each class, and last of all."""
    return [*(positions[classes == k] for k in range(count)), positions]


def names_of(counts: Sequence[int]) -> list[str]:
    return [*(f"class {k + 1} ({n:,})" for k, n in enumerate(counts)), f"all ({sum(counts):,})"]


def draw_central(axes: Axes, points: Array, colors: str | list[str], title: str) -> None:
    draw_points(axes, points, colors, size=4.0)
    low, high = (1 - CENTRAL) / 2, (1 + CENTRAL) / 2
    axes.set(xlim=(low, high), ylim=(low, high))
    bare(axes, title)


def draw_sets(
    axes: list[list[Axes]], runs: Sequence[dapple.PlanarSamples], title: str
) -> dapple.Spectrum:
    """A row of points, of periodograms and of radial means: each class, then all.

    Returns the spectrum of all.
    """
    count = len(axes[0]) - 1
    sets = [sets_of(run.positions, run.classes, count) for run in runs]
    names = names_of([len(points) for points in sets[0][:-1]])
    for k, name in enumerate(names):
        colors: str | list[str] = (
            CLASS_COLORS[k] if k < count else [CLASS_COLORS[c] for c in runs[0].classes]
        )
        draw_central(axes[0][k], sets[0][k], colors, f"{title}: {name}")
        spectrum = dapple.spectrum([one[k] for one in sets])
        draw_periodogram(axes[1][k], spectrum)
        draw_radial(axes[2][k], spectrum.radial, spectrum.frequency_unit)
    return spectrum


def make(counts: Sequence[int], options: dict[str, Any]) -> Callable[[int], dapple.PlanarSamples]:
    """Classes of these counts, by the seed."""
    return lambda seed: dapple.sample_classes(
        dapple.Torus(), list(counts), seed=seed, threads=1, **options
    )


def torus_classes(figure: int, setting: Setting) -> Plate:
    """Classes of these counts on the torus, by both ways."""
    counts = tuple(setting.size(n, n // 10) for n in COUNTS[figure])
    sets = len(counts) + 1
    picture, axes = sheet(3, 2 * sets, 2.3)
    reports, spectra = [], []
    for k, (way, options) in enumerate(OPTIONS.items()):
        say(f"fig. {figure}: {way}")
        runs = setting.each_seed(make(counts, options), setting.size(5, 1))
        mine = [line[sets * k : sets * (k + 1)] for line in axes]
        spectra.append(draw_sets(mine, runs, "default" if k else "preset"))
        reports.append([run.report for run in runs])
    picture.savefig(setting.picture(figure))
    title = f"{' + '.join(f'{n:,}' for n in counts)} samples on the torus"
    rows = [*class_rows(counts, reports, TORUS), spectral_row(spectra)]
    return Plate(figure, title, setting.picture(figure), rows)


def spectral_row(spectra: Sequence[dapple.Spectrum]) -> Row:
    values = [
        f"{half_frequency(one.radial, one.frequency_unit):.3f}, {peak(one.radial):.2f}"
        for one in spectra
    ]
    quantity = "all: power at half of sqrt(n), and at its peak"
    return row(quantity, PICTURE_ONLY, values, SPECTRAL)


def class_rows(
    counts: Sequence[int], reports: Sequence[Sequence[dapple.Report]], remark: str
) -> list[Row]:
    """A row for each class and one for all."""
    rows = []
    for k, name in enumerate(names_of(counts)):
        values = [
            qualities([one.classes[k] if k < len(counts) else one for one in runs])
            for runs in reports
        ]
        said = remark if k < len(counts) else of_all(*reports)
        rows.append(row(f"{name}: alpha min, variation, psi6", PICTURE_ONLY, values, said))
    return rows


def of_all(preset: Sequence[dapple.Report], default: Sequence[dapple.Report]) -> str:
    """How near the nearest pair of all is, one way against the other."""
    two_stages, joint = (mean(one.alpha_min for one in runs) for runs in (preset, default))
    if two_stages < joint:
        return "Two stages leave closer pairs in the union than our joint start and repulsion do."
    return (
        "Two stages keep the pairs of the union as far apart as our joint start and repulsion do."
    )


def figure_10(setting: Setting) -> Plate:
    """Two classes of the same count."""
    return torus_classes(10, setting)


def figure_11(setting: Setting) -> Plate:
    """Two classes of different counts."""
    return torus_classes(11, setting)


def figure_12(setting: Setting) -> Plate:
    """Three classes of different counts."""
    return torus_classes(12, setting)


def figure_13(setting: Setting) -> Plate:
    """Two classes on a surface: all, then each."""
    one = body(setting)
    counts = setting.size((600, 1200), (60, 120))
    scene, colors = one.scene(), np.array([to_rgb(name) for name in CLASS_COLORS])
    radius = 0.3 * one.surface.spacing(sum(counts))
    figure, axes = sheet(2, 3)
    reports = []
    for line, (way, options) in zip(axes, OPTIONS.items(), strict=True):
        say(f"fig. 13: {one.name}, {way}")
        samples = dapple.sample_classes(one.surface, list(counts), threads=1, **options)
        of_class = [samples.classes == k for k in range(len(counts))]
        for place, chosen, name in zip(
            line,
            [np.full(len(samples), True), *of_class],
            ["all", "class 1", "class 2"],
            strict=True,
        ):
            picture = scene.dots(samples.positions[chosen], colors[samples.classes[chosen]], radius)
            show(place, picture, f"{way}: {name}")
        reports.append([samples.report])
    figure.savefig(setting.picture(13))
    title = f"two classes on the {one.name}"
    return Plate(13, title, setting.picture(13), class_rows(counts, reports, SURFACE))
