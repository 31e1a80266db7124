# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array
from shapes import grid, random_points


def expect_near(found, expected, tolerance=1e-9):
    """To a part of the largest value."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * np.abs(expected).max())


@pytest.mark.parametrize("kind", ["uniform", "density"])
def test_agrees_with_an_independent_evaluation(data, kind):
    reference = np.load(data / "reference_energy.npz")
    density = reference["vertex_density"] if kind == "density" else None
    surface = dapple.Surface(reference["vertices"], reference["faces"], density)
    found = dapple.evaluate_energy(
        surface,
        reference[f"{kind}_sites"],
        reference[f"{kind}_faces"],
        capacity_weight=float(reference["lambda_"]),
    )
    expect_near(found.capacities, reference[f"{kind}_capacity"])
    expect_near(found.masses, reference[f"{kind}_mass"])
    expect_near(found.gradient, reference[f"{kind}_gradient"])
    expect_near([found.total, found.cvt, found.capacity_term], reference[f"{kind}_energy"])
    assert found.areas.sum() == pytest.approx(surface.area, rel=1e-10)


def test_gives_arrays_per_site(mesh, surface):
    positions, faces = random_points(mesh, 40)
    found = dapple.evaluate_energy(surface, positions, faces)
    for name in ("areas", "capacities", "masses"):
        check_array(getattr(found, name), np.float64, (40,))
    check_array(found.gradient, np.float64, (40, 3))
    assert found.total == pytest.approx(found.cvt + 30 * found.capacity_term)
    assert found.normalized == pytest.approx(40 * found.total / surface.capacity**2 - 30)


@pytest.mark.parametrize("weight", [0.0, 1.0, 30.0, 100.0])
def test_has_the_gradient_of_its_total(mesh, dense, weight):
    positions, faces = random_points(mesh, 30, seed=5)
    energy = dapple.evaluate_energy(dense, positions, faces, capacity_weight=weight)
    scale = np.abs(energy.gradient).max()
    corners = mesh[0][mesh[1][faces]]
    for k in range(10):
        direction = corners[k, 1] - corners[k, 0]
        direction /= np.linalg.norm(direction)
        step = 1e-5 * dense.spacing(30)
        ends = []
        for side in (1, -1):
            moved = positions.copy()
            moved[k] += side * step * direction
            ends.append(dapple.evaluate_energy(dense, moved, faces, capacity_weight=weight).total)
        assert (ends[0] - ends[1]) / (2 * step) == pytest.approx(
            energy.gradient[k] @ direction, abs=1e-6 * scale
        )


def test_of_four_sites_in_a_square():
    positions = [[0.25, 0.25, 0], [0.75, 0.25, 0], [0.25, 0.75, 0], [0.75, 0.75, 0]]
    square = dapple.Surface(*grid(1))
    found = dapple.evaluate_energy(square, positions, [0, 0, 1, 1])
    assert found.cvt == pytest.approx(1 / 24, rel=1e-14)
    assert found.capacity_term == pytest.approx(1 / 4, rel=1e-14)
    assert found.normalized == pytest.approx(1 / 6, abs=1e-12)
    np.testing.assert_allclose(found.gradient, 0, atol=1e-13)


def test_of_no_sites(surface):
    found = dapple.evaluate_energy(surface, np.zeros((0, 3)), np.zeros(0, np.int32))
    assert found.total == 0
    assert found.gradient.shape == (0, 3)


@pytest.mark.parametrize("name", ["lilium", "truck", "camelhead"])
def test_shares_out_real_meshes(data, name):
    mesh = dapple.read_mesh(data / "meshes" / f"{name}.ply")
    surface = dapple.Surface(*mesh)
    for count in (1, 30, 3000):
        found = dapple.evaluate_energy(surface, *random_points(mesh, count))
        assert found.areas.sum() == pytest.approx(surface.area, rel=1e-10)
        assert found.capacities.sum() == pytest.approx(surface.capacity, rel=1e-10)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"positions": [[0, 0, 0], [0, np.nan, 0]]}, r"positions\[1\].*nan"),
        ({"positions": [[0, 0, 0], [0, np.inf, 0]]}, r"positions\[1\].*inf"),
        ({"positions": np.zeros((2, 4))}, r"positions.*\(2, 4\)"),
        ({"faces": [0, -1]}, r"faces\[1\].*-1"),
        ({"faces": [0, 10**7]}, r"faces\[1\].*10000000"),
        ({"faces": [0]}, "faces.*1.*2"),
        ({"faces": [0.0, 1.0]}, "faces.*integer"),
        ({"capacity_weight": -1}, "capacity_weight.*-1"),
        ({"capacity_weight": np.nan}, "capacity_weight.*nan"),
    ],
)
def test_refuses(surface, change, match):
    arguments = {"positions": np.zeros((2, 3)), "faces": [0, 1]} | change
    positions, faces = arguments.pop("positions"), arguments.pop("faces")
    with pytest.raises(ValueError, match=match):
        dapple.evaluate_energy(surface, positions, faces, **arguments)
