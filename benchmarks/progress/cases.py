# SPDX-License-Identifier: GPL-3.0-or-later
"""One ordinary run of each piece of long work, all from made-up surfaces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import dapple3d as dapple
import numpy as np
from dapple3d.texturing import Decal, bake
from numpy.typing import NDArray

Array = NDArray[np.float64]
Work = Callable[[dapple.Context], object]


@dataclass(frozen=True)
class Prepared:
    """Work on something that is made anew before each run, because the work changes it."""

    make: Callable[[], Any]
    run: Callable[[Any, dapple.Context], object]

    def ready(self) -> Work:
        """The work on one that is new."""
        made = self.make()
        return lambda context: self.run(made, context)


def torus(around: int, tube: int) -> tuple[Array, NDArray[np.int32]]:
    """A torus of radii 1 and 0.4 with waves on it."""
    u, v = np.meshgrid(np.arange(around), np.arange(tube), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / tube
    r = 1 + (0.4 + 0.05 * np.sin(5 * a) * np.sin(3 * b)) * np.cos(b)
    points = np.stack([r * np.cos(a), r * np.sin(a), 0.4 * np.sin(b)], axis=-1).reshape(-1, 3)
    p, q = u * tube + v, (u + 1) % around * tube + v
    right, up = (u + 1) % around * tube + (v + 1) % tube, u * tube + (v + 1) % tube
    faces = np.concatenate(
        [np.stack([p, q, right], -1).reshape(-1, 3), np.stack([p, right, up], -1).reshape(-1, 3)]
    )
    return points, faces.astype(np.int32)


def sheet(cells: int) -> tuple[Array, NDArray[np.int32], Array]:
    """The unit square with its texture coordinates."""
    line = np.linspace(0, 1, cells + 1)
    x, y = np.meshgrid(line, line)
    points = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    a = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).reshape(-1)
    faces = np.concatenate(
        [
            np.stack([a, a + 1, a + cells + 2], -1),
            np.stack([a, a + cells + 2, a + cells + 1], -1),
        ]
    ).astype(np.int32)
    return points, faces, points[faces][:, :, :2]


def bent(points: Array, amount: float) -> Array:
    """Bent about the y axis."""
    angle = amount * points[:, 0]
    x = np.cos(angle) * points[:, 0] - np.sin(angle) * points[:, 2]
    z = np.sin(angle) * points[:, 0] + np.cos(angle) * points[:, 2]
    return np.stack([x, points[:, 1], z], axis=-1)


def cases(size: float) -> dict[str, Work | Prepared]:
    """The verbs by name."""
    return {**_samplers(size), **_tracking(size), **_after(size), **_refining(size), **_large(size)}


def _samplers(size: float) -> dict[str, Work]:
    n = int(4000 * size)
    surface = dapple.Surface(*torus(200, 80))
    radius = 0.35 * surface.spacing(n)
    plain = [dapple.SampleClass(n // 4), dapple.SampleClass(3 * n // 4)]
    things = [
        dapple.SampleClass(n // 4, radius=1.5 * radius),
        dapple.SampleClass(n // 2, radius=radius),
    ]
    square = dapple.Plane(1, 1)
    samples = dapple.sample(surface, n)
    y, x = np.mgrid[0:200, 0:200] / 200
    picture = np.stack([x, y, 0.5 + 0 * x], axis=-1)
    return {
        "sample": lambda c: dapple.sample(surface, n, context=c),
        "sample, tolerance 1e-6": lambda c: dapple.sample(surface, n, tolerance=1e-6, context=c),
        "sample, the paper's way": lambda c: dapple.sample(surface, n, **dapple.PAPER, context=c),
        "sample_classes": lambda c: dapple.sample_classes(surface, plain, context=c),
        "sample_classes, radii": lambda c: dapple.sample_classes(surface, things, context=c),
        "sample_classes, two stages": lambda c: dapple.sample_classes(
            surface, plain, two_stages=True, context=c
        ),
        "sample, in a plane": lambda c: dapple.sample(square, n, context=c),
        "sample, on a torus": lambda c: dapple.sample(dapple.Torus(), n, context=c),
        "resample, fewer": lambda c: dapple.resample(surface, samples, int(0.9 * n), context=c),
        "resample, many more": lambda c: dapple.resample(surface, samples, 4 * n, context=c),
        "stipple, gray": lambda c: dapple.stippling.stipple(picture[..., 0], n, context=c),
        "stipple, color": lambda c: dapple.stippling.stipple(picture, n, context=c),
    }


def _tracking(size: float) -> dict[str, Work | Prepared]:
    n = int(4000 * size)
    points, faces = torus(200, 80)
    surface = dapple.Surface(points, faces)
    samples = dapple.sample(surface, n)

    def tracker() -> dapple.Tracker:
        return dapple.Tracker(surface, samples)

    near, far = bent(points, 0.05), bent(points, 0.6)
    frames = np.stack([bent(points, 0.05 * k) for k in (1, 2, 3, 2, 1)])
    return {
        "Tracker.advance": Prepared(tracker, lambda t, c: t.advance(near, context=c)),
        "Tracker.advance, far": Prepared(tracker, lambda t, c: t.advance(far, context=c)),
        "Population.advance": Prepared(
            lambda: dapple.Population(surface, samples),
            lambda p, c: p.advance(1.05 * near, context=c),
        ),
        "track_window": lambda c: dapple.track_window(surface, samples, frames, context=c),
        "track_window, closed": lambda c: dapple.track_window(
            surface, samples, frames, closed=True, context=c
        ),
    }


def _after(size: float) -> dict[str, Work]:
    n = int(20000 * size)
    surface = dapple.Surface(*torus(300, 120))
    samples = dapple.sample(surface, n, max_evaluations=3)
    classes = np.arange(n) % 3
    rng = np.random.default_rng(1)
    flat = [rng.random((3000, 2)) for _ in range(5)]
    points, faces, uv = sheet(20)
    ground = dapple.Surface(points, faces)
    few = dapple.sample(ground, 400)
    image = np.ones((64, 64, 4))
    decals = [Decal(image, 0.5 * ground.spacing(400))]
    pixels = int(1000 * size**0.5)
    return {
        "mosaic": lambda c: dapple.mosaic(surface, samples, context=c),
        "progressive_ranks": lambda c: dapple.progressive_ranks(
            samples.positions, classes, context=c
        ),
        "spectrum": lambda c: dapple.spectrum(flat, context=c),
        "surface_spectrum": lambda c: dapple.surface_spectrum(surface, [samples], context=c),
        "texturing.bake": lambda c: bake(ground, uv, few, decals, pixels, pixels, context=c),
    }


def _refining(size: float) -> dict[str, Work]:
    points, faces, uv = sheet(100)
    surface = dapple.Surface(points, faces)
    rng = np.random.default_rng(2)
    pixels = int(400 * size**0.5)
    picture = rng.random((pixels, pixels))
    balls = np.concatenate([rng.random((300, 2)), np.zeros((300, 1))], axis=1)
    longest = 0.003 / size**0.5
    return {
        "refine_edges": lambda c: dapple.refine_edges(surface, longest, context=c),
        "refine_image": lambda c: dapple.refine_image(surface, uv, picture, context=c),
        "refine_obstacles": lambda c: dapple.refine_obstacles(
            surface, balls, np.full(300, 0.02), context=c
        ),
    }


def _large(size: float) -> dict[str, Work]:
    points, faces = torus(int(1000 * size**0.5), int(500 * size**0.5))
    surface = dapple.Surface(points, faces)
    soup = points[faces].reshape(-1, 3)
    loose = np.arange(len(soup), dtype=np.int32).reshape(-1, 3)
    samples = dapple.sample(surface, int(20000 * size), max_evaluations=1)
    at, on = samples.positions, samples.faces
    return {
        "Surface": lambda c: dapple.Surface(points, faces, context=c),
        "Surface, loose faces": lambda c: dapple.Surface(soup, loose, context=c),
        "Surface.deformed": lambda c: surface.deformed(points, context=c),
        "curvature_density": lambda c: dapple.curvature_density(surface, context=c),
        "analyze": lambda c: dapple.analyze(surface, samples, context=c),
        "analyze, points": lambda c: dapple.analyze(surface, at, context=c),
        "evaluate_energy": lambda c: dapple.evaluate_energy(surface, at, on, context=c),
        "Tracker": lambda c: dapple.Tracker(surface, samples, context=c),
        "Population": lambda c: dapple.Population(surface, samples, context=c),
        "sample, many faces": lambda c: dapple.sample(surface, 5000, context=c),
    }
