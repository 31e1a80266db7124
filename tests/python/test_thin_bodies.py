# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies thinner than the spacing are even along their length, and the words of the result true."""

import dapple3d as dapple
import exact
import numpy as np
import pytest
import shapes
from command_line import done

SEEDS = range(20)


def helix(radius: float) -> shapes.Mesh:
    turns = 2 * np.pi * np.linspace(0, 3, 301)
    return shapes.tube(np.column_stack([np.cos(turns), np.sin(turns), turns / 12]), radius)


def fence(radius: float = 0.002) -> shapes.Mesh:
    wires = [shapes.tube(np.array([[0, y, 0], [2, y, 0]]), radius) for y in np.arange(20) / 10]
    size = len(wires[0][0])
    faces = [faces + k * size for k, (_, faces) in enumerate(wires)]
    return np.vstack([vertices for vertices, _ in wires]), np.vstack(faces)


@pytest.mark.parametrize(
    ("mesh", "count"),
    [
        (fence(), 200),
        (fence(2e-5), 200),
        (helix(0.01), 100),
        (helix(1e-4), 200),
        (helix(0.03), 300),
    ],
    ids=["fence", "thin fence", "rope", "thin rope", "thick rope"],
)
def test_wires_and_ropes_are_even_along_their_length(mesh, count):
    surface = dapple.Surface(*mesh)
    for seed in SEEDS:
        report = dapple.sample(surface, count, seed=seed).report
        assert report.capacity_variation <= 0.01
        assert report.evaluations <= 40
        assert report.converged


@pytest.mark.parametrize(
    ("size", "count"), [((1, 1, 0.002), 500), ((1, 0.7, 0.004), 333), ((4, 0.06, 0.002), 60)]
)
def test_plates_are_even_on_both_sides(size, count):
    vertices, faces = exact.cube()
    surface = dapple.Surface(vertices * size / 2, faces)
    for seed in SEEDS:
        samples = dapple.sample(surface, count, seed=seed)
        assert samples.report.capacity_variation <= 0.01
        assert samples.report.evaluations <= 40
        above = samples.positions[:, 2] > 0
        assert abs(above.sum() - count / 2) <= 1
        measured = dapple.analyze(surface, samples)
        assert measured.capacity_variation == pytest.approx(samples.report.capacity_variation)


def test_gaps_along_a_wire_are_those_of_equal_parts():
    surface = dapple.Surface(*fence())
    for seed in SEEDS:
        positions = dapple.sample(surface, 200, seed=seed).positions
        for wire in range(20):
            x = np.sort(positions[np.round(10 * positions[:, 1]) == wire, 0])
            assert len(x) == 10
            assert np.abs(np.diff(x) - 0.2).max() < 0.02


def test_alpha_is_left_out_where_no_hexagons_fit():
    report = dapple.sample(dapple.Surface(*fence()), 200).report
    assert report.thin_share == 1.0
    assert report.alpha_min == report.alpha_mean == 0.0


def test_the_command_line_says_no_spacing_of_wires(tmp_path):
    dapple.write_mesh(tmp_path / "fence.ply", *fence())
    text = done("sample", tmp_path / "fence.ply", tmp_path / "points.npz", "-n", 200).output
    assert "along parts thinner than the spacing" in text
    assert "alpha" not in text
