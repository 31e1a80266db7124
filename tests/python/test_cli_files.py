# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line does to files: whole or not at all, and never to a device."""

import os
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done, refused, run
from dapple3d import stippling
from dapple3d.cli import points
from dapple3d.extras import gltf, godot, usd
from dapple3d.writing import replacing
from full_disk import full_after, limit_files
from PIL import Image

posix = pytest.mark.skipif(
    not find_spec("resource"), reason="Windows limits no file and has other pipes, links"
)
SMALL = 300  # largest file on the "full disk", in bytes


def on_a_full_disk(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run `dapple` where no file can grow beyond SMALL bytes, nor one of bytecode."""
    call = [sys.executable, "-B", "-m", "dapple3d", *map(str, arguments)]
    return subprocess.run(
        call,
        capture_output=True,
        text=True,
        preexec_fn=lambda: limit_files(SMALL),
        check=False,
    )


@pytest.fixture
def picture(tmp_path) -> Path:
    path = tmp_path / "picture.png"
    Image.fromarray(np.tile(np.arange(0, 200, 10, np.uint8), (20, 1))).save(path)
    return path


@pytest.fixture
def motion(tmp_path, mesh) -> Path:
    path = tmp_path / "motion.npz"
    np.savez(path, vertices=np.stack([mesh[0], 1.1 * mesh[0]]), faces=mesh[1])
    return path


def folder_of(path: Path) -> list[str]:
    return sorted(entry.name for entry in path.parent.iterdir())


OUTPUTS = [
    *(("sample", suffix) for suffix in (".ply", ".csv", ".npz", ".obj", ".off")),
    *(("mosaic", suffix) for suffix in (".ply", ".obj", ".off", ".stl", ".npz")),
    *(("remesh", suffix) for suffix in (".ply", ".obj", ".off", ".stl", ".npz")),
    *(("stipple", suffix) for suffix in (".png", ".svg", ".pdf")),
    ("track", ".npz"),
    *(("sample", suffix) for suffix in usd.SUFFIXES if find_spec("pxr")),
    *(("sample", suffix) for suffix in (*gltf.SUFFIXES, *godot.SUFFIXES)),
    ("json", ".json"),
]


@posix
@pytest.mark.parametrize(("verb", "suffix"), OUTPUTS)
def test_a_full_disk_leaves_what_was_there(tmp_path, torus, picture, motion, verb, suffix):
    out = tmp_path / f"out{suffix}"
    out.write_text("before")
    calls = {
        "sample": ["sample", torus, out, "-n", 40],
        "mosaic": ["mosaic", torus, out, "-n", 40],
        "remesh": ["remesh", torus, out, "-n", 40],
        "stipple": ["stipple", picture, out, "-n", 60],
        "track": ["track", motion, out, "-n", 20],
        "json": ["analyze", torus, "--mesh", torus, "--json", out],
    }
    before = folder_of(out)
    found = on_a_full_disk(*calls[verb])
    assert found.returncode == 1
    words = " could not be written" if verb == "remesh" and suffix != ".npz" else ""
    assert found.stderr == f"Error: {out}{words}: File too large\n"
    assert out.read_text() == "before"
    assert folder_of(out) == before


@posix
def test_a_picture_of_dots_leaves_what_was_there(tmp_path):
    dots = stippling.stipple(np.full((20, 20), 0.5), 100)
    out = tmp_path / "dots.svg"
    out.write_text("before")
    with pytest.raises(OSError, match="File too large") as error, full_after(SMALL):
        stippling.write(dots, out)
    assert error.value.filename == str(out)
    assert out.read_text() == "before"
    assert folder_of(out) == ["dots.svg"]


@posix
def test_what_is_no_regular_file_is_written_into(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        with replacing(pipe) as file:
            file.write(b"hello")
        assert os.read(reader, 10) == b"hello"
    finally:
        os.close(reader)
    assert pipe.is_fifo()
    assert folder_of(pipe) == ["pipe"]


@posix
def test_a_report_into_a_pipe(tmp_path, torus):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    done("sample", torus, tmp_path / "points.csv", "-n", 10, "--json", pipe)
    assert pipe.is_fifo()
    assert os.read(reader, 1 << 16).startswith(b"{")
    os.close(reader)


@posix
def test_a_link_stays_one(tmp_path, torus):
    (tmp_path / "there.csv").write_text("before")
    link = tmp_path / "link.csv"
    link.symlink_to("there.csv")
    done("sample", torus, link, "-n", 10)
    assert link.is_symlink()
    assert (tmp_path / "there.csv").read_text().startswith("x,y,z")


def test_npz_files_are_those_of_numpy(tmp_path, torus):
    done("sample", torus, tmp_path / "points.npz", "-n", 10)
    arrays = dict(np.load(tmp_path / "points.npz"))
    np.savez(tmp_path / "numpy.npz", **arrays)
    assert (tmp_path / "points.npz").read_bytes() == (tmp_path / "numpy.npz").read_bytes()


@pytest.mark.parametrize("column", ["id", "class"])
@pytest.mark.parametrize("bad", ["3000000000", "-2147483649", "1.5", "nan", "1e300"])
def test_columns_of_whole_numbers_hold_whole_numbers(tmp_path, torus, column, bad):
    path = tmp_path / "points.csv"
    path.write_text(f"x,y,z,{column}\n1.4,0,0,7\n1,0,0.4,{bad}\n")
    for command in (
        ("analyze", path, "--mesh", torus),
        ("mosaic", torus, tmp_path / "tiles.ply", "--points", path),
    ):
        said = refused(*command)
        assert f"{path}: {column} of point 1 is {float(bad):.17g}" in said


@pytest.mark.parametrize("column", ["id", "class"])
@pytest.mark.parametrize("good", [2147483647, -2147483648])
def test_columns_of_whole_numbers_keep_every_digit(tmp_path, column, good):
    path = tmp_path / "points.csv"
    path.write_text(f"x,y,z,{column}\n1.4,0,0,7\n1,0,0.4,{good}\n")
    found = points.read_points(path)
    values = found.ids if column == "id" else found.classes
    assert values is not None
    assert values.tolist() == [7, good]


@pytest.mark.parametrize("name", ["ids", "classes"])
def test_arrays_of_whole_numbers_hold_whole_numbers(tmp_path, torus, name):
    path = tmp_path / "points.npz"
    np.savez(path, positions=[[1.4, 0, 0], [1, 0, 0.4]], **{name: [0.0, 1.5]})
    assert f"{path}: {name} of point 1 is 1.5" in refused("analyze", path, "--mesh", torus)


@pytest.mark.parametrize("number", ["-1", "4097", "2147483648", "1" * 400])
@pytest.mark.parametrize(
    "verb", ["sample", "mosaic", "remesh", "classes", "track", "stipple", "analyze"]
)
def test_threads_out_of_range_are_bad_usage(tmp_path, torus, picture, motion, verb, number):
    calls = {
        "sample": [torus, tmp_path / "out.ply", "-n", 10],
        "mosaic": [torus, tmp_path / "out.ply", "-n", 10],
        "remesh": [torus, tmp_path / "out.ply", "-n", 10],
        "classes": [torus, tmp_path / "out.ply", "--class", 10],
        "track": [motion, tmp_path / "out.npz", "-n", 10],
        "stipple": [picture, tmp_path / "out.svg", "-n", 10],
        "analyze": [torus, "--mesh", torus],
    }
    found = run(verb, *calls[verb], "--threads", number)
    assert found.exit_code == 2
    assert "0<=x<=4096" in found.stderr


@pytest.mark.parametrize("count", ["100000001", "2147483648", "1" * 400])
def test_counts_out_of_range_are_bad_usage(tmp_path, torus, count):
    found = run("sample", torus, tmp_path / "out.ply", "-n", count)
    assert found.exit_code == 2
    assert "1<=x<=100000000" in found.stderr


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("normals", np.zeros((2, 3), "U3"), "normals is str96 (2, 3): numbers (2, 3) are needed"),
        ("normals", np.zeros((2, 2)), "normals is float64 (2, 2): numbers (2, 3) are needed"),
        ("scales", np.zeros(2), "scales is float64 (2,): numbers (2, 3) are needed"),
        ("orientations", np.zeros((2, 3)), "orientations is float64 (2, 3): numbers (2, 4) are"),
        ("classes", np.zeros(0, np.int32), "classes has the shape (0,): 2 rows are needed"),
        ("ids", np.array(1), "ids has the shape (): 2 rows are needed"),
    ],
)
@pytest.mark.parametrize("frames", [None, 3])
def test_arrays_of_points_have_their_type_and_shape(tmp_path, name, values, said, frames):
    positions = np.zeros((2, 3))
    path = tmp_path / "points.npz"
    if frames:
        np.savez(path, positions=[positions] * frames, **{name: values})
    else:
        np.savez(path, positions=positions, **{name: values})
    assert f"{path}: {said}" in refused("export", path, tmp_path / "out.csv")


def test_times_are_numbers(tmp_path):
    path = tmp_path / "points.npz"
    np.savez(path, positions=np.zeros((2, 4, 3)), times=np.array(["a", "b"]))
    assert f"{path}: times is str32 (2,)" in refused("export", path, tmp_path / "out.usda")


@pytest.mark.parametrize("verb", ["sample", "analyze"])
def test_what_is_no_array_in_an_npz_is_left_out(tmp_path, mesh, verb):
    path = tmp_path / "mesh.npz"
    np.savez(path, faces=mesh[1])
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("vertices.npy", b"no array")
        archive.writestr("positions.npy", b"no array")
    call = {"sample": [tmp_path / "out.ply", "-n", 10], "analyze": []}[verb]
    name = {"sample": "vertices", "analyze": "positions"}[verb]
    assert f"{path}: has no array '{name}', only 'faces'" in refused(verb, path, *call)


@pytest.mark.parametrize("header", [b"{'descr': ''", b"{'descr': (((", b"\0", b"{'shape': (1.5,)"])
def test_npz_with_a_wrong_header_is_refused(tmp_path, header):
    path = tmp_path / "points.npz"
    with zipfile.ZipFile(path, "w") as archive:
        said = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header
        archive.writestr("positions.npy", said)
    assert f"{path}: could not be read as npz: " in refused("analyze", path)


def test_a_whole_number_of_a_ply_is_finite(tmp_path):
    path = tmp_path / "points.ply"
    header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty int id\nproperty float x\n"
    path.write_text(f"{header}property float y\nend_header\ninf 0 0\n")
    assert f"{path}: vertex 0 is not 3 numbers: b'inf 0 0'" in refused("analyze", path)


def test_a_field_of_a_csv_has_an_end(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text('x,y\n1,"' + "2" * 140_000)
    assert f"{path}: is no CSV: field larger than field limit" in refused("analyze", path)


def test_meshes_that_crashed_readers_are_refused(tmp_path):
    word = tmp_path / "word.off"
    word.write_text("COFF\n1 0 0\nx\n")
    assert f"{word}: line 3" in refused("sample", word, tmp_path / "out.ply", "-n", 10)
    orphan = tmp_path / "orphan.ply"
    orphan.write_text("ply\nformat ascii 1.0\nproperty float x\nend_header\n")
    with pytest.raises(dapple.FileError, match=r"orphan.ply: line 3 of its header is wrong"):
        dapple.read_mesh(orphan)
