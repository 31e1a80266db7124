# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices that are split along hard edges and seams are no walls."""

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done
from shapes import torus

COUNT = 300


def soup(vertices, faces):
    return vertices[faces].reshape(-1, 3), np.arange(3 * len(faces), dtype=np.int32).reshape(-1, 3)


@pytest.fixture
def whole():
    return torus()


def test_a_soup_is_sampled_like_the_mesh_it_came_from(whole):
    expected = dapple.sample(dapple.Surface(*whole), COUNT)
    found = dapple.sample(dapple.Surface(*soup(*whole)), COUNT)
    assert np.array_equal(found.positions, expected.positions)


def test_weld_none_connects_by_indices_alone(whole):
    surface = dapple.Surface(*soup(*whole), weld=None)
    assert surface.weld is None
    assert surface.topology.components == len(whole[1])
    assert dapple.Surface(*soup(*whole)).topology.components == 1


@pytest.mark.parametrize("weld", [-1.0, np.nan, np.inf])
def test_a_tolerance_that_is_no_distance_is_named(whole, weld):
    with pytest.raises(dapple.SurfaceError, match=r"weld is .*: it must be finite and >= 0"):
        dapple.Surface(*whole, weld=weld)


def test_a_mosaic_crosses_split_edges(whole):
    surface = dapple.Surface(*soup(*whole))
    tiles = dapple.mosaic(surface, dapple.sample(surface, 40))
    assert (tiles.parts == 1).all()


def test_a_tracker_carries_samples_over_split_edges(whole):
    vertices, faces = soup(*whole)
    surface = dapple.Surface(vertices, faces)
    tracker = dapple.Tracker(surface, dapple.sample(surface, COUNT))
    report = tracker.advance(vertices * [1.0, 1.0, 1.2]).report
    assert report.capacity_variation < 0.03
    assert report.alpha_min > 0.5


def test_the_command_line_connects_split_edges_unless_reported(whole, tmp_path):
    mesh = tmp_path / "soup.npz"
    vertices, faces = soup(*whole)
    np.savez(mesh, vertices=vertices, faces=faces)
    written = {}
    for option in ("--weld", "--no-weld"):
        out = tmp_path / f"out{option}.npz"
        done("sample", mesh, out, "-n", COUNT, option)
        written[option] = np.load(out)["positions"]
    expected = dapple.sample(dapple.Surface(*whole), COUNT).positions
    assert np.array_equal(written["--weld"], expected)
    assert not np.array_equal(written["--no-weld"], expected)
