# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple3d.sample_lines and the command `dapple lines`: points along creases and borders."""

import json

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done, refused


def sheet() -> dapple.Surface:
    return dapple.Surface(*shapes.grid(6))


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "sheet.ply"
    dapple.write_mesh(path, *shapes.grid(6))
    return path


def test_puts_as_many_on_the_border_as_asked():
    made = dapple.sample_lines(sheet(), 50)
    assert len(made) == len(made.samples) == made.samples.report.count == 50
    assert len(made.lengths) == 4
    low, high = sheet().vertices.min(axis=0), sheet().vertices.max(axis=0)
    on = np.isclose(made.samples.positions, low) | np.isclose(made.samples.positions, high)
    assert on[:, :2].any(axis=1).all()
    assert set(made.lines) == {0, 1, 2, 3}


def test_samples_move_with_the_surface():
    surface = sheet()
    made = dapple.sample_lines(surface, 20).samples
    moved = surface.deformed(2.0 * surface.vertices)
    again = dapple.Samples(moved, made.faces, made.barycentric, ids=made.ids)
    np.testing.assert_allclose(again.positions, 2.0 * made.positions, atol=1e-12)


def test_a_polyline_is_its_edges():
    surface = sheet()
    x, y = surface.vertices[:, 0], surface.vertices[:, 1]
    row = np.flatnonzero(np.isclose(y, np.unique(y)[3]))
    row = row[np.argsort(x[row])]
    edges = np.stack([row[:-1], row[1:]], axis=1)
    made = dapple.sample_lines(surface, 30, borders=False, corners=True, edges=edges)
    np.testing.assert_allclose(made.samples.positions[:, 1], np.unique(y)[3], atol=1e-12)
    np.testing.assert_allclose(np.diff(np.sort(made.samples.positions[:, 0])), np.ptp(x) / 29)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"edges": [[0, 999]]}, r"edges\[0\] is \(0, 999\): no face has this edge"),
        ({"edges": [0, 1]}, "edges has the shape"),
        ({"line_spacing": "odd"}, "line_spacing is 'odd'"),
        ({"count": 0}, "count is 0"),
        ({"borders": False}, "surface has no lines"),
        ({"count": 3, "corners": True}, "count is 3: there are 4 corners"),
    ],
)
def test_names_what_is_wrong(given, message):
    with pytest.raises(ValueError, match=message):
        dapple.sample_lines(sheet(), **{"count": 50, **given})


def test_stops_when_cancelled():
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.sample_lines(sheet(), 50, context=context)


def test_the_command_writes_what_python_makes(tmp_path, file):
    out = tmp_path / "posts.npz"
    found = done("lines", file, out, "-n", 40, "--corners", "--line-spacing", "natural")
    assert "40 points on 4 lines" in found.stdout
    mesh = dapple.read_mesh(file)
    made = dapple.sample_lines(
        dapple.Surface(mesh.vertices, mesh.faces), 40, corners=True, line_spacing="natural"
    )
    with np.load(out) as written:
        np.testing.assert_array_equal(written["positions"], made.samples.positions)
        np.testing.assert_array_equal(written["tangents"], made.tangents)
        np.testing.assert_array_equal(written["lines"], made.lines)


@pytest.mark.parametrize("suffix", [".csv", ".ply", ".obj"])
def test_the_command_knows_the_formats(tmp_path, file, suffix):
    out = tmp_path / f"posts{suffix}"
    done("lines", file, out, "-n", 12)
    assert out.stat().st_size > 0


def test_a_distance_stands_for_a_number(tmp_path, file):
    length = dapple.sample_lines(sheet(), 1).lengths.sum()
    found = done("lines", file, tmp_path / "p.csv", "--spacing", length / 77, "--json", "-", "-q")
    written = json.loads(found.stdout)
    assert written["settings"]["count"] == 77
    assert written["report"]["spacing"] == pytest.approx(written["length"] / 77)


def test_the_command_refuses_a_mesh_without_lines(tmp_path, file):
    out = tmp_path / "p.csv"
    assert "has no lines" in refused("lines", file, out, "-n", 9, "--no-borders")
    assert not out.exists()
