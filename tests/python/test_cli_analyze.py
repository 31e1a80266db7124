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
    flat = dapple.sample_planar(dapple.Plane(1, 1), 100).positions
    np.savetxt(path, flat[:, :2], delimiter=",", fmt="%.17g")
    found = done("analyze", path, "--plot", picture, "--json", "-")
    assert json.loads(found.stdout)["report"]["spacing"] == pytest.approx(0.107457, rel=1e-5)
    assert picture.read_bytes().startswith(b"\x89PNG")
