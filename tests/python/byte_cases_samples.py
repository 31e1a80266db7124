# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of samples on still surfaces and in the plane."""

from collections.abc import Callable
from typing import Any

import dapple3d as dapple
import exact
import numpy as np
from byte_runs import BOX, CASES, RADII, SPHERE, TORUS, WAVY, Case, Run, case, steps
from shapes import Mesh

# --- sample


def sampled(
    mesh: Mesh,
    count: int,
    density: Any = None,
    at: str = "vertices",
    weld: float | None = 1e-6,
    **options: Any,
) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(mesh, density, density_at=at, weld=weld)
        run.samples(dapple.sample(surface, count, threads=run.threads, **options))

    return run_it


def corners(mesh: Mesh) -> np.ndarray:
    return exact.slope(mesh)[mesh[1]] * steps(mesh)[:, None]


CASES |= {
    "sample_sphere": sampled(SPHERE, 600),
    "sample_sphere_seed_7": sampled(SPHERE, 600, seed=7),
    "sample_sphere_large_seed": sampled(SPHERE, 300, seed=2**64 - 1),
    "sample_random_start": sampled(TORUS, 400, start="random", seed=1),
    "sample_torus_density": sampled(TORUS, 500, exact.slope(TORUS), seed=2),
    "sample_density_at_faces": sampled(TORUS, 400, steps(TORUS), "faces", seed=3),
    "sample_density_at_corners": sampled(TORUS, 400, corners(TORUS), "corners", seed=4),
    "sample_no_density_in_one_half": sampled(TORUS, 300, steps(TORUS) - 1, "faces"),
    "sample_wavy": sampled(WAVY, 1500),
    "sample_box": sampled(BOX, 500),
    "sample_split_box": sampled(exact.split(BOX), 300),
    "sample_split_box_not_welded": sampled(exact.split(exact.box(1)), 300, weld=None),
    "sample_soup": sampled(exact.soup(), 500),
    "sample_two_bodies": sampled(exact.two_bodies(), 500),
    "sample_cube": sampled(exact.cube(), 700),
    "sample_few": sampled(WAVY, 12),
    "sample_euclidean": sampled(WAVY, 500, cells="euclidean"),
    "sample_euclidean_soup": sampled(exact.soup(), 300, cells="euclidean"),
    "sample_line_search": sampled(SPHERE, 400, method="line_search"),
    "sample_paper": sampled(TORUS, 300, **dapple.PAPER),
    "sample_lattice": sampled(WAVY, 1500, capacity_weight=1.0, repulsion_weight=0.0),
    "sample_weights": sampled(BOX, 300, capacity_weight=80.0, repulsion_weight=0.0, tolerance=1e-4),
}


@case
def sample_locked(run: Run) -> None:
    surface = run.surface(TORUS)
    locked = run.sample(surface, 40, seed=5)
    run.samples(dapple.sample(surface, 400, locked=locked, threads=run.threads))


# --- sample_classes


def classed(*classes: Any, density: Any = None, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(TORUS, density)
        for one in classes:
            if isinstance(one, dapple.SampleClass) and one.density is not None:
                run.given(one.density)
        run.samples(dapple.sample_classes(surface, classes, threads=run.threads, **options))

    return run_it


SLOPED = [dapple.SampleClass(150, density=exact.slope(TORUS)), dapple.SampleClass(250)]
CASES |= {
    "classes_plain": classed(200, 100, 50),
    "classes_radii": classed(*RADII, seed=1),
    "classes_two_stages": classed(150, 150, two_stages=True),
    "classes_density": classed(*SLOPED, density=exact.slope(TORUS)[::-1].copy()),
    "classes_euclidean": classed(150, 100, cells="euclidean", union_weight=0.5),
}


@case
def classes_locked(run: Run) -> None:
    surface = run.surface(BOX)
    locked = run.sample(surface, 20)
    classes = [dapple.SampleClass(60, locked=locked, radius=0.05), dapple.SampleClass(150)]
    run.samples(dapple.sample_classes(surface, classes, threads=run.threads))


# --- resample


def resampled(mesh: Mesh, count: int, density: Any = None, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(mesh)
        start = run.sample(surface, 300)
        if density is not None:
            surface = surface.with_density(run.given(density))
        run.samples(dapple.resample(surface, start, count, threads=run.threads, **options))

    return run_it


CASES |= {
    "resample_fewer": resampled(TORUS, 200),
    "resample_more": resampled(TORUS, 450, seed=3),
    "resample_density": resampled(TORUS, 300, exact.slope(TORUS)),
    "resample_two_bodies": resampled(exact.two_bodies(), 350, cells="euclidean"),
}


# --- relax


def relaxed(density: Any, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(TORUS)
        start = run.sample(surface, 400)
        after = surface.with_density(run.given(density))
        changed = dapple.changed_faces(surface, after)
        run.samples(dapple.relax(after, start, changed, threads=run.threads, **options))

    return run_it


CASES |= {
    "relax_more": relaxed(exact.spot(TORUS, 3.0), seed=2),
    "relax_fewer": relaxed(exact.spot(TORUS, 0.25)),
    "relax_count": relaxed(exact.spot(TORUS, 2.0), count=404, locked=np.arange(0, 400, 7)),
}


# --- pictures and planes


def stippled(image: np.ndarray, count: int, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        dots = dapple.stipple(run.given(image), count, threads=run.threads, **options)
        run.keep(positions=dots.positions, classes=dots.classes, radius=dots.radius)
        run.report(dots.report)

    return run_it


CASES |= {
    "stipple_gray": stippled(exact.picture(), 500),
    "stipple_gray_8_bits": stippled((255 * exact.picture()).astype(np.uint8), 300, seed=1),
    "stipple_color": stippled(exact.colored(), 400),
    "stipple_color_counts": stippled(exact.colored(), 140, counts=[20] * 7, radius=0.4),
}


@case
def inks(run: Run) -> None:
    separated = dapple.separate_inks(np.moveaxis(run.given(exact.colored()), 2, 0))
    run.keep(inks=separated, mixed=dapple.mix_inks(separated))


def planar(make: Callable[[Run], dapple.FlatDomain], count: int, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        domain = make(run)
        samples = dapple.sample(domain, count, threads=run.threads, **options)
        run.keep(positions=samples.positions, classes=samples.classes)
        run.report(samples.report)
        energy = dapple.evaluate_energy(domain, samples.positions)
        run.keep(capacities=energy.capacities, gradient=energy.gradient)

    return run_it


def polygon(run: Run) -> dapple.FlatDomain:
    outline = run.given([(0, 0), (3, 0), (3, 2), (1.5, 0.75), (0, 2)])
    hole = run.given([(2.25, 0.25), (2.625, 0.25), (2.625, 0.75), (2.25, 0.75)])
    return dapple.Plane.polygon(outline, [hole])


def plane(run: Run) -> dapple.FlatDomain:
    return dapple.Plane(4, 3, run.given(0.1 + exact.picture()))


def torus(run: Run) -> dapple.FlatDomain:
    return dapple.Torus(run.given(0.1 + exact.picture(16, 16)))


CASES |= {
    "plane": planar(lambda _: dapple.Plane(3, 2), 400),
    "plane_density": planar(plane, 400, seed=1),
    "plane_polygon": planar(polygon, 300),
    "plane_torus": planar(lambda _: dapple.Torus(), 400),
    "plane_torus_density": planar(torus, 300, seed=2),
    "plane_torus_euclidean": planar(lambda _: dapple.Torus(), 200, cells="euclidean"),
}


@case
def plane_classes(run: Run) -> None:
    samples = dapple.sample_classes(dapple.Torus(), [150, 100, 50], threads=run.threads)
    run.keep(positions=samples.positions, classes=samples.classes)
    run.report(samples.report)
