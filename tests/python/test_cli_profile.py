# SPDX-License-Identifier: GPL-3.0-or-later
"""--profile of the commands that solve: the table on stderr, the same figures in the JSON."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import shapes
from command_line import done, run

STAGES = ["start", "neighbors", "cells", "solver", "projection", "reporting", "other"]


@pytest.fixture
def inputs(tmp_path, mesh, torus) -> dict[str, list[object]]:
    """What each command needs before its options, the last of it its output."""
    vertices, faces = mesh
    motion = tmp_path / "motion.npz"
    frames = np.stack([shapes.bent(vertices, time) for time in (0.0, 0.1)])
    np.savez(motion, vertices=frames, faces=faces)
    picture = tmp_path / "picture.png"
    pillow = pytest.importorskip("PIL.Image")
    pillow.fromarray(np.arange(0, 240, dtype=np.uint8).reshape(12, 20)).save(picture)
    points = tmp_path / "old.npz"
    done("sample", torus, points, "-n", 60, "--quiet")
    return {
        "relax": [torus, points, tmp_path / "new.npz", "--changed", "0-99"],
        "resample": [torus, points, tmp_path / "new.npz", "-n", 70],
        "sample": [torus, tmp_path / "points.ply", "-n", 60],
        "classes": [torus, tmp_path / "points.ply", "--class", 40, "--class", 20],
        "track": [motion, tmp_path / "points.npz", "-n", 60],
        "stipple": [picture, tmp_path / "dots.svg", "-n", 60],
        "mosaic": [torus, tmp_path / "tiles.ply", "-n", 60],
        "lines": [torus, tmp_path / "points.ply", "-n", 60, "--feature-angle", 1],
        "remesh": [torus, tmp_path / "even.ply", "-n", 60],
    }


def rows(table: str) -> dict[str, list[str]]:
    return {line.split()[0]: line.split()[1:] for line in table.splitlines()}


@pytest.mark.parametrize(
    "name",
    ["sample", "classes", "relax", "resample", "track", "stipple", "mosaic", "remesh", "lines"],
)
def test_prints_seconds_and_shares(inputs, name):
    table = rows(done(name, *inputs[name], "--profile", "--quiet").stderr)
    assert list(table) == ["stage", *STAGES, "all"]
    assert sum(float(table[stage][0]) for stage in STAGES) == pytest.approx(
        float(table["all"][0]), abs=0.01
    )
    assert sum(float(table[stage][1]) for stage in STAGES) == pytest.approx(100, abs=1)


@pytest.mark.parametrize("name", ["sample", "track", "stipple"])
def test_leaves_json_and_output_alone(inputs, name):
    out = Path(str(inputs[name][1]))
    document = json.loads(done(name, *inputs[name], "--json", "-").stdout)
    plain = out.read_bytes()
    found = done(name, *inputs[name], "--json", "-", "--profile")
    assert out.read_bytes() == plain
    profiled = json.loads(found.stdout)
    assert profiled.keys() == document.keys()
    reports = profiled["reports"] if name == "track" else [profiled["report"]]
    total = float(rows(found.stderr)["all"][0])
    assert total == pytest.approx(sum(one["seconds"] for one in reports), abs=0.001)
    for report in reports:
        assert list(report["profile"]) == STAGES
        assert sum(report["profile"].values()) == pytest.approx(report["seconds"])


def test_is_silent_unless_asked(inputs):
    assert done("sample", *inputs["sample"]).stderr == ""


def test_has_nothing_to_say_of_tiles_around_points_of_a_file(inputs, torus):
    done("sample", *inputs["sample"])
    mesh, out = inputs["mosaic"][:2]
    found = run("mosaic", mesh, out, "--points", inputs["sample"][1], "--profile")
    assert found.exit_code == 2
    assert re.search("--profile needs --count", found.output)
