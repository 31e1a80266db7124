# SPDX-License-Identifier: GPL-3.0-or-later
"""Every writer on a disk that is full at any byte: the error names the file, the old one stays."""

import shutil
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from dapple3d import instances, stippling, tables
from dapple3d.cli import motions, points, polygons
from dapple3d.cli.commands import analyze
from dapple3d.cli.report import Reporter
from dapple3d.extras import gltf, godot, usd
from dapple3d.extras.distributed import Tiles, open_surface, sample_tiles
from dapple3d.extras.distributed.shots import motion_arrays
from dapple3d.writing import replacing, write_npz
from full_disk import full_after
from test_tiles import TILE, contents, hills

pytest.importorskip("resource", reason="Windows limits no file")

MOST = 150  # sizes of the disk, evenly spread over a large file
SLOW = {"spectrum.png": 2}
Write = Callable[[Path], object]


@pytest.fixture(scope="module")
def few(surface) -> dapple.Samples:
    return dapple.sample(surface, 12, max_evaluations=2)


WRITERS: dict[str, Callable[[dapple.Surface, dapple.Samples], Write]] = {}


def writer(*suffixes: str) -> Callable[[Callable], Callable]:
    """Add one for each suffix."""

    def add(make: Callable) -> Callable:
        WRITERS.update({f"{make.__name__}{suffix}": make for suffix in suffixes})
        return make

    return add


@writer(".ply", ".off", ".obj", ".stl")
def mesh_of(surface, few):
    return lambda path: dapple.write_mesh(path, surface.vertices[:40], [[0, 1, 2], [3, 4, 5]])


@writer(".csv", ".npz")
def table(surface, few):
    return lambda path: tables.write(path, [instances.of_samples(few)])


@writer(*(usd.SUFFIXES if find_spec("pxr") else ()))
def scene(surface, few):
    return lambda path: usd.write(path, instances.of_samples(few))


@writer(*gltf.SUFFIXES)
def asset(surface, few):
    return lambda path: gltf.write(path, instances.of_samples(few))


@writer(*godot.SUFFIXES)
def level(surface, few):
    return lambda path: godot.write(path, instances.of_samples(few))


@writer(*stippling.SUFFIXES)
def picture(surface, few):
    dots = stippling.stipple(np.full((10, 10), 0.5), 20, max_evaluations=2)
    return lambda path: stippling.write(dots, path)


@writer(".ply", ".csv", ".npz", ".obj", ".off")
def points_of(surface, few):
    return lambda path: points.write_points(path, points.points_of(few))


@writer(".ply", ".obj", ".off", ".stl", ".npz")
def cells(surface, few):
    mosaic = dapple.mosaic(surface, few, merge=False)
    return lambda path: polygons.write_tiles(path, mosaic, few.ids)


@writer(".npz")
def tracked(surface, few):
    def write(path):
        with replacing(path) as file:
            write_npz(file, motion_arrays([few, few]))

    return write


@writer(".npz")
def motion(surface, few):
    return lambda path: motions.write_npz_motion(path, [points.points_of(few)] * 2)


@writer(".json")
def report(surface, few):
    return lambda path: Reporter(str(path), True).store("sample", report=few.report.to_dict())


@writer(".png")
def spectrum(surface, few):
    places = np.random.default_rng(1).random((20, 2))
    return lambda path: analyze.draw(path, None, places, 1, True)


def sizes(whole: int, most: int) -> list[int]:
    """From none to one byte less than all."""
    return sorted({*range(0, whole, max(1, whole // most)), whole - 1})


@pytest.mark.parametrize("name", WRITERS)
def test_the_file_is_as_it_was_wherever_the_disk_is_full(tmp_path, surface, few, name):
    path = tmp_path / f"out.{name.rpartition('.')[2]}"
    write = WRITERS[name](surface, few)
    write(path)
    whole = path.read_bytes()
    path.write_bytes(b"before")
    for size in sizes(len(whole), SLOW.get(name, MOST)):
        with pytest.raises(OSError, match=path.name) as caught, full_after(size):
            write(path)
        assert isinstance(caught.value, dapple.FileError) or caught.value.filename == str(path)
        assert path.read_bytes() == b"before", size
        assert list(tmp_path.iterdir()) == [path], size
    with full_after(len(whole)):
        write(path)
    assert path.read_bytes() == whole


def test_tiles_go_on_where_the_disk_was_full(tmp_path):
    def make(folder: str) -> Tiles:
        return sample_tiles(hills(), tmp_path / folder, 8_000, tile=TILE)

    make("whole")
    largest = max(path.stat().st_size for path in (tmp_path / "whole").glob("*/*"))
    for size in (0, 500, largest // 3, largest - 1):
        with pytest.raises(OSError, match="File too large") as caught, full_after(size):
            make("stopped")
        assert str(tmp_path / "stopped") in caught.value.filename
        assert not list((tmp_path / "stopped").rglob("*.part"))
    make("stopped")
    assert contents(tmp_path / "stopped") == contents(tmp_path / "whole")


def test_a_mesh_is_sorted_where_the_disk_was_full(tmp_path):
    vertices, faces = shapes.torus(60, 30)
    np.savez(tmp_path / "torus.npz", vertices=vertices, faces=faces)
    folder = tmp_path / "sorted"
    open_surface(tmp_path / "torus.npz", folder)
    whole = {path.name: path.read_bytes() for path in folder.iterdir()}
    shutil.rmtree(folder)
    largest = max(map(len, whole.values()))
    for size in sizes(largest, 40):
        with pytest.raises(OSError, match="File too large"), full_after(size):
            open_surface(tmp_path / "torus.npz", folder)
        assert [path.name for path in tmp_path.iterdir()] == ["torus.npz"]
    open_surface(tmp_path / "torus.npz", folder)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == whole
