# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array
from shapes import grid


def test_keeps_every_digit(tmp_path, mesh):
    vertices = mesh[0] / 3 + [1e7, 1e-9, 0]
    path = tmp_path / "a mesh \u00e9.ply"
    dapple.write_mesh(path, vertices, mesh[1])
    found = dapple.read_mesh(path)
    check_array(found[0], np.float64, vertices.shape)
    check_array(found[1], np.int32, mesh[1].shape)
    np.testing.assert_array_equal(found[0], vertices)
    np.testing.assert_array_equal(found[1], mesh[1])


def test_takes_text_paths(tmp_path):
    vertices, faces = grid(2)
    dapple.write_mesh(str(tmp_path / "grid.obj"), vertices, faces)
    np.testing.assert_array_equal(dapple.read_mesh(str(tmp_path / "grid.obj"))[1], faces)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("absent.ply", None),
        ("empty.ply", ""),
        ("words.obj", "hello\n"),
        ("mesh.strange", "v 0 0 0\n"),
        ("half.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
    ],
)
def test_names_a_file_it_cannot_read(tmp_path, name, text):
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(dapple.FileError, match=name):
        dapple.read_mesh(tmp_path / name)


def test_names_a_file_it_cannot_write(tmp_path):
    with pytest.raises(dapple.FileError, match="absent"):
        dapple.write_mesh(tmp_path / "absent" / "mesh.ply", *grid(1))


def test_writes_only_surfaces(tmp_path):
    vertices, faces = grid(2)
    vertices[3, 1] = np.nan
    with pytest.raises(dapple.SurfaceError, match=r"vertices\[3\]"):
        dapple.write_mesh(tmp_path / "mesh.ply", vertices, faces)
    assert not (tmp_path / "mesh.ply").exists()


def test_errors_are_of_their_kind():
    assert issubclass(dapple.FileError, OSError)
    assert issubclass(dapple.SurfaceError, ValueError)
    assert issubclass(dapple.Cancelled, RuntimeError)
