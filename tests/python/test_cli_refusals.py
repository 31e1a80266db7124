# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input of the command line: each error names the file or option and the reason."""

import os
import re
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import refused, run

BAD_POINTS = {
    "many.csv": ("1,2,3,4\n1,2,3,4\n", "4 columns and no names"),
    "more.csv": ("x,y,z\n1,2,3\n1,2,3,4\n", "line 3 has 4 columns: 3 are needed"),
    "word.csv": ("x,y,z\n0,0,0\n0,zero,0\n", "line 3 holds no number: 'zero'"),
    "nameless.csv": ("a,b\n0,0\n", "columns a, b: x, y"),
    "twice.csv": ("x,x,y\n0,0,0\n", "names a column twice"),
    "empty.csv": ("", "is empty"),
    "none.csv": ("x,y\n", "holds no points"),
    "far.csv": ("0,0\n0.5,1.5\n", r"point 1 is \[0.5, 1.5, 0.0\].*unit square"),
    "nan.csv": ("0,0\nnan,0.5\n", r"point 1 is \[nan"),
    "torn.npz": ("PK", "could not be read as npz"),
    "text.npz": ("hello", "could not be read as npz"),
    "text.ply": ("hello", "does not begin with 'ply'"),
    "endless.ply": ("ply\nformat ascii 1.0\n", "header has no end"),
    "strange.ply": ("ply\nformat utf9 1.0\nend_header\n", "line 2 of its header is wrong"),
    "short.ply": (
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
        "end_header\n0 0\n",
        "vertex 1 is not 2 numbers",
    ),
    "half.ply": (
        "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nend_header\n"
        "12345678901",
        "ends after 1 of 2",
    ),
    "minus.ply": (
        "ply\nformat ascii 1.0\nelement vertex -2\nproperty float x\nend_header\n",
        "line 3 of its header is wrong",
    ),
    "vast.ply": (
        "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n",
        "too short for 99999999999 'vertex'",
    ),
    "list.ply": (
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n",
        "has a list",
    ),
    "bytes.csv": ("x,y\n0,\0\n", "holds no number"),
    "faces.ply": ("ply\nformat ascii 1.0\nelement face 0\nend_header\n", "no element 'vertex'"),
    "short.off": ("OFF\n2 0 0\n0 0 0\n", "ends after 1 of 2 vertices"),
    "word.off": ("FOFF\n", "does not begin with OFF"),
    "flat.obj": ("v 0 0 0\nv 0 0\n", "line 2 has 2 columns"),
    "points.xyz": ("0 0 0\n", "unknown format '.xyz'"),
}


@pytest.mark.parametrize("name", BAD_POINTS)
def test_refuses_points(tmp_path, name):
    text, message = BAD_POINTS[name]
    (tmp_path / name).write_text(text)
    said = refused("analyze", tmp_path / name)
    assert name in said
    assert re.search(message, said), said


def test_refuses_points_nowhere_near(tmp_path, torus):
    path = tmp_path / "far.csv"
    path.write_text("1,0,0\n1e300,0,0\n")
    assert f"{path}: point 1 is too far" in refused("analyze", path, "--mesh", torus)


@pytest.mark.parametrize(
    "content", ["positions", "single", "objects", "words", "columns", "classes"]
)
def test_refuses_archives(tmp_path, content):
    path = tmp_path / "points.npz"
    flat = np.full((3, 2), 0.5)
    match content:
        case "positions":
            np.savez(path, places=flat)
        case "single":
            with path.open("wb") as file:
                np.save(file, flat)
        case "objects":
            np.savez(path, positions=np.array([None, {}], dtype=object))
        case "words":
            np.savez(path, positions=flat.astype(str))
        case "columns":
            np.savez(path, positions=np.hstack([flat, flat]))
        case "classes":
            np.savez(path, positions=flat, classes=np.array([0, 1]))
    assert refused("analyze", path).startswith(f"Error: {path}: ")


def bad_mesh(folder: Path, name: str) -> Path:
    vertices, faces = shapes.grid(2)
    path = folder / f"{name}.npz"
    match name:
        case "nan":
            vertices[3, 1] = np.nan
        case "index":
            faces[2, 0] = 99
        case "columns":
            vertices = np.column_stack([vertices, vertices])
        case "words":
            vertices = vertices.astype(str)
        case "number":
            faces = np.array(3)
        case "motion":
            vertices = np.stack([vertices] * 2)
    named = {"corners" if name == "names" else "vertices": vertices, "faces": faces}
    np.savez(path, **named)
    return path


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nan", r"vertices\[3\] is not finite: coordinate 1 is nan"),
        ("index", r"faces\[2\].*99"),
        ("columns", r"vertices.*\(9, 6\)"),
        ("words", "vertices"),
        ("number", r"faces \(\) are not .* \(m, 3\)"),
        ("motion", r"vertices.*\(2, 9, 3\)"),
        ("names", "no array 'vertices', only 'corners', 'faces'"),
    ],
)
def test_refuses_meshes(tmp_path, name, message):
    path, out = bad_mesh(tmp_path, name), tmp_path / "points.ply"
    said = refused("sample", path, out, "-n", 10)
    assert said.startswith(f"Error: {path}: ")
    assert re.search(message, said), said
    assert os.listdir(tmp_path) == [path.name]


def test_refuses_broken_files(tmp_path):
    path, out = tmp_path / "mesh.obj", tmp_path / "points.ply"
    path.write_text("hello\n")
    assert str(path) in refused("sample", path, out, "-n", 10)
    path = tmp_path / "mesh.ply"
    path.write_text("ply\nformat ascii 1.0\nproperty float x\nend_header\n")
    assert f"{path}: line 3 of its header" in refused("sample", path, out, "-n", 10)
    assert not out.exists()


def test_a_file_of_another_program_is_told_which_ones_are_read(tmp_path):
    path = tmp_path / "crate.FBX"
    path.write_bytes(b"Kaydara FBX Binary")
    said = refused("sample", path, tmp_path / "points.ply", "-n", 10)
    known = ".ply, .obj, .stl, .off, .glb, .gltf"
    assert f"{path} has the suffix '.fbx': supported are {known} and .npz" in said
    with pytest.raises(dapple.FileError, match=r"supported are \.ply, \.obj, .* \.glb and \.gltf"):
        dapple.read_mesh(path)


@pytest.mark.parametrize(
    ("density", "message"),
    [
        ("short", r"'short': has the shape \(7,\): \(800,\) at vertices or .* is needed"),
        ("negative", r"'negative': density\[0\].*-1"),
        ("absent", "no density 'absent' .it has smooth, half, jumps"),
        ("absent.npy", "absent.npy: No such file"),
    ],
)
def test_refuses_densities(tmp_path, archive, density, message):
    out = tmp_path / "points.ply"
    said = refused("sample", archive, out, "-n", 10, "--density", density)
    assert re.search(message, said), said
    assert not out.exists()


@pytest.mark.parametrize(
    ("out", "message"),
    [
        ("points.stl", "STL holds triangles, no points; points are written as .ply, .csv"),
        ("points.txt", "unknown format '.txt'"),
        ("points", "points: has no extension; points are written as .ply, .csv"),
        ("torus.ply", "is read as an input"),
        ("absent/points.ply", "the folder .*absent does not exist"),
        ("folder.ply", "is a folder that exists already"),
    ],
)
def test_refuses_outputs(tmp_path, torus, out, message):
    (tmp_path / "folder.ply").mkdir()
    before = torus.read_bytes()
    said = refused("sample", torus, tmp_path / out, "-n", 10)
    assert re.search(message, said), said
    assert torus.read_bytes() == before


def test_refuses_one_file_for_two_outputs(tmp_path, torus):
    out = tmp_path / "points.csv"
    assert "two outputs" in refused("sample", torus, out, "-n", 10, "--json", out)
    assert "read as an input" in refused("sample", torus, out, "-n", 10, "--json", torus)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sample", "absent.ply", "out.ply", "-n", "10"], "'absent.ply' does not exist"),
        (["sample", "{mesh}", "out.ply"], "Missing option '-n'"),
        (["sample", "{mesh}", "out.ply", "-n", "0"], "0 is not in the range"),
        (["sample", "{mesh}", "out.ply", "-n", "ten"], "'ten' is not a valid integer"),
        (["sample", "{mesh}", "out.ply", "-n", "10", "--start", "grid"], "'grid' is not one of"),
        (["sample", "{mesh}", "out.ply", "-n", "10", "--seed", "-1"], "-1 is not in the range"),
        (["sample", "{mesh}", "out.ply", "-n", "10", "--tolerance", "nan"], "nan is not a number"),
        (["classes", "{mesh}", "out.ply"], "Missing option '--class'"),
        (["classes", "{mesh}", "out.ply", "--class", "9:size=1"], "'size=1': radius=R"),
        (["classes", "{mesh}", "out.ply", "--class", "9:radius=big"], "'big' is not a valid float"),
        (["classes", "{mesh}", "out.ply", "--class", "0"], "0 is not in the range"),
        (["track", "{mesh}", "out.npz", "-n", "9", "--closed"], "need --together"),
        (["analyze", "{mesh}", "--density", "x"], "need --mesh"),
        (["stretch"], "No such command 'stretch'"),
    ],
)
def test_refuses_usage(tmp_path, monkeypatch, torus, arguments, message):
    monkeypatch.chdir(tmp_path)
    found = run(*[argument.format(mesh=torus) for argument in arguments])
    assert found.exit_code == 2
    assert message in found.stderr
    assert os.listdir(tmp_path) == [torus.name]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--capacity-weight", "inf"], "capacity_weight is inf"),
        (["--tolerance", "inf"], "tolerance is inf"),
    ],
)
def test_refuses_what_the_library_refuses(tmp_path, torus, options, message):
    assert message in refused("sample", torus, tmp_path / "out.ply", "-n", 10, *options)
    assert os.listdir(tmp_path) == [torus.name]
