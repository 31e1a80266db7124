# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of what is made of surfaces and samples, and measured on them."""

from typing import Any

import dapple3d as dapple
import exact
import numpy as np
from byte_cases_frames import twists
from byte_runs import BOX, CASES, SPHERE, TORUS, WAVY, Case, Run, case, steps
from shapes import Mesh

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
    "remesh_adapted": remeshed(TORUS, 100, adaptive=True),
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
def remesh_sequence(run: Run) -> None:
    vertices, faces = BOX
    sequence = dapple.MeshSequence(run.surface(BOX), 300, threads=run.threads)
    for frame in range(1, 4):
        dented = vertices.copy()
        dented[:, 2] -= 0.1 * frame * np.maximum(vertices[:, 0] - 0.3, 0.0)
        found = sequence.advance(dapple.Surface(dented, faces[: len(faces) - frame]))
        run.keep(source_faces=found.mesh.source_faces, barycentric=found.mesh.barycentric)
        run.keep(faces=found.mesh.faces, ids=found.ids)


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
def refine_outside_in_poses(run: Run) -> None:
    vertices, faces = BOX
    shifted = vertices + run.given([0.31, 0.27, 0.23])
    both = (np.vstack([vertices, shifted]), np.vstack([faces, faces + len(vertices)]))
    poses = [
        run.given(np.vstack([vertices, vertices + offset]))
        for offset in ([0.5, 0.4, 0.1], [0.2, -0.3, 0.35])
    ]
    surface = run.surface(both)
    keep_refined(run, dapple.refine_outside(surface, 0.25, openness=0.05, poses=poses))


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
