# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array

OUTLINE = np.array([[0, 0], [3, 0], [3, 2], [1.5, 0.7], [0, 2]])  # with a notch
HOLE = np.array([[2.2, 0.3], [2.6, 0.3], [2.6, 0.8], [2.2, 0.8]])
IMAGE = 1.2 + np.sin(np.arange(20)).reshape(4, 5)

DOMAINS = {
    "rectangle": lambda: dapple.Plane(3, 2),
    "polygon": lambda: dapple.Plane.polygon(OUTLINE, [HOLE]),
    "image": lambda: dapple.Plane(3, 2, IMAGE),
    "torus": lambda: dapple.Torus(),
    "torus image": lambda: dapple.Torus(IMAGE),
}


@pytest.fixture(params=DOMAINS)
def domain(request) -> dapple.FlatDomain:
    return DOMAINS[request.param]()


@pytest.mark.parametrize("count", [0, 1, 2, 3, 200])
def test_samples_exactly_that_many(domain, count):
    samples = dapple.sample(domain, count, max_evaluations=10)
    assert len(samples) == count
    check_array(samples.positions, np.float64, (count, 2))
    energy = dapple.evaluate_energy(domain, samples.positions)
    check_array(energy.gradient, np.float64, (count, 3))
    if count:
        assert energy.areas.sum() == pytest.approx(domain.area, rel=1e-10)
        assert energy.capacities.sum() == pytest.approx(domain.capacity, rel=1e-10)
    assert samples.report.count == count
    assert samples.report.spacing == domain.spacing(count)


def test_gives_the_same_bytes_for_any_threads(domain):
    base = dapple.sample(domain, 150, seed=3, threads=1, max_evaluations=6)
    for threads in (2, 5):
        again = dapple.sample(domain, 150, seed=3, threads=threads, max_evaluations=6)
        assert again.positions.tobytes() == base.positions.tobytes()
    other = dapple.sample(domain, 150, seed=4, max_evaluations=6)
    assert other.positions.tobytes() != base.positions.tobytes()


@pytest.mark.parametrize("cells", ["connected", "euclidean"])
@pytest.mark.parametrize("name", ["rectangle", "polygon", "image"])
def test_agrees_with_the_flat_mesh(name, cells):
    plane = DOMAINS[name]()
    positions = dapple.sample(plane, 80, max_evaluations=3).positions
    found = dapple.evaluate_energy(plane, positions, cells=cells)
    points = np.column_stack([positions, np.zeros(80)])
    there = dapple.project(plane.surface, points)
    expected = dapple.evaluate_energy(plane.surface, points, there.faces, cells=cells)
    assert found.total == pytest.approx(expected.total, rel=1e-9)
    scale = np.abs(expected.gradient).max()
    np.testing.assert_allclose(found.gradient, expected.gradient, rtol=0, atol=1e-9 * scale)


def test_of_a_lattice_on_the_torus():
    k = np.arange(4) / 4
    lattice = np.stack(np.meshgrid(k, k), axis=-1).reshape(-1, 2)
    energy = dapple.evaluate_energy(dapple.Torus(), lattice + 5.1)
    np.testing.assert_allclose(energy.areas, 1 / 16, rtol=1e-12)
    assert energy.normalized == pytest.approx(1 / 6, abs=1e-10)
    np.testing.assert_allclose(energy.gradient, 0, atol=1e-12)


def test_is_even_on_the_torus():
    torus = dapple.Torus()
    for options in ({}, dapple.PAPER):
        samples = dapple.sample(torus, 1000, **options)
        gaps = samples.positions[:, None] - samples.positions[None]
        gaps = np.linalg.norm(gaps - np.round(gaps), axis=2)
        np.fill_diagonal(gaps, np.inf)
        report = samples.report
        print(report.to_dict())
        assert report.alpha_min == pytest.approx(gaps.min() / torus.spacing(1000), rel=1e-9)
        assert report.capacity_variation < 0.01
        assert 0.16037 < report.energy < 0.179
        assert 0.35 < report.bond_order < 0.7
        assert samples.positions.min() >= 0
        assert samples.positions.max() < 1


def test_follows_an_image():
    ramp = np.array([[0.0], [1.0]])  # row 0 is at y = 0
    positions = dapple.sample(dapple.Plane(1, 1, ramp), 400).positions
    assert np.count_nonzero(positions[:, 1] > 0.5) == pytest.approx(350, abs=8)


def test_stops_when_cancelled():
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.sample(dapple.Torus(), 100, context=context)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: dapple.Plane(-1, 1), "width.*-1"),
        (lambda: dapple.Plane(1, np.inf), "height.*inf"),
        (lambda: dapple.Plane(1, 1, [[1, 1], [1, -2]]), r"density\[1, 1\].*-2"),
        (lambda: dapple.Plane(1, 1, [1, 1]), r"density.*\(2,\)"),
        (lambda: dapple.Plane(1, 1, np.zeros((0, 4))), "density.*0 rows"),
        (lambda: dapple.Torus([[0, np.nan]]), r"density\[0, 1\].*nan"),
        (lambda: dapple.Torus(np.zeros((2, 2))), "density.*0 everywhere"),
        (lambda: dapple.Plane.polygon([[0, 0], [1, 1], [1, 0], [0, 1]]), r"outline\[2\].*crosses"),
        (lambda: dapple.Plane.polygon([[0, 0], [1, 1]]), "outline.*2 points"),
        (lambda: dapple.Plane.polygon([[0, 0], [1, np.nan], [1, 1]]), r"outline\[1\].*nan"),
        (lambda: dapple.Plane.polygon([[0, 0, 0], [1, 0, 0]]), r"outline.*\(2, 3\)"),
        (lambda: dapple.Plane.polygon(OUTLINE, [HOLE, HOLE + 9]), r"holes\[1\].*outline"),
        (lambda: dapple.evaluate_energy(dapple.Plane(1, 1), [[0, 0], [2, 0]]), r"positions\[1\]"),
        (lambda: dapple.evaluate_energy(dapple.Torus(), [[0, np.nan]]), r"positions\[0\].*nan"),
        (lambda: dapple.sample(dapple.Torus(), -1), "count.*-1"),
        (lambda: dapple.sample(dapple.Torus(), 9, start="grid"), "start.*grid"),
        (lambda: dapple.sample(dapple.Torus(), 9, threads=-1), "threads.*-1"),
    ],
)
def test_refuses(make, match):
    with pytest.raises(ValueError, match=match):
        make()
