# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of samples on surfaces that move."""

from typing import Any

import dapple3d as dapple
import exact
import numpy as np
from byte_runs import BOX, CASES, RADII, SPHERE, TORUS, WAVY, Case, Run, case
from shapes import Mesh

FRAMES = 20


def twists(run: Run, mesh: Mesh, count: int = FRAMES, closed: bool = False) -> list[np.ndarray]:
    half = (count + 1) / 2
    steps = [half - abs(frame - half) if closed else frame for frame in range(1, count + 1)]
    return [run.given(exact.twisted(mesh[0], 0.15 * step)) for step in steps]


def tracked(mesh: Mesh, count: int, density: Any = None, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(mesh, density)
        start = run.sample(surface, count)
        tracker = dapple.Tracker(surface, start, threads=run.threads, **options)
        for vertices in twists(run, mesh):
            run.samples(tracker.advance(vertices))

    return run_it


CASES |= {
    "track_torus": tracked(TORUS, 400),
    "track_density": tracked(WAVY, 250, exact.slope(WAVY)),
    "track_box": tracked(BOX, 250),
    "track_two_bodies": tracked(exact.two_bodies(), 250),
    "track_euclidean": tracked(TORUS, 250, cells="euclidean"),
    "track_line_search": tracked(TORUS, 250, method="line_search"),
    "track_sticky": tracked(TORUS, 250, stickiness=2.0, pattern_strength=0.5),
}


@case
def track_classes(run: Run) -> None:
    surface = run.surface(TORUS)
    start = dapple.sample_classes(surface, RADII, threads=run.threads)
    tracker = dapple.Tracker(surface, start, classes=RADII, threads=run.threads)
    for vertices in twists(run, TORUS):
        run.samples(tracker.advance(vertices))


@case
def track_resumed(run: Run) -> None:
    surface = run.surface(SPHERE)
    tracker = dapple.Tracker(surface, run.sample(surface, 200), threads=run.threads)
    frames = twists(run, SPHERE, 6)
    tracker.resume(frames[2], tracker.samples)
    for vertices in frames[3:]:
        run.samples(tracker.advance(vertices))


def window(mesh: Mesh, closed: bool, density: Any = None) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(mesh, density)
        start, frames = run.sample(surface, 200), twists(run, mesh, 10, closed)
        for samples in dapple.track_window(
            surface, start, frames, closed=closed, threads=run.threads
        ):
            run.samples(samples)

    return run_it


CASES |= {
    "window_open": window(TORUS, False),
    "window_closed": window(TORUS, True),
    "window_density": window(BOX, False, exact.slope(BOX)),
}


@case
def window_pieces(run: Run) -> None:
    surface = run.surface(TORUS)
    start = dapple.sample_classes(surface, RADII, seed=1, threads=run.threads)
    frames = twists(run, TORUS, 10)
    for samples in dapple.track_pieces(
        surface, start, frames, piece=4, overlap=2, classes=RADII, threads=run.threads
    ):
        run.samples(samples)


def populated(mesh: Mesh, growth: list[float], **options: Any) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(mesh)
        start = run.sample(surface, 200)
        population = dapple.Population(surface, start, threads=run.threads, **options)
        for much in growth:
            run.samples(population.advance(run.given(exact.grown(mesh[0], much))))

    return run_it


CASES |= {
    "population_grows": populated(TORUS, [frame / 16 for frame in range(1, FRAMES + 1)]),
    "population_grows_and_shrinks": populated(
        BOX, [(8 - abs(8 - frame)) / 8 for frame in range(1, FRAMES + 1)], fade=4
    ),
}


@case
def population_classes(run: Run) -> None:
    surface = run.surface(TORUS)
    start = dapple.sample_classes(surface, RADII, seed=1, threads=run.threads)
    population = dapple.Population(surface, start, classes=RADII, fade=3, threads=run.threads)
    for frame in range(1, 7):
        run.samples(population.advance(run.given(exact.grown(TORUS[0], frame / 8))))


@case
def population_faces(run: Run) -> None:
    """A torus that grows, of other triangles in each frame."""
    surface = run.surface(TORUS)
    population = dapple.Population(surface, run.sample(surface, 200), fade=3, threads=run.threads)
    for frame in range(1, 7):
        vertices, faces = exact.torus(around=8 + frame % 3, tube=4 + frame % 2)
        vertices, faces = run.given(exact.grown(vertices, frame / 16)), run.given(faces)
        run.samples(population.advance(vertices, faces))
