# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple analyze: what it measures and draws."""

import json
import re

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done
from dapple3d.cli import points


def test_analyzes_points_of_a_mesh(tmp_path, torus, surface, samples):
    path, report = tmp_path / "points.csv", tmp_path / "report.json"
    points.write_points(path, points.points_of(samples))
    said = done("analyze", path, "--mesh", torus, "--json", report)
    expected = dapple.analyze(surface, samples)
    found = json.loads(report.read_text())
    assert found["report"]["alpha_min"] == pytest.approx(expected.alpha_min, rel=1e-9)
    assert found["report"]["energy"] == pytest.approx(expected.energy, rel=1e-9)
    assert found["farthest_from_surface"] < 1e-12
    assert re.search(rf"^alpha min +{expected.alpha_min:.4f} ", said.stdout, re.MULTILINE)


@pytest.fixture
def sheets(tmp_path):
    """Two squares at one place, and points of both: by place alone all are on one of them."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    path = tmp_path / "sheets.npz"
    np.savez(
        path, vertices=np.concatenate([square, square]), faces=np.concatenate([faces, faces + 4])
    )
    done("sample", path, tmp_path / "points.npz", "-n", 200, "--no-weld")
    return path


def analyzed(points, mesh, *options):
    found = done("analyze", points, "--mesh", mesh, "--json", "-", *options)
    return json.loads(found.stdout), found.stderr


def test_analyzes_points_on_the_faces_that_their_file_names(tmp_path, sheets):
    found, said = analyzed(tmp_path / "points.npz", sheets, "--no-weld")
    assert found["bound"] == "stored"
    assert found["report"]["capacity_variation"] < 0.05
    assert said == ""
    arrays = dict(np.load(tmp_path / "points.npz"))
    del arrays["faces"]
    np.savez(tmp_path / "places.npz", **arrays)
    found, said = analyzed(tmp_path / "places.npz", sheets, "--no-weld")
    assert found["bound"] == "nearest"
    assert said == ""


def test_analyzes_each_class_on_the_faces_that_its_file_names(tmp_path, sheets):
    arrays = dict(np.load(tmp_path / "points.npz"))
    arrays["classes"] = (arrays["faces"] >= 2).astype(np.int32)
    np.savez(tmp_path / "two.npz", **arrays)
    found, _ = analyzed(tmp_path / "two.npz", sheets, "--no-weld")
    assert [one["count"] for one in found["report"]["classes"]] == [100, 100]
    assert found["bound"] == "stored"


@pytest.mark.parametrize("change", ["moved", "fewer faces", "weights"])
def test_says_when_the_faces_of_points_are_those_of_another_mesh(tmp_path, sheets, change):
    arrays = dict(np.load(tmp_path / "points.npz"))
    mesh = dict(np.load(sheets))
    if change == "moved":
        mesh["vertices"] = mesh["vertices"] * [1.0, 1.1, 1.0]
    elif change == "fewer faces":
        mesh["faces"] = mesh["faces"][:2]
    else:
        arrays["barycentric"] = np.roll(arrays["barycentric"], 1, axis=0)
    np.savez(sheets, **mesh)
    np.savez(tmp_path / "points.npz", **arrays)
    found, said = analyzed(tmp_path / "points.npz", sheets, "--no-weld")
    assert found["bound"] == "nearest"
    begin = f"{tmp_path / 'points.npz'}: its faces are not those of the mesh ("
    assert said.startswith(begin)
    assert said.endswith("); each point counts where the mesh is nearest\n")
    assert said.count("\n") == 1


def test_analyzes_each_class(tmp_path, torus, surface):
    path = tmp_path / "points.ply"
    both = dapple.sample_classes(surface, [60, 30])
    points.write_points(path, points.points_of(both))
    said = done("analyze", path, "--mesh", torus)
    assert re.search(r"^points +90 +60 +30$", said.stdout, re.MULTILINE)
    found = json.loads(done("analyze", path, "--mesh", torus, "--json", "-").stdout)
    expected = dapple.analyze(surface, both.positions[both.classes == 1])
    assert found["report"]["classes"][1]["class"] == 1
    assert found["report"]["classes"][1]["energy"] == expected.energy


def test_analyzes_and_draws_points_of_the_unit_square(tmp_path):
    path, picture = tmp_path / "points.csv", tmp_path / "spectrum.png"
    flat = dapple.sample(dapple.Plane(1, 1), 100).positions
    np.savetxt(path, flat[:, :2], delimiter=",", fmt="%.17g")
    found = done("analyze", path, "--plot", picture, "--json", "-")
    assert json.loads(found.stdout)["report"]["spacing"] == pytest.approx(0.107457, rel=1e-5)
    assert picture.read_bytes().startswith(b"\x89PNG")
