# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables in Markdown and pictures of what was measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from benchmarks.tracking.animations import Animation
from benchmarks.tracking.implicit import Array, Faces
from benchmarks.tracking.metrics import Run, drift, roughness


@dataclass(frozen=True)
class Column:
    """A figure of a run, and the goal that it is held against."""

    title: str
    value: Callable[[Run], float | None]
    digits: int = 3
    goal: float | None = None
    at_least: bool = False

    @property
    def head(self) -> str:
        if self.goal is None:
            return self.title
        return f"{self.title} {'>=' if self.at_least else '<='} {self.goal:g}"

    def cell(self, run: Run) -> str:
        """The figure; bold where it misses the goal."""
        value = self.value(run)
        if value is None:
            return ""
        text = f"{value:.{self.digits}f}"
        missed = self.goal is not None and (
            value < self.goal if self.at_least else value > self.goal
        )
        return f"**{text}**" if missed else text


def energy_off(run: Run) -> Array:
    """How far each frame's energy is from the first frame's."""
    return np.abs(np.array(run.energy) - run.first["energy"])


COLUMNS = [
    Column("e off", lambda run: float(energy_off(run).max()), 4, 0.002),
    Column("alpha min", lambda run: min(run.alpha_min), 3, 0.6, at_least=True),
    Column("alpha min mean", lambda run: float(np.mean(run.alpha_min))),
    Column("variation", lambda run: max(run.capacity_variation), 4, 0.01),
    Column("variation mean", lambda run: float(np.mean(run.capacity_variation)), 4),
    Column("slide mean", lambda run: float(np.mean(run.slide_mean)), 3, 0.15),
    Column("slide max", lambda run: max(run.slide_max), 3, 0.5),
    Column("jerk mean", lambda run: float(np.mean(run.jerk_mean))),
    Column("jerk p99", lambda run: run.jerk_p99, 3, 0.05),
    Column("jerk max", lambda run: max(run.jerk_max)),
    Column("jerk / slide", roughness, 2, 0.5),
    Column("turn max", lambda run: max(run.turn_max), 1),
    Column("hysteresis", lambda run: run.hysteresis),
    Column("psi6 drift", lambda run: abs(drift(run)), 3, 0.03),
    Column("parts", lambda run: float(np.mean(run.parts)), 2),
    Column("evaluations a part", lambda run: sum(run.evaluations) / sum(run.parts), 2, 3),
    Column("ms", lambda run: float(np.mean(run.milliseconds)), 0),
]


def table(runs: Sequence[Run]) -> str:
    """One row for each run; the worst frame where a column does not say mean.

    Lengths in spacings, the turn in degrees a frame, the rest without units; bold misses the goal.
    """
    head = ["animation", "contender", "frames", *(column.head for column in COLUMNS)]
    rows = [
        [run.animation, run.contender, str(len(run.energy)), *(c.cell(run) for c in COLUMNS)]
        for run in runs
    ]
    return markdown(head, rows)


def misses(runs: Sequence[Run]) -> str:
    """How many frames of each run miss the goals that hold for every frame."""
    head = ["animation", "contender", "frames", "e off", "alpha min", "variation", "slide max"]
    rows = []
    for run in runs:
        counts = [
            np.count_nonzero(energy_off(run) > 0.002),
            np.count_nonzero(np.array(run.alpha_min) < 0.6),
            np.count_nonzero(np.array(run.capacity_variation) > 0.01),
            np.count_nonzero(np.array(run.slide_max) > 0.5),
        ]
        rows.append([run.animation, run.contender, str(len(run.energy)), *map(str, counts)])
    return markdown(head, rows)


def replaced_table(found: dict[str, dict[str, list[float]]]) -> str:
    """Blender's own node: the share of points that each frame replaces."""
    rows = [
        [
            name,
            f"{np.mean(one['replaced']):.3f}",
            f"{max(one['replaced']):.3f}",
            f"{min(one['count']):.0f}-{max(one['count']):.0f}",
            f"{np.mean(one['milliseconds']):.0f}",
        ]
        for name, one in found.items()
    ]
    return markdown(["animation", "replaced mean", "replaced max", "points", "ms"], rows)


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


CURVES = {
    "energy": None,
    "alpha_min": 0.6,
    "capacity_variation": 0.01,
    "bond_order": None,
    "slide_mean": 0.15,
    "slide_max": 0.5,
    "jerk_mean": None,
    "evaluations": 3,
}


def draw_curves(runs: Sequence[Run], file: Path) -> None:
    """Every curve of every animation, a column each; dashed: the goal. Riding alone runs off."""
    names = list(dict.fromkeys(run.animation for run in runs))
    figure = Figure(figsize=(4.2 * len(names), 2.2 * len(CURVES)), layout="constrained")
    axes = figure.subplots(len(CURVES), len(names), squeeze=False, sharex="col")
    for row, (curve, goal) in zip(axes, CURVES.items(), strict=True):
        for one, name in zip(row, names, strict=True):
            shown = [run for run in runs if run.animation == name and run.contender != "ride"]
            _draw_curve(one, shown, curve, goal)
        row[0].set_ylabel(curve.replace("_", " "))
    for one, name in zip(axes[0], names, strict=True):
        one.set_title(name)
        if one.get_legend_handles_labels()[0]:
            one.legend(fontsize=8)
    figure.savefig(file, dpi=80)


def _draw_curve(axes: Axes, runs: Sequence[Run], curve: str, goal: float | None) -> None:
    for run in runs:
        axes.plot(getattr(run, curve), label=run.contender, linewidth=1)
    if goal is not None:
        axes.axhline(goal, color="gray", linestyle="--", linewidth=0.8)


def draw_smoothness(
    runs: Sequence[Run], blender: dict[str, dict[str, list[float]]], file: Path
) -> None:
    """Slide and jerk over one period, riding and Blender's node beside the others.

    That node's points are held against the nearest of the frame before that rode along.
    """
    names = list(dict.fromkeys(run.animation for run in runs))
    figure = Figure(figsize=(6.5 * len(names), 5.4), layout="constrained")
    axes = figure.subplots(2, len(names), squeeze=False, sharex="col")
    for row, curve in zip(axes, ("slide_mean", "jerk_mean"), strict=True):
        for one, name in zip(row, names, strict=True):
            shown = {run.contender: getattr(run, curve) for run in _first_runs(runs, name)}
            if name in blender:
                shown["Blender's Poisson disks"] = blender[name][curve]
            for label, values in shown.items():
                one.plot(values, label=label, linewidth=1.2)
        row[0].set_ylabel(curve.removesuffix("_mean") + ", mean, in spacings")
    for one, name in zip(axes[0], names, strict=True):
        one.set_title(name)
    for one in axes[1]:
        one.set_xlabel("frame")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.savefig(file, dpi=80)


def _first_runs(runs: Sequence[Run], animation: str) -> list[Run]:
    """Of each contender, the run over one period."""
    found: dict[str, Run] = {}
    for run in runs:
        if run.animation == animation:
            found.setdefault(run.contender, run)
    return list(found.values())


def draw_frames(animation: Animation, file: Path, shown: int = 6) -> None:
    """Some frames of an animation, evenly over its length."""
    figure = Figure(figsize=(4 * shown, 4.4))
    span = np.ptp(animation.frames.reshape(-1, 3), axis=0).max() / 2
    for k in range(shown):
        frame = k * len(animation.frames) // shown
        axes = figure.add_subplot(1, shown, k + 1, projection="3d")
        _draw_mesh(axes, animation.frames[frame], animation.faces, float(span))
        axes.set_title(f"{animation.name} {frame}")
    figure.subplots_adjust(0, 0, 1, 0.92, 0, 0)
    figure.savefig(file, dpi=60)


def _draw_mesh(axes: Axes3D, vertices: Array, faces: Faces, span: float) -> None:
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    shade = 0.3 + 0.7 * np.abs(normals @ [0.3, -0.6, 0.742])
    colors = shade[:, None] * [0.92, 0.76, 0.5]
    axes.add_collection3d(Poly3DCollection(corners, facecolors=colors))
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    axes.set(**{f"{a}lim": (m - span, m + span) for a, m in zip("xyz", middle, strict=True)})
    axes.set_box_aspect((1, 1, 1), zoom=1.4)
    axes.view_init(20, -65)
    axes.set_axis_off()
