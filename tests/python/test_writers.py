# SPDX-License-Identifier: GPL-3.0-or-later
"""Every writer: what does not fit is refused with row and value; names as long as can be."""

import os
from importlib.util import find_spec

import click
import dapple3d as dapple
import numpy as np
import pytest
from command_line import done, refused
from dapple3d import instances, stippling, tables
from dapple3d.cli import points, polygons
from dapple3d.cli.points import Points
from dapple3d.extras import gltf, godot, usd

SCENES = tuple(one for one in points.SCENES if find_spec("pxr") or one not in usd.SUFFIXES)
FORMATS = (*points.WRITERS, *SCENES)
LONGEST = 255  # bytes of a name
PLACES = np.arange(9.0).reshape(3, 3)


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("ids", [1, 1.5, 2], "ids of point 1 is 1.5: a whole number of 32 bits is needed"),
        ("ids", [1, 2, 2**31], "ids of point 2 is 2147483648: a whole"),
        ("classes", [0, 2**31 + 5, 0], "classes of point 1 is 2147483653: a whole number of 32"),
        ("prototypes", [0, 0, np.nan], "prototypes of point 2 is nan: a whole number of 32 bits"),
        ("polygons", [0, 2**40, 0], "polygons of point 1 is 1099511627776: a whole number"),
    ],
)
def test_a_number_that_does_not_fit_is_refused_by_every_writer(
    tmp_path, suffix, name, values, said
):
    path = tmp_path / f"points{suffix}"
    with pytest.raises(click.ClickException) as caught:
        points.write_points(path, Points(PLACES, **{name: np.array(values)}))
    assert caught.value.message.startswith(f"{path}: {said}")
    assert not path.exists()


@pytest.mark.parametrize("suffix", FORMATS)
def test_whole_numbers_that_are_floats_are_written_by_every_writer(tmp_path, suffix):
    path = tmp_path / f"points{suffix}"
    points.write_points(path, Points(PLACES, ids=np.array([5.0, 3.0, 4.0]), classes=np.ones(3)))
    if suffix in godot.SUFFIXES:
        assert "PackedInt64Array(5, 3, 4)" in path.read_text()
        return
    found = points.read_points(path)
    if suffix not in (".obj", ".off"):
        assert sorted(found.ids.tolist()) == [3, 4, 5]
        assert found.classes.tolist() == [1, 1, 1]


@pytest.mark.parametrize("suffix", FORMATS)
def test_an_attribute_that_would_lose_digits_is_refused(tmp_path, suffix):
    given = Points(PLACES, attributes={"moisture": np.array([1, 2**60 + 1, 3])})
    with pytest.raises(click.ClickException, match=r"moisture of point 1 is 1152921504606846977"):
        points.write_points(tmp_path / f"points{suffix}", given)


@pytest.mark.parametrize("suffix", [".csv", ".ply", ".npz"])
def test_a_table_with_a_number_that_does_not_fit_is_not_written_on(tmp_path, suffix):
    (tmp_path / "in.csv").write_text("x,y,z,id,class\n0,0,0,1,0\n1,1,1,1.5,0\n")
    told = refused("export", tmp_path / "in.csv", tmp_path / f"out{suffix}")
    assert "id of point 1 is 1.5" in told
    (tmp_path / "in.csv").write_text("x,y,z,id,class\n0,0,0,1,2147483653\n")
    told = refused("export", tmp_path / "in.csv", tmp_path / f"out{suffix}")
    assert "class of point 0 is 2147483653" in told
    assert not (tmp_path / f"out{suffix}").exists()


def longest(suffix: str) -> str:
    """80 Japanese letters and what else a name has room for."""
    name = "点" * 80
    return name + "x" * (LONGEST - len(os.fsencode(name)) - len(suffix)) + suffix


def dots() -> stippling.Dots:
    return stippling.stipple(np.full((8, 8), 0.5), 4, max_evaluations=2)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl"])
def test_a_mesh_has_a_name_as_long_as_can_be(tmp_path, suffix):
    path = tmp_path / longest(suffix)
    for _ in range(2):
        dapple.write_mesh(path, np.eye(3), [[0, 1, 2]])
    assert [one.name for one in tmp_path.iterdir()] == [path.name]
    assert len(dapple.read_mesh(path).faces) == 1


@pytest.mark.parametrize("suffix", FORMATS)
def test_points_have_a_name_as_long_as_can_be(tmp_path, suffix):
    path = tmp_path / longest(suffix)
    points.write_points(path, Points(PLACES))
    assert suffix in godot.SUFFIXES or len(points.read_points(path).positions) == 3
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("suffix", stippling.SUFFIXES)
def test_pictures_have_a_name_as_long_as_can_be(tmp_path, suffix):
    stippling.write(dots(), tmp_path / longest(suffix))
    assert [one.name for one in tmp_path.iterdir()] == [longest(suffix)]


@pytest.mark.parametrize("suffix", polygons.WRITERS)
def test_tiles_of_a_mosaic_have_a_name_as_long_as_can_be(tmp_path, surface, suffix):
    samples = dapple.sample(surface, 12, max_evaluations=2)
    mosaic = dapple.mosaic(surface, samples, merge=False)
    polygons.write_tiles(tmp_path / longest(suffix), mosaic, samples.ids)
    assert [one.name for one in tmp_path.iterdir()] == [longest(suffix)]


def test_the_command_takes_names_as_long_as_can_be(tmp_path, surface):
    mesh, report = tmp_path / longest(".ply"), tmp_path / longest(".json")
    dapple.write_mesh(mesh, surface.vertices, surface.faces)
    done("sample", mesh, tmp_path / longest(".npz"), "-n", 9, "--json", report)
    assert len(list(tmp_path.iterdir())) == 3


def test_a_name_that_is_too_long_is_said(tmp_path):
    path = tmp_path / ("x" + longest(".csv"))
    with pytest.raises(OSError, match="File name too long") as caught:
        tables.write(path, [instances.Instances(PLACES)])
    assert caught.value.filename == str(path)
    with pytest.raises(dapple.FileError, match="File name too long"):
        dapple.write_mesh(tmp_path / ("x" + longest(".ply")), np.eye(3), [[0, 1, 2]])
    with pytest.raises(OSError, match="File name too long"):
        gltf.write(tmp_path / ("x" + longest(".glb")), instances.Instances(PLACES))
