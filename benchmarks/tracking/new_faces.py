# SPDX-License-Identifier: GPL-3.0-or-later
"""How samples behave on bodies whose faces change. Lengths are in spacings of the frame."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import dapple3d as dapple
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.tracking.changing import Changing
from benchmarks.tracking.implicit import Array, Faces
from benchmarks.tracking.metrics import quality
from benchmarks.tracking.report import markdown

FADE = 12  # frames
SHARE = 0.005  # of the samples, that may come and go beside the change of area
SHOWN = 8  # frames of a strip
EYE = np.array([0.35, -0.85, 0.4]) / np.linalg.norm([0.35, -0.85, 0.4])


@dataclass
class NewFaces:
    """A body, and for each frame after the first a row of every list."""

    body: str
    contender: str
    first: dict[str, float]
    count: list[int] = field(default_factory=list)
    births: list[int] = field(default_factory=list)
    deaths: list[int] = field(default_factory=list)
    over: list[float] = field(default_factory=list)  # births and deaths above what they may be
    reused: int = 0  # ids
    alpha_min: list[float] = field(default_factory=list)
    capacity_variation: list[float] = field(default_factory=list)
    bond_order: list[float] = field(default_factory=list)
    slide_mean: list[float] = field(default_factory=list)
    slide_max: list[float] = field(default_factory=list)
    step_max: list[float] = field(default_factory=list)  # of a sample from frame to frame
    evaluations: list[int] = field(default_factory=list)
    milliseconds: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Shown:
    """What a picture shows of a frame."""

    frame: int
    vertices: Array
    faces: Faces
    samples: dapple.Samples


def play(body: Changing, sites: int, seed: int) -> tuple[NewFaces, list[Shown]]:
    """Carry samples of the first frame through all of them."""
    surface = dapple.Surface(*body.mesh(0))
    samples = dapple.sample(surface, sites, seed=seed, threads=1)
    population = dapple.Population(surface, samples, fade=FADE, threads=1)
    run = NewFaces(body.name, "population", quality(surface, samples))
    used = set(samples.ids.tolist())
    shown = []
    for frame, (vertices, faces) in enumerate(body.frames()):
        if frame:
            began = time.perf_counter()
            after = population.advance(vertices, faces)
            run.milliseconds.append(1000 * (time.perf_counter() - began))
            _note(run, surface, samples, population, after, used)
            surface, samples = population.surface, after
        if frame % max(body.length // SHOWN, 1) == 0:
            shown.append(Shown(frame, vertices, faces, samples))
    return run, shown


def nearest(body: Changing, sites: int, seed: int) -> NewFaces:
    """The same samples in all frames, each at the place nearest to its last one."""
    surface = dapple.Surface(*body.mesh(0))
    samples = dapple.sample(surface, sites, seed=seed, threads=1)
    run = NewFaces(body.name, "nearest", quality(surface, samples))
    for frame in range(1, body.length):
        surface = dapple.Surface(*body.mesh(frame))
        found = dapple.project(surface, samples.positions)
        samples = dapple.Samples(surface, found.faces, found.barycentric)
        _note_quality(run, surface, samples)
    return run


def _note_quality(run: NewFaces, surface: dapple.Surface, samples: dapple.Samples) -> None:
    for name, value in quality(surface, samples).items():
        if hasattr(run, name):
            getattr(run, name).append(value)


def _note(
    run: NewFaces,
    before: dapple.Surface,
    last: dapple.Samples,
    population: dapple.Population,
    now: dapple.Samples,
    used: set[int],
) -> None:
    surface, report = population.surface, now.report
    there = slice(report.count)
    alive = dapple.Samples(surface, now.faces[there], now.barycentric[there])
    _note_quality(run, surface, alive)
    born = now.ids[~np.isin(now.ids, last.ids)]
    run.reused += len(used & set(born.tolist()))
    used |= set(now.ids.tolist())
    allowed = (abs(surface.area / before.area - 1) + SHARE) * last.report.count
    run.count.append(report.count)
    run.births.append(report.births)
    run.deaths.append(report.deaths)
    run.over.append(report.births + report.deaths - allowed)
    run.slide_mean.append(report.slide_mean)
    run.slide_max.append(report.slide_max)
    run.step_max.append(_longest_step(last, now) / report.spacing)
    run.evaluations.append(report.evaluations)


def _longest_step(last: dapple.Samples, now: dapple.Samples) -> float:
    """Of the samples that are there in both frames."""
    _, before, after = np.intersect1d(last.ids, now.ids[: now.report.count], return_indices=True)
    return float(np.linalg.norm(now.positions[after] - last.positions[before], axis=1).max())


def table(runs: Sequence[NewFaces]) -> str:
    """One row for each run; the worst frame unless a column says otherwise."""
    head = ["body", "contender", "samples", "births", "deaths", "most over", "reused ids"]
    head += ["alpha min", "variation", "psi6 first", "psi6 last", "slide mean", "slide max"]
    head += ["step max", "evaluations", "ms"]
    rows = []
    for run in runs:
        row = [run.body, run.contender]
        row += [f"{min(run.count)}-{max(run.count)}"] if run.count else [""]
        row += [str(sum(run.births)), str(sum(run.deaths))] if run.count else ["", ""]
        row += [f"{max(run.over):.1f}", str(run.reused)] if run.count else ["", ""]
        row += [f"{min(run.alpha_min):.3f}", f"{max(run.capacity_variation):.4f}"]
        row += [f"{run.first['bond_order']:.3f}", f"{run.bond_order[-1]:.3f}"]
        row += _costs(run) if run.count else [""] * 5
        rows.append(row)
    return markdown(head, rows)


def _costs(run: NewFaces) -> list[str]:
    return [
        f"{np.mean(run.slide_mean):.3f}",
        f"{max(run.slide_max):.3f}",
        f"{max(run.step_max):.2f}",
        f"{np.mean(run.evaluations):.1f}",
        f"{np.mean(run.milliseconds):.0f}",
    ]


def draw_strip(shown: Sequence[Shown], file: Path) -> None:
    """Frames side by side: each sample keeps its color, those that have just come are red."""
    figure = Figure(figsize=(3.4 * len(shown), 3.4))
    axes = figure.subplots(1, len(shown), squeeze=False)[0]
    low = np.min([_seen(one.vertices)[0].min(axis=0) for one in shown], axis=0)
    high = np.max([_seen(one.vertices)[0].max(axis=0) for one in shown], axis=0)
    first = int(shown[0].samples.ids.max())
    for axis, one in zip(axes, shown, strict=True):
        _draw_mesh(axis, one.vertices, one.faces)
        _draw_samples(axis, one.samples, first)
        axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        axis.set_title(f"frame {one.frame}", fontsize=9)
        axis.set_axis_off()
    figure.subplots_adjust(0, 0, 1, 0.92, 0.01, 0)
    figure.savefig(file, dpi=90)


def _seen(points: Array) -> tuple[Array, NDArray[np.float64]]:
    """Places in the picture (n, 2), and how near they are to the eye."""
    across = np.cross([0.0, 0.0, 1.0], EYE)
    across /= np.linalg.norm(across)
    up = np.cross(EYE, across)
    return np.column_stack([points @ across, points @ up]), points @ EYE


def _draw_mesh(axis: Axes, vertices: Array, faces: Faces) -> None:
    places, depth = _seen(vertices)
    order = np.argsort(depth[faces].mean(axis=1))
    corners = vertices[faces[order]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    shade = 0.45 + 0.5 * np.abs(normals @ EYE)
    gray = np.repeat(shade[:, None], 3, axis=1)
    triangles = list(places[faces[order]])
    axis.add_collection(PolyCollection(triangles, facecolors=gray, edgecolors="none"))


def _draw_samples(axis: Axes, samples: dapple.Samples, first: int) -> None:
    """Those on the side that faces the eye."""
    front = samples.normals @ EYE > 0.05
    places, _ = _seen(samples.positions[front])
    ids, fade = samples.ids[front], samples.fade[front]
    colors = np.random.default_rng(1).uniform(0.1, 0.8, (int(samples.ids.max()) + 1, 3))[ids]
    colors[:, 0] *= 0.4
    colors[ids > first] = [0.9, 0.5, 0.1]
    colors[(ids > first) & (fade < 1)] = [0.9, 0.0, 0.1]
    axis.scatter(places[:, 0], places[:, 1], s=9 * np.maximum(fade, 0.15), c=colors, linewidths=0)
