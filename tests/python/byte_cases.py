# SPDX-License-Identifier: GPL-3.0-or-later
"""What test_same_bytes.py computes: named cases, and the hashes of what each gave and was given."""

import hashlib
import json
from collections.abc import Callable
from typing import Any

import dapple3d as dapple
import exact
import numpy as np
from checks import ARRAYS
from shapes import Mesh

TIMES = ("seconds", "profile")
COUNTS = ("births", "deaths")  # the ids, which are recorded, determine them
FRAMES = 20


class Run:
    """Collects the bytes of a case; the same name again goes on where it was."""

    def __init__(self, threads: int = 1) -> None:
        self.threads = threads
        self._hashes: dict[str, Any] = {}

    def hashes(self) -> dict[str, str]:
        return {name: found.hexdigest()[:16] for name, found in self._hashes.items()}

    def _add(self, name: str, content: bytes) -> None:
        self._hashes.setdefault(name, hashlib.sha256()).update(content)

    def keep(self, **arrays: Any) -> None:
        for name, value in arrays.items():
            array = np.ascontiguousarray(value)
            self._add(name, f"{array.dtype.str}{array.shape}".encode() + array.tobytes())

    def given(self, array: Any) -> Any:
        self.keep(inputs=array)
        return array

    def surface(self, mesh: Mesh, density: np.ndarray | None = None, **options: Any):
        for array in (*mesh, density):
            if array is not None:
                self.given(array)
        return dapple.Surface(*mesh, density, **options)

    def sample(self, surface: dapple.Surface, count: int = 300, **options: Any):
        """Samples that a case begins with."""
        samples = dapple.sample(surface, count, threads=self.threads, **options)
        self.keep(start=samples.faces)
        self.keep(start=samples.barycentric)
        return samples

    def samples(self, samples: dapple.Samples) -> None:
        self.keep(**{name: getattr(samples, name) for name in (*ARRAYS, "fade")})
        self.report(samples.report)

    def report(self, report: dapple.Report) -> None:
        figures = _told(report.to_dict())
        figures["classes"] = [_told(figure) for figure in figures["classes"]]
        self._add("report", json.dumps(figures, sort_keys=True).encode())


def _told(figures: dict[str, Any]) -> dict[str, Any]:
    """Without what other arrays tell; a thin share only where something is thin."""
    left_out = (*TIMES, *COUNTS, *(() if figures["thin_share"] else ("thin_share",)))
    return {name: value for name, value in figures.items() if name not in left_out}


Case = Callable[[Run], None]
CASES: dict[str, Case] = {}


def case(function: Case) -> Case:
    CASES[function.__name__] = function
    return function


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


def steps(mesh: Mesh) -> np.ndarray:
    """A density at the faces that jumps."""
    return np.where(mesh[0][mesh[1][:, 0], 0] > 0, 4.0, 1.0)


def corners(mesh: Mesh) -> np.ndarray:
    return exact.slope(mesh)[mesh[1]] * steps(mesh)[:, None]


TORUS, WAVY, SPHERE, BOX = exact.torus(), exact.wavy(), exact.sphere(), exact.box()
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


RADII = [dapple.SampleClass(count, radius=radius) for count, radius in ((15, 0.12), (200, 0.03))]
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


# --- frames


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


# --- mosaic, remesh, ranks


TILES = [
    *("vertices", "corners", "starts", "sites", "classes", "faces", "sides"),
    *("cell_areas", "areas", "parts", "loops"),
]


def tiled(mesh: Mesh, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        surface = run.surface(mesh)
        found = dapple.mosaic(surface, run.sample(surface), threads=run.threads, **options)
        run.keep(**{name: getattr(found, name) for name in TILES})

    return run_it


CASES |= {
    "mosaic": tiled(TORUS, grout=0.01),
    "mosaic_box": tiled(BOX, grout=0.02, thickness=0.05, merge=False),
    "mosaic_insets": tiled(TORUS, insets=[0.001 * (k % 10) for k in range(300)]),
    "mosaic_euclidean": tiled(WAVY, cells="euclidean", shortest_edge=0.0),
}


def remeshed(mesh: Mesh, count: int, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        found = dapple.remesh(run.surface(mesh), count, threads=run.threads, **options)
        names = ("vertices", "faces", "source_faces", "barycentric", "features", "lines")
        run.keep(**{name: getattr(found, name) for name in names})

    return run_it


def on_lines(mesh: Mesh, count: int, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        found = dapple.sample_lines(run.surface(mesh), count, **options)
        run.keep(faces=found.samples.faces, barycentric=found.samples.barycentric)
        run.keep(tangents=found.tangents, lines=found.lines)

    return run_it


def in_pairs(mesh: Mesh, count: int, **options: Any) -> Case:
    def run_it(run: Run) -> None:
        found = dapple.sample_symmetric(run.surface(mesh), count, threads=run.threads, **options)
        run.keep(faces=found.samples.faces, barycentric=found.samples.barycentric)
        run.keep(mirror=found.mirror)

    return run_it


CASES |= {
    "symmetric": in_pairs(TORUS, 301),
    "symmetric_oblique": in_pairs(TORUS, 200, normal=(1.0, 2.0, 0.0), max_mirror_error=0.1, seed=3),
    "lines": on_lines(BOX, 50, corners=True),
    "lines_natural": on_lines(BOX, 50, line_spacing="natural", seed=2),
    "remesh": remeshed(TORUS, 500),
    "remesh_box": remeshed(BOX, 300),
    "remesh_smooth": remeshed(BOX, 300, feature_angle=180),
    "remesh_near": remeshed(TORUS, 100, max_distance=0.02),
}


@case
def remesh_moving(run: Run) -> None:
    surface = run.surface(TORUS)
    tracker = dapple.MeshTracker(
        surface, dapple.remesh(surface, 300, threads=run.threads), threads=run.threads
    )
    for frame in twists(run, TORUS, 6)[1:]:
        moved = tracker.advance(frame)
        run.keep(source_faces=moved.source_faces, barycentric=moved.barycentric)


@case
def ranks(run: Run) -> None:
    points = dapple.sample(run.surface(TORUS), 800, threads=run.threads).positions
    run.keep(
        ranks=dapple.progressive_ranks(points),
        classes=dapple.progressive_ranks(points, np.arange(800) % 3),
        nearest=dapple.nearest_distances(points),
        away=dapple.away_from_neighbors(points),
    )


# --- refine_*


def keep_refined(run: Run, refined: dapple.Refined) -> None:
    surface = refined.surface
    run.keep(
        vertices=surface.vertices,
        faces=surface.faces,
        parents=refined.parents,
        barycentric=refined.barycentric,
    )
    if surface.density is not None:
        run.keep(density=surface.density)
    samples = dapple.sample(surface, 200, threads=run.threads)
    run.keep(samples=refined.to_original(samples).barycentric)


@case
def refine_edges(run: Run) -> None:
    keep_refined(run, dapple.refine_edges(run.surface(SPHERE, exact.slope(SPHERE)), 0.15))


@case
def refine_edges_of_some_faces(run: Run) -> None:
    lengths = run.given(np.where(steps(TORUS) > 1, 0.1, np.inf))
    keep_refined(run, dapple.refine_edges(run.surface(TORUS), lengths))


@case
def refine_image(run: Run) -> None:
    mesh = exact.sheet()
    uv, image = run.given(exact.flat_uv(mesh)), run.given(exact.picture())
    keep_refined(run, dapple.refine_image(run.surface(mesh), uv, image))


@case
def refine_image_repeated(run: Run) -> None:
    mesh = exact.sheet()
    uv, image = run.given(2 * exact.flat_uv(mesh)), run.given(exact.picture(8, 8))
    keep_refined(run, dapple.refine_image(run.surface(mesh), uv, image, repeat=True))


@case
def refine_obstacles(run: Run) -> None:
    surface = run.surface(TORUS)
    radii = run.given([0.05 + 0.01 * k for k in range(10)])
    areas = steps(TORUS) > 1
    points = run.given(TORUS[0][::50][:10])
    keep_refined(run, dapple.refine_obstacles(surface, points, radii, areas=areas))


@case
def refine_outside(run: Run) -> None:
    vertices, faces = BOX
    shifted = vertices + run.given([0.31, 0.27, 0.23])
    both = (np.vstack([vertices, shifted]), np.vstack([faces, faces + len(vertices)]))
    keep_refined(run, dapple.refine_outside(run.surface(both), 0.25, openness=0.0))


@case
def solids(run: Run) -> None:
    vertices, faces = TORUS
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float64)
    points = run.given((0.4 * corners + vertices[::31, None]).reshape(-1, 3))
    counts = [8] * (len(points) // 8)
    run.keep(
        reached=dapple.reached_by_solids(vertices, faces, points, counts, margin=0.05),
        pairs=dapple.touching_solids(points, counts),
    )


@case
def seen_from(run: Run) -> None:
    vertices, faces = TORUS
    eye = run.given(np.array([3.0, 0.5, 1.0, 1.0]))
    run.keep(seen=dapple.seen_from(run.surface((vertices, faces)), eye, vertices))


# --- looking at surfaces and samples


@case
def curvature(run: Run) -> None:
    for mesh in (WAVY, BOX, exact.sheet()):
        surface = run.surface(mesh)
        run.keep(
            curvedness=dapple.curvedness(surface), rough=dapple.curvedness(surface, smoothing=0)
        )
        run.keep(density=dapple.curvature_density(surface, exponent=0.7))


@case
def spectrum(run: Run) -> None:
    runs = [
        dapple.sample(dapple.Torus(), 250, seed=seed, threads=run.threads).positions
        for seed in range(2)
    ]
    found = dapple.spectrum(runs, threads=run.threads)
    run.keep(
        points=np.stack(runs),
        periodogram=found.periodogram,
        mean=found.radial.mean,
        anisotropy=found.radial.anisotropy,
    )


@case
def surface_spectrum(run: Run) -> None:
    surface = run.surface(TORUS, exact.slope(TORUS))
    start = run.sample(surface, 400)
    found = dapple.surface_spectrum(surface, start, radius=4.0, bins=64, threads=run.threads)
    run.keep(
        differentials=found.differentials,
        power=found.power,
        mean=found.radial_power.mean,
        anisotropy=found.radial_power.anisotropy,
    )


@case
def analysis(run: Run) -> None:
    surface = run.surface(exact.two_bodies())
    points = run.given(surface.vertices[::3] * 1.01)
    run.report(dapple.analyze(surface, points))
    run.report(dapple.analyze(surface, run.sample(surface), cells="euclidean"))
    near = dapple.project(surface, points)
    run.keep(positions=near.positions, faces=near.faces, barycentric=near.barycentric)
    run.keep(distances=near.distances)


@case
def energy(run: Run) -> None:
    surface = run.surface(WAVY, exact.slope(WAVY))
    start = run.sample(surface)
    for cells in ("connected", "euclidean"):
        found = dapple.evaluate_energy(surface, start.positions, start.faces, cells=cells)
        run.keep(total=[found.total, found.cvt, found.capacity_term, found.normalized])
        run.keep(capacities=found.capacities, masses=found.masses, areas=found.areas)
        run.keep(gradient=found.gradient)


@case
def decals(run: Run) -> None:
    mesh = exact.sheet()
    surface, uv = run.surface(mesh), run.given(exact.flat_uv(mesh))
    texels = dapple.texels(surface, uv, 48, 64)
    start = run.sample(surface, 60)
    tangents = np.broadcast_to([1.0, 0.5, 0.0], (60, 3))
    owners, places = dapple.decal_cover(surface, start, np.full(60, 0.05), tangents, texels)
    run.keep(faces=texels.faces, barycentric=texels.barycentric, owners=owners, places=places)


def hashes_of(name: str, threads: int = 1) -> dict[str, str]:
    run = Run(threads)
    CASES[name](run)
    return run.hashes()
