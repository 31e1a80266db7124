# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of instances: what is written, and what the command line makes of it."""

import csv

import numpy as np
import pytest
from command_line import done
from dapple3d import instances, tables
from dapple3d.cli import motions, points
from dapple3d.instances import Instances


@pytest.fixture
def frames() -> list[Instances]:
    random = np.random.default_rng(0)

    def frame() -> Instances:
        turns = instances.orientations(random.normal(size=(20, 3)))
        arrays = {name: random.normal(size=(20, 3)) for name in ("scales", "velocities", "normals")}
        whole = {"ids": np.arange(20) + 5, "classes": np.arange(20) % 2, "prototypes": None}
        return Instances(random.normal(size=(20, 3)), turns, **arrays, **whole)

    return [frame() for _ in range(3)]


def check_same(found: points.Points, expected: Instances) -> None:
    assert found.arrays().keys() == expected.arrays().keys()
    for name, values in expected.arrays().items():
        np.testing.assert_array_equal(found.arrays()[name], values, name)


@pytest.mark.parametrize("suffix", tables.SUFFIXES)
def test_every_digit_comes_back(tmp_path, frames, suffix):
    path = tmp_path / f"points{suffix}"
    tables.write(path, frames[:1])
    check_same(points.read_points(path), frames[0])


@pytest.mark.parametrize("suffix", tables.SUFFIXES)
def test_a_motion_comes_back(tmp_path, frames, suffix):
    path = tmp_path / f"points{suffix}"
    tables.write(path, frames, times=[1, 2, 2.5])
    found = motions.read(path)
    assert found.times.tolist() == [1, 2, 2.5]
    for one, expected in zip(found.frames, frames, strict=True):
        check_same(one, expected)


def test_points_that_come_and_go_fit_into_csv(tmp_path, frames):
    fewer = Instances(**{name: values[3:] for name, values in frames[1].arrays().items()})
    path = tmp_path / "points.csv"
    tables.write(path, [frames[0], fewer], times=[1, 2])
    check_same(motions.read(path).frames[1], fewer)
    with pytest.raises(ValueError, match=r"ids of frames\[1\] are others than before"):
        tables.write(tmp_path / "points.npz", [frames[0], fewer], times=[1, 2])
    assert not (tmp_path / "points.npz").exists()


def test_objects_are_named(tmp_path, frames):
    named = Instances(frames[0].positions, prototypes=np.arange(20) % 3)
    names = ["Fern", 'Rock, "old"', "Bäume"]
    tables.write(tmp_path / "points.csv", [named], names=names)
    with (tmp_path / "points.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["object"] for row in rows] == [names[k % 3] for k in range(20)]
    check_same(points.read_points(tmp_path / "points.csv"), named)
    done("export", tmp_path / "points.csv", tmp_path / "points.glb")
    tables.write(tmp_path / "points.npz", [named], names=names)
    assert np.load(tmp_path / "points.npz")["names"].tolist() == names


def test_wrong_arguments_are_named(tmp_path, frames):
    with pytest.raises(ValueError, match=r"a table ends with \.csv or \.npz"):
        tables.write(tmp_path / "points.ply", frames)
    with pytest.raises(ValueError, match=r"times has the shape \(2,\): \(3,\) is needed"):
        tables.write(tmp_path / "points.csv", frames, times=[1, 2])
    with pytest.raises(ValueError, match="names has 1 of 2 entries"):
        tables.write(tmp_path / "points.csv", frames, names=["Fern"])
    assert list(tmp_path.iterdir()) == []
