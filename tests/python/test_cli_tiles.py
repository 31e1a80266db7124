# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple tiles."""

import json

import numpy as np
import pytest
from command_line import done, refused, run
from dapple3d.cli.work import Work
from dapple3d.extras.distributed import HeightField, sample_tiles
from test_tiles import TILE, contents, hills

SETTINGS = ("-n", 4_000, "--tile", TILE)


@pytest.fixture
def terrain(tmp_path):
    np.save(tmp_path / "hills.npy", hills(60, 80).heights)
    return tmp_path / "hills.npy"


def test_makes_the_tiles_of_the_library(terrain, tmp_path):
    found = done("tiles", terrain, tmp_path / "out", *SETTINGS, "--step", 0.5, 0.5, "--seed", 3)
    assert found.stdout == f"{tmp_path / 'out'}: 4000 points in 1 x 2 tiles\n"
    field = HeightField(np.load(terrain), (0.5, 0.5))
    sample_tiles(field, tmp_path / "library", 4_000, tile=TILE, seed=3)
    assert contents(tmp_path / "out") == contents(tmp_path / "library")


def test_says_in_json_what_was_done(terrain, tmp_path):
    found = done("tiles", terrain, tmp_path / "out", *SETTINGS, "--json", "-")
    document = json.loads(found.stdout)
    assert document["command"] == "tiles"
    assert document["input"]["shape"] == [60, 80]
    assert (document["rows"], document["columns"]) == (1, 2)
    assert document["settings"]["count"] == 4_000


def test_goes_on_and_keeps_what_is_there(terrain, tmp_path):
    done("tiles", terrain, tmp_path / "out", *SETTINGS)
    tile = tmp_path / "out" / "tiles" / "tile-0000-0000.npz"
    before = tile.read_bytes()
    tile.unlink()
    other = tmp_path / "out" / "tiles" / "tile-0000-0001.npz"
    written = other.stat().st_mtime_ns
    done("tiles", terrain, tmp_path / "out", *SETTINGS)
    assert tile.read_bytes() == before
    assert other.stat().st_mtime_ns == written


def test_refuses_the_folder_of_something_else(terrain, tmp_path):
    done("tiles", terrain, tmp_path / "out", *SETTINGS)
    told = refused("tiles", terrain, tmp_path / "out", "-n", 5_000, "--tile", TILE)
    assert "holds tiles with count 4000, not 5000" in told


def test_names_the_terrain_that_is_wrong(terrain, tmp_path):
    row = tmp_path / "row.npy"
    np.save(row, np.zeros((1, 5)))
    wrong = f"Error: {row}: heights has the shape (1, 5): at least 2 rows and columns are needed"
    assert wrong in refused("tiles", row, tmp_path / "out", *SETTINGS)
    told = refused("tiles", terrain, tmp_path / "out", *SETTINGS, "--step", 0, 1)
    assert f"Error: {terrain}: step is (0.0, 1.0): two finite numbers" in told
    told = refused("tiles", terrain, tmp_path / "out", *SETTINGS, "--density", row)
    assert f"Error: {terrain}: density has the shape (1, 5), but heights" in told


def test_says_after_ctrl_c_that_it_can_go_on(terrain, tmp_path, monkeypatch):
    def interrupted(self, call):
        raise KeyboardInterrupt

    monkeypatch.setattr(Work, "run", interrupted)
    found = run("tiles", terrain, tmp_path / "out", *SETTINGS)
    assert found.exit_code == 130
    assert found.stderr == "Cancelled: the same command goes on from here.\n"


def test_takes_workers_or_a_scheduler(terrain, tmp_path):
    found = run("tiles", terrain, tmp_path, *SETTINGS, "--workers", 1, "--scheduler", "tcp://x")
    assert found.exit_code == 2
    assert "give either --workers or --scheduler" in found.stderr


def test_says_of_a_file_that_is_no_surface_what_it_is(tmp_path):
    (tmp_path / "mesh.npz").write_bytes(b"no archive")
    assert "mesh.npz" in refused("tiles", tmp_path / "mesh.npz", tmp_path / "out", *SETTINGS)
    (tmp_path / "broken.npy").write_bytes(b"no array")
    told = refused("tiles", tmp_path / "broken.npy", tmp_path / "out", *SETTINGS)
    assert "broken.npy: could not be read" in told
    np.save(tmp_path / "line.npy", np.zeros(5))
    told = refused("tiles", tmp_path / "line.npy", tmp_path / "out", *SETTINGS)
    assert "line.npy: has the shape (5,): (rows, columns) is needed" in told


def test_starts_workers_of_its_own(terrain, tmp_path):
    pytest.importorskip("distributed")
    done("tiles", terrain, tmp_path / "out", *SETTINGS)
    done("tiles", terrain, tmp_path / "workers", *SETTINGS, "--workers", 1)
    assert contents(tmp_path / "out") == contents(tmp_path / "workers")
