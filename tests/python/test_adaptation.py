# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Fig. 3: 1,000 sites under a quadratic ramp, counted in quarters.

A line between two quarters cuts some 35 cells, whose sites fall to either side: one run is off by
up to six sites, whatever the surface, while the capacity that the cells of a quarter hold agrees
with their number to 0.3 sites once converged.
"""

import dapple3d as dapple
import numpy as np
import pytest
from shapes import grid

EXPECTED = np.diff(np.linspace(0, 1, 5) ** 3)  # integrals of 3 x^2 over the quarters of [0, 1]
SEEDS = range(3)


def quarters(positions: np.ndarray) -> np.ndarray:
    return np.minimum(4 * positions[:, 0], 3).astype(int)


def ramp(columns: int, rows: int) -> np.ndarray:
    return np.tile(((np.arange(columns) + 0.5) / columns) ** 2, (rows, 1))


def flat_mesh() -> dapple.Surface:
    vertices, faces = grid(40)
    return dapple.Surface(vertices, faces, vertices[:, 0] ** 2)


def textured_mesh() -> dapple.Surface:
    vertices, faces = grid(4)
    uv = vertices[faces][:, :, :2]
    return dapple.refine_image(dapple.Surface(vertices, faces), uv, ramp(128, 16)).surface


def check_shares(runs: list[np.ndarray]) -> None:
    shares = [np.bincount(quarters(positions), minlength=4) / 1000 for positions in runs]
    np.testing.assert_allclose(shares, [EXPECTED] * len(runs), rtol=0, atol=0.0075)
    np.testing.assert_allclose(np.mean(shares, axis=0), EXPECTED, rtol=0, atol=0.005)


def test_in_the_plane():
    plane = dapple.Plane(1, 1, ramp(128, 16))
    check_shares([dapple.sample(plane, 1000, seed=seed).positions for seed in SEEDS])


@pytest.mark.parametrize("make", [flat_mesh, textured_mesh])
def test_on_a_surface(make):
    surface = make()
    check_shares([dapple.sample(surface, 1000, seed=seed).positions for seed in SEEDS])


@pytest.mark.parametrize("make", [flat_mesh, textured_mesh])
def test_quarters_hold_what_their_samples_stand_for(make):
    surface = make()
    for seed in SEEDS:
        samples = dapple.sample(surface, 1000, seed=seed, tolerance=1e-5)
        capacities = dapple.evaluate_energy(surface, samples.positions, samples.faces).capacities
        held = np.bincount(quarters(samples.positions), capacities) / (surface.capacity / 1000)
        np.testing.assert_allclose(held, np.bincount(quarters(samples.positions)), rtol=0, atol=0.3)
