# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells that follow the surface, and the paper's preset."""

import dapple3d as dapple
import numpy as np
import pytest
from shapes import grid


@pytest.fixture(scope="module")
def sheets():
    """Two unit sheets, much nearer to each other than the samples will be."""
    vertices, faces = grid(20)
    both = np.concatenate([vertices, vertices + np.array([0.0, 0.0, 0.005])])
    return dapple.Surface(both, np.concatenate([faces, faces + len(vertices)]))


def test_connected_cells_fill_both_sheets_alike(sheets):
    samples = dapple.sample(sheets, 300)
    upper = int(np.sum(samples.positions[:, 2] > 0.0025))
    assert abs(upper - 150) <= 1
    assert samples.report.capacity_variation < 0.01


@pytest.mark.parametrize("cells", ["connected", "euclidean"])
def test_cells_share_out_the_surface(sheets, cells):
    samples = dapple.sample(sheets, 100, max_evaluations=3)
    energy = dapple.evaluate_energy(sheets, samples.positions, samples.faces, cells=cells)
    assert energy.areas.sum() == pytest.approx(sheets.area, rel=1e-10)


def test_euclidean_cells_reach_through(sheets):
    samples = dapple.sample(sheets, 300)
    spread = {}
    for cells in ("connected", "euclidean"):
        capacities = dapple.evaluate_energy(
            sheets, samples.positions, samples.faces, cells=cells
        ).capacities
        spread[cells] = capacities.std() / capacities.mean()
    assert spread["euclidean"] > 10 * spread["connected"]


def test_a_bad_name_is_named(sheets):
    with pytest.raises(ValueError, match="cells is 'geodesic'"):
        dapple.sample(sheets, 10, cells="geodesic")


def test_the_papers_preset_is_plain(sheets):
    report = dapple.sample(sheets, 200, **dapple.PAPER).report
    assert report.energies[-1] == pytest.approx(report.energy, abs=1e-12)  # without repulsion
