# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole runs whose time is measured, each made ready before."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

from benchmarks.progress.cases import torus

Array = NDArray[np.float64]
Run = Callable[[], dapple.Report | None]
Make = Callable[[int], Run]  # of a seed

_FACES = (264, 132)  # around a torus and its tube: 69,696 faces
_TRACKED = (158, 79)  # 24,964 faces
_RATIO = 100.0  # largest over smallest density
# As Blender's qualities of these names.
_REGULAR: dict[str, Any] = {"capacity_weight": 5.0, "tolerance": 5e-5, "max_evaluations": 400}
_HONEYCOMB: dict[str, Any] = {"capacity_weight": 0.0, "tolerance": 1e-4, "max_evaluations": 600}


class Mesh:
    """What the runs are on: a file, or a torus with waves; the same torus with more faces."""

    def __init__(self, file: Path | None = None) -> None:
        self.vertices, self.faces = dapple.read_mesh(file) if file else torus(*_FACES)

    def surface(self, density: Array | None = None) -> dapple.Surface:
        return dapple.Surface(self.vertices, self.faces, density)

    def ramp(self) -> Array:
        """From 1 to 100 along the longest axis."""
        extent = np.ptp(self.vertices, axis=0)
        axis = int(np.argmax(extent))
        t = (self.vertices[:, axis] - self.vertices[:, axis].min()) / extent[axis]
        return np.asarray(_RATIO**t)


def _sample(
    mesh: Mesh, count: int, ramp: bool = False, locked: bool = False, **settings: Any
) -> Make:
    def make(seed: int) -> Run:
        surface = mesh.surface(mesh.ramp() if ramp else None)
        options: dict[str, Any] = {"seed": seed} | settings
        if locked:
            options["locked"] = _half(surface, dapple.sample(surface, count, seed=seed))
        return lambda: dapple.sample(surface, count, **options).report

    return make


def _half(surface: dapple.Surface, samples: dapple.Samples) -> dapple.Samples:
    """Half of them, here and there."""
    chosen = np.random.default_rng(1).permutation(len(samples))[::2]
    return dapple.Samples(surface, samples.faces[chosen], samples.barycentric[chosen])


def _classes(mesh: Mesh, count: int) -> Make:
    def make(seed: int) -> Run:
        surface = mesh.surface()
        counts = [dapple.SampleClass(count // 3)] * 3
        return lambda: dapple.sample_classes(surface, counts, seed=seed).report

    return make


def _changed(mesh: Mesh) -> tuple[dapple.Surface, Array]:
    """A surface, and its density doubled on about 1 % of it."""
    away = np.linalg.norm(mesh.vertices - mesh.vertices[0], axis=1)
    return mesh.surface(np.ones(len(away))), np.where(away < np.quantile(away, 0.01), 2.0, 1.0)


def _relaxed(mesh: Mesh, count: int) -> Make:
    def make(seed: int) -> Run:
        surface, density = _changed(mesh)
        samples = dapple.sample(surface, count, seed=seed)
        after = surface.with_density(density)
        changed = dapple.changed_faces(surface, after)
        return lambda: dapple.relax(after, samples, changed).report

    return make


def _repainted(mesh: Mesh) -> Make:
    def make(_seed: int) -> Run:
        surface, density = _changed(mesh)

        def run() -> None:
            dapple.changed_faces(surface, surface.with_density(density))

        return run

    return make


def _faces(around: int, tube: int, count: int) -> Make:
    def make(seed: int) -> Run:
        surface = dapple.Surface(*torus(around, tube))
        return lambda: dapple.sample(surface, count, seed=seed).report

    return make


def _planar(domain: Callable[[], dapple.FlatDomain], count: int) -> Make:
    def make(seed: int) -> Run:
        flat = domain()
        return lambda: dapple.sample(flat, count, seed=seed).report

    return make


def _picture(side: int) -> NDArray[np.uint8]:
    """Ramps and waves with a disc, a black box and a white one, which have sharp borders."""
    row, column = np.indices((side, side)) / side
    gray = 0.15 + 0.35 * (row + column) + 0.15 * np.sin(12 * row) * np.sin(9 * column)
    gray = np.where(np.hypot(row - 0.35, column - 0.6) < 0.2, 0.05 + 0.3 * column, gray)
    gray[int(0.65 * side) : int(0.85 * side), int(0.1 * side) : int(0.4 * side)] = 1.0
    gray[int(0.55 * side) : int(0.85 * side), int(0.65 * side) : int(0.85 * side)] = 0.0
    return np.rint(255 * gray.clip(0, 1)).astype(np.uint8)


def _stippled(side: int, count: int) -> Make:
    def make(seed: int) -> Run:
        picture = _picture(side)
        return lambda: dapple.stipple(picture, count, seed=seed).report

    return make


def _tracked(count: int) -> Make:
    """A frame while waves run over the surface; they are there from the first frame on."""

    def make(seed: int) -> Run:
        vertices, faces = torus(*_TRACKED)
        time = iter(np.arange(10_000) * 0.05)

        def bent() -> Array:
            moved = vertices.copy()
            moved[:, 2] += 0.2 * np.sin(3 * vertices[:, 0] + next(time))
            return moved

        surface = dapple.Surface(bent(), faces)
        tracker = dapple.Tracker(surface, dapple.sample(surface, count, seed=seed))

        def frame() -> dapple.Report:
            tracker.advance(bent())
            return tracker.samples.report

        return frame

    return make


def _still(count: int) -> Make:
    """A frame in which nothing moved."""

    def make(seed: int) -> Run:
        surface = dapple.Surface(*torus(*_TRACKED))
        tracker = dapple.Tracker(surface, dapple.sample(surface, count, seed=seed))
        vertices = surface.vertices
        return lambda: tracker.advance(vertices).report

    return make


def _mosaic(mesh: Mesh, count: int) -> Make:
    def make(seed: int) -> Run:
        surface = mesh.surface()
        samples = dapple.sample(surface, count, seed=seed)
        height = 0.2 * samples.report.spacing

        def run() -> None:
            dapple.mosaic(surface, samples, thickness=height)

        return run

    return make


def cases(mesh: Mesh) -> dict[str, Make]:
    """By name; the number after the first slash is that of the samples."""
    small = (2_000, 10_000, 100_000)
    return (
        {f"sample/{n}": _sample(mesh, n) for n in (*small, 1_000_000)}
        | {f"ramp/{n}": _sample(mesh, n, ramp=True) for n in small}
        | {f"half locked/{n}": _sample(mesh, n, locked=True) for n in small}
        | {f"regular/{n}": _sample(mesh, n, **_REGULAR) for n in small}
        | {f"honeycomb/{n}": _sample(mesh, n, **_HONEYCOMB) for n in small}
        | {f"3 classes/{n}": _classes(mesh, n) for n in small}
        | {f"1 % relaxed/{n}": _relaxed(mesh, n) for n in small}
        | {
            "1 % repainted/0": _repainted(mesh),
            "279,000 faces/2000": _faces(528, 264, 2_000),
            "1.1M faces/2000": _faces(1_056, 528, 2_000),
            "torus/100000": _planar(lambda: dapple.Torus(), 100_000),
            "plane/100000": _planar(lambda: dapple.Plane(1.0, 1.0), 100_000),
            "picture/100000": _stippled(1024, 100_000),
            "picture/1000000": _stippled(4096, 1_000_000),
            "tracked frame/2000": _tracked(2_000),
            "tracked frame/20000": _tracked(20_000),
            "still frame/20000": _still(20_000),
            "mosaic/10000": _mosaic(mesh, 10_000),
        }
    )
