# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples what scans and assemblies bring, beside plain surfaces; prints two Markdown tables.

Run through benchmarks/specks/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

import dapple3d as dapple
import numpy as np

from benchmarks.compare.tables import say, table
from benchmarks.specks.shapes import (
    OCTAHEDRON,
    TETRAHEDRON,
    Array,
    Mesh,
    around,
    circles,
    joined,
    moved,
    sheet,
    sphere,
)

EACH, WHOLE = 2.0, 4.0  # the goals: times the plain case, an evaluation and a run
VARIATION = 0.008  # beyond what whole numbers ask for


@dataclass
class Sizes:
    body: int = 5  # level of a sphere
    scan: int = 8
    count: int = 5000
    specks: int = 1000
    pixels: int = 512


@dataclass
class Result:
    seconds: float  # of the processor
    evaluations: int
    variation: float
    whole: float
    alpha: float
    converged: bool

    @property
    def each(self) -> float:
        return self.seconds / self.evaluations


Case = Callable[[Sizes, np.random.Generator], Result]


def measured(run: Callable[[], dapple.Samples | dapple.PlanarSamples | dapple.Dots]) -> Result:
    begin = time.process_time()
    report = run().report
    return result_of(report, time.process_time() - begin, report.whole_count_variation)


def result_of(report: dapple.Report, seconds: float, by_whole_numbers: float) -> Result:
    return Result(
        seconds,
        report.evaluations,
        report.capacity_variation,
        by_whole_numbers,
        report.alpha_min,
        report.converged,
    )


def sampled(mesh: Mesh, count: int, density: Array | None = None) -> Result:
    surface = dapple.Surface(*mesh, density=density)
    return measured(lambda: dapple.sample(surface, count))


def evaluated(sizes: Sizes, off: Callable[[Array], Array]) -> Result:
    """Of sites that samples have been moved to, which may be off the surface."""
    surface = dapple.Surface(*sphere(sizes.body))
    samples = dapple.sample(surface, sizes.count)
    places = off(samples.positions)
    begin = time.process_time()
    for _ in range(5):
        dapple.evaluate_energy(surface, places, samples.faces)
    return Result(time.process_time() - begin, 5, 0, 0, 1, True)


def plain(sizes: Sizes, _: np.random.Generator) -> Result:
    return sampled(sphere(sizes.body), sizes.count)


def plain_energy(sizes: Sizes, _: np.random.Generator) -> Result:
    return evaluated(sizes, lambda x: x)


def with_specks(part: Mesh, size: float) -> Case:
    def case(sizes: Sizes, random: np.random.Generator) -> Result:
        specks = [moved(part, size, place) for place in around(sizes.specks, random)]
        return sampled(joined([sphere(sizes.body), *specks]), sizes.count)

    return case


def thirty(sizes: Sizes, random: np.random.Generator) -> Result:
    specks = [moved(sphere(2), 0.003, place) for place in around(30, random)]
    return sampled(joined([sphere(sizes.body), *specks]), sizes.count)


def far(distance: float) -> Case:
    def case(sizes: Sizes, _: np.random.Generator) -> Result:
        body = sphere(sizes.body)
        return sampled(joined([body, moved(body, 1, np.array([distance, 0, 0]))]), sizes.count)

    return case


def stray(sizes: Sizes, _: np.random.Generator) -> Result:
    speck = moved(TETRAHEDRON, 0.002, np.array([1e6, 0, 0]))
    return sampled(joined([sphere(sizes.body), speck]), sizes.count)


def masked(share: float) -> Case:
    def case(sizes: Sizes, _: np.random.Generator) -> Result:
        vertices, faces = sphere(sizes.body)
        density = (vertices[:, 2] > 1 - 2 * share).astype(np.float64)
        return sampled((vertices, faces), sizes.count, density)

    return case


def off_surface(low: float, high: float) -> Case:
    def case(sizes: Sizes, random: np.random.Generator) -> Result:
        return evaluated(sizes, lambda x: x * random.uniform(low, high, (len(x), 1)))

    return case


DISTANCE: dict[str, tuple[Case, Case]] = {
    "30 specks of 0.003": (thirty, plain),
    "specks of 8 faces": (with_specks(OCTAHEDRON, 0.01), plain),
    "specks of 4 faces": (with_specks(TETRAHEDRON, 0.002), plain),
    "a stray speck": (stray, plain),
    "far parts, 1e6": (far(1e6), far(3)),
    "far parts, 1e8": (far(1e8), far(3)),
    "density on half": (masked(0.5), plain),
    "density on 2 %": (masked(0.02), plain),
    "sites off the surface": (off_surface(1, 1.5), plain_energy),
    "sites far off": (off_surface(1, 100), plain_energy),
    "sites at the center": (off_surface(1e-3, 1e-3), plain_energy),
    "sites near the center": (off_surface(0, 0.05), plain_energy),
}


def scan(noise: float) -> Case:
    def case(sizes: Sizes, random: np.random.Generator) -> Result:
        vertices, faces = sphere(sizes.scan)
        edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
        rough = vertices * (1 + noise * edge * random.normal(size=(len(vertices), 1)))
        return sampled((rough, faces), sizes.count // 10)

    return case


def tracked(noise: float) -> Case:
    def case(sizes: Sizes, random: np.random.Generator) -> Result:
        vertices, faces = sphere(sizes.body)
        surface = dapple.Surface(vertices, faces)
        samples = dapple.sample(surface, sizes.count // 10)
        tracker = dapple.Tracker(surface, samples)
        jitter = noise * samples.report.spacing
        begin = time.process_time()
        for frame in range(4):
            waves = vertices * (1 + 0.01 * np.sin(3 * vertices[:, :1] + frame))
            report = tracker.advance(waves + jitter * random.normal(size=vertices.shape)).report
        return result_of(report, time.process_time() - begin, 0)

    return case


def raster(values: Callable[[np.random.Generator, tuple[int, int]], Array]) -> Case:
    def case(sizes: Sizes, random: np.random.Generator) -> Result:
        side = sizes.pixels // 2
        plane = dapple.Plane(1, 1, density=values(random, (side, side)))
        return measured(lambda: dapple.sample(plane, sizes.count))

    return case


def picture(*, lines: bool) -> Case:
    def case(sizes: Sizes, random: np.random.Generator) -> Result:
        middle = np.hypot(*(np.indices((sizes.pixels,) * 2) / sizes.pixels - 0.5))
        image = 1 - circles(sizes.pixels, random) if lines else np.clip(middle, 0, 1)
        return measured(lambda: dapple.stipple(image, sizes.count))

    return case


def thin(thickness: float) -> Case:
    return lambda sizes, _: sampled(sheet(4 * 5 * sizes.body, thickness), sizes.count // 2)


SMOOTH = raster(lambda _, shape: 1 + np.indices(shape).sum(0) / sum(shape))
NOISE: dict[str, tuple[Case, Case]] = {
    "scan, noise of 2 edges": (scan(2), scan(0)),
    "jittered frames, 3 %": (tracked(0.03), tracked(0)),
    "raster of noise, 1:1e4": (raster(lambda r, shape: 10 ** r.uniform(-4, 0, shape)), SMOOTH),
    "lognormal raster": (raster(lambda r, shape: np.exp(r.normal(size=shape))), SMOOTH),
    "line art of one pixel": (picture(lines=True), picture(lines=False)),
    "a sheet of 0.001": (thin(0.001), thin(0)),
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="benchmarks/specks/run.sh", description=__doc__)
    parser.add_argument("--only", choices=[*DISTANCE, *NOISE], help="one row")
    parser.add_argument("--small", action="store_true", help="few faces and samples: for tests")
    given = parser.parse_args()
    sizes = Sizes(3, 4, 300, 50, 64) if given.small else Sizes()
    head = ("case", "seconds", "ratio", "evaluations", "variation", "by whole numbers", "alpha min")
    for title, cases in ("Specks and distance", DISTANCE), ("Noise", NOISE):
        chosen = {name: pair for name, pair in cases.items() if given.only in (None, name)}
        if not chosen:
            continue
        rows = [row(name, *pair, sizes, each=cases is DISTANCE) for name, pair in chosen.items()]
        print(f"\n## {title}\n")
        print(table((*head, "converged", "goals"), rows))
    print(f"\nSeconds and ratios are of the processor, {sizes.count} samples. Goals: specks and")
    print(
        f"distance {EACH:g} times the plain case an evaluation, noise {WHOLE:g} times a whole run;"
    )
    print(f"variation {VARIATION} beyond what whole numbers ask for, or not converged.")


def row(name: str, case: Case, plain_case: Case, sizes: Sizes, *, each: bool) -> list[str]:
    say(name)
    beside = plain_case(sizes, np.random.default_rng(0))
    found = case(sizes, np.random.default_rng(0))
    ratio = found.each / beside.each if each else found.seconds / beside.seconds
    goals = {
        "time": ratio <= (EACH if each else WHOLE),
        "variation": found.variation <= VARIATION + found.whole or not found.converged,
    }
    missed = ", ".join(goal for goal, met in goals.items() if not met)
    return [
        *(name, f"{found.seconds:.2f}", f"{ratio:.1f}", f"{found.evaluations}"),
        *(f"{found.variation:.4f}", f"{found.whole:.4f}", f"{found.alpha:.2f}"),
        *("yes" if found.converged else "no", f"missed: {missed}" if missed else "met"),
    ]


if __name__ == "__main__":
    main()
