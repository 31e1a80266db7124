# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds for every mesh, and what no scale, turn, shift or order of faces changes.

The same few meshes each time; `--hypothesis-profile=thorough` looks at many new ones.
"""

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from checks import check_samples, is_on_density, same_bytes

pytest.importorskip("hypothesis")

import nasty
from hypothesis import assume, given
from hypothesis import strategies as st

SAME = 1e-6  # relative tolerance of values that are equal up to rounding


def surface_of(mesh: shapes.Mesh, density: tuple[np.ndarray | None, str]) -> dapple.Surface:
    values, where = density
    try:
        return dapple.Surface(*mesh, values, density_at=where)
    except dapple.SurfaceError as error:
        assume("no area" not in str(error) and "density is 0" not in str(error))
        raise


@given(st.data())
def test_samples_of_any_mesh_are_samples(data):
    mesh = data.draw(nasty.meshes())
    surface = surface_of(mesh, data.draw(nasty.densities(mesh)))
    count = data.draw(st.sampled_from([1, 2, 7, 40]), label="count")
    options = {"seed": data.draw(st.integers(0, 99), label="seed"), "max_evaluations": 12}
    samples = dapple.sample(surface, count, threads=1, **options)
    assert len(samples) == count
    check_samples(surface, samples)
    assert np.isfinite(samples.report.energies).all()
    assert (np.diff(samples.report.energies) <= 0).all()
    assert same_bytes(samples, dapple.sample(surface, count, threads=2, **options))
    energy = dapple.evaluate_energy(surface, samples.positions, samples.faces)
    assert energy.capacities.min() >= 0
    assert is_on_density(surface, samples).all()


@given(st.data())
def test_trackers_on_any_mesh_keep_their_samples(data):
    vertices, faces = data.draw(nasty.meshes())
    surface = surface_of((vertices, faces), (None, "vertices"))
    samples = dapple.sample(surface, 12, max_evaluations=4)
    random = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1), label="motion"))
    size = np.ptp(vertices, axis=0).max()
    moved = vertices + random.normal(0, 0.02 * size, vertices.shape)
    tracker = dapple.Tracker(surface, samples, threads=1)
    after = tracker.advance(moved)
    check_samples(tracker.surface, after)
    assert np.array_equal(after.ids, samples.ids)
    again = dapple.Tracker(surface, samples, threads=2).advance(moved)
    assert same_bytes(again, after)


# ---- what stays the same ----

BODIES = {
    "torus": shapes.torus(12, 8),
    "grid": shapes.grid(5),
    "split": nasty.split(np.random.default_rng(0), 6),
    "hat": nasty.hat(np.random.default_rng(2), 5),
    "cube": nasty.cube(np.random.default_rng(0), 1),
}


class Place:
    """Another place, size and order of the faces for a mesh."""

    def __init__(self, data: st.DataObject, faces: int) -> None:
        random = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1), label="turn"))
        self.scale = 10.0 ** data.draw(st.integers(-6, 6), label="scale")
        self.turn = nasty.turned(random)
        self.shift = data.draw(st.sampled_from([0.0, 1.0, 1e3]), label="shift") * random.normal(
            size=3
        )
        self.order = random.permutation(faces)

    def of(self, points: np.ndarray) -> np.ndarray:
        return self.scale * (points @ self.turn.T + self.shift)

    def mesh(self, mesh: shapes.Mesh) -> shapes.Mesh:
        return self.of(mesh[0]), mesh[1][self.order]

    def faces(self, faces: np.ndarray) -> np.ndarray:
        return np.argsort(self.order)[faces]


def density_of(data: st.DataObject, vertices: np.ndarray) -> np.ndarray | None:
    if not data.draw(st.booleans(), label="with a density"):
        return None
    return 1.5 + np.sin(3 * vertices[:, 0])


@given(st.data())
def test_energy_and_capacities_are_those_of_the_shape(data):
    name = data.draw(st.sampled_from(sorted(BODIES)), label="body")
    mesh = BODIES[name]
    density = density_of(data, mesh[0])
    seed = data.draw(st.integers(0, 2**32 - 1), label="sites")
    positions, faces = shapes.random_points(mesh, 25, seed)
    place = Place(data, len(mesh[1]))
    here = dapple.evaluate_energy(dapple.Surface(*mesh, density), positions, faces)
    surface = dapple.Surface(*place.mesh(mesh), density)
    there = dapple.evaluate_energy(surface, place.of(positions), place.faces(faces))
    assert there.normalized == pytest.approx(here.normalized, rel=SAME)
    for name in ("areas", "capacities"):
        one, other = getattr(here, name), getattr(there, name)
        np.testing.assert_allclose(other / other.sum(), one / one.sum(), atol=SAME / len(one))


@given(st.data())
def test_measures_of_samples_are_those_of_the_shape(data):
    mesh = BODIES[data.draw(st.sampled_from(sorted(BODIES)), label="body")]
    density = density_of(data, mesh[0])
    surface = dapple.Surface(*mesh, density)
    samples = dapple.sample(surface, 30, seed=3, max_evaluations=6)
    place = Place(data, len(mesh[1]))
    moved = dapple.Surface(*place.mesh(mesh), density)
    report = dapple.analyze(
        moved, dapple.Samples(moved, place.faces(samples.faces), samples.barycentric)
    )
    for name in ("alpha_min", "alpha_mean", "capacity_variation", "energy", "bond_order"):
        expected = getattr(samples.report, name)
        assert getattr(report, name) == pytest.approx(expected, rel=SAME, abs=SAME), name


@given(st.data())
def test_slides_of_tracked_samples_are_those_of_the_shape(data):
    mesh = BODIES[data.draw(st.sampled_from(["torus", "grid", "split"]), label="body")]
    samples = dapple.sample(dapple.Surface(*mesh), 30, seed=3)
    place = Place(data, len(mesh[1]))
    moved = dapple.Surface(*place.mesh(mesh))
    there = dapple.Samples(moved, place.faces(samples.faces), samples.barycentric)
    after = shapes.bent(mesh[0], 0.3)
    one = dapple.Tracker(dapple.Surface(*mesh), samples).advance(after)
    other = dapple.Tracker(moved, there).advance(place.of(after))
    for name in ("slide_mean", "slide_max"):
        expected = getattr(one.report, name)
        assert getattr(other.report, name) == pytest.approx(expected, abs=SAME), name
    error = np.linalg.norm(other.positions - place.of(one.positions), axis=1).max()
    assert error <= SAME * moved.spacing(30)


@given(st.data())
def test_a_rigid_motion_slides_nothing(data):
    mesh = BODIES[data.draw(st.sampled_from(sorted(BODIES)), label="body")]
    surface = dapple.Surface(*mesh)
    tracker = dapple.Tracker(surface, dapple.sample(surface, 30, seed=3))
    place = Place(data, len(mesh[1]))
    assert tracker.advance(place.of(mesh[0])).report.slide_max <= SAME


@given(st.data())
def test_samples_of_twice_the_size_are_at_twice_the_places(data):
    mesh = BODIES[data.draw(st.sampled_from(sorted(BODIES)), label="body")]
    density = density_of(data, mesh[0])
    scale = 2.0 ** data.draw(st.integers(-20, 20), label="power of two")
    options = {"seed": data.draw(st.integers(0, 99), label="seed")}
    one = dapple.sample(dapple.Surface(*mesh, density), 60, **options)
    other = dapple.sample(dapple.Surface(scale * mesh[0], mesh[1], density), 60, **options)
    assert np.array_equal(other.positions, scale * one.positions)
    assert np.array_equal(other.faces, one.faces)
    assert other.report.energies == one.report.energies
