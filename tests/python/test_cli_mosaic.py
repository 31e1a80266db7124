# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple mosaic: what it writes, what it says, and what it refuses."""

import json
import re
import struct

import dapple3d as dapple
import numpy as np
import pytest
from click.testing import CliRunner, Result
from dapple3d.cli.app import main


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, ["mosaic", *map(str, arguments)])


def done(*arguments: object) -> Result:
    found = run(*arguments)
    assert found.exit_code == 0, found.output
    return found


def expected(surface, count=40, **options):
    samples = dapple.sample(surface, count)
    return dapple.mosaic(surface, samples, grout=0.1 * samples.report.spacing, **options)


def polygons(made):
    return [row.tolist() for row in np.split(made.corners, made.starts[1:-1])]


def read_ply(path):
    """Vertices, and per polygon its corners and (cell, class, side)."""
    header, body = path.read_bytes().split(b"end_header\n")
    vertex, face = (int(line.split()[2]) for line in header.splitlines() if b"element" in line)
    assert header.splitlines()[-3:] == [
        b"property int cell",
        b"property int class",
        b"property int side",
    ]
    vertices = np.frombuffer(body, "<f8", 3 * vertex).reshape(-1, 3)
    numbers = np.frombuffer(body[24 * vertex :], "<i4").tolist()
    rows = []
    for _ in range(face):
        corners = numbers[0]
        rows.append((numbers[1 : 1 + corners], numbers[1 + corners : 4 + corners]))
        numbers = numbers[4 + corners :]
    assert not numbers
    return vertices, rows


def test_ply(tmp_path, torus, surface):
    out = tmp_path / "tiles.ply"
    done(torus, out, "-n", 40, "--thickness", 0.01)
    made = expected(surface, thickness=0.01)
    vertices, rows = read_ply(out)
    np.testing.assert_array_equal(vertices, made.vertices)
    assert [corners for corners, _ in rows] == polygons(made)
    more = np.column_stack([made.sites, made.classes, made.sides]).tolist()
    assert [row for _, row in rows] == more


def test_ply_is_read_by_others(tmp_path, torus):
    out = tmp_path / "tiles.ply"
    done(torus, out, "-n", 40)
    vertices, faces = dapple.read_mesh(out)
    assert len(faces) > 40
    assert len(np.unique(faces)) == len(vertices)


def test_off_and_obj(tmp_path, torus, surface):
    made = expected(surface)
    for suffix in (".off", ".obj"):
        out = tmp_path / f"tiles{suffix}"
        done(torus, out, "-n", 40)
        vertices, faces = dapple.read_mesh(out)
        np.testing.assert_array_equal(vertices, made.vertices)
        assert len(faces) == sum(len(row) - 2 for row in polygons(made))
    lines = (tmp_path / "tiles.obj").read_text().splitlines()
    assert [line for line in lines if line.startswith("g ")] == [f"g cell_{k}" for k in range(40)]
    assert [line for line in lines if line.startswith("usemtl")] == ["usemtl class_0"]


def test_stl_has_the_area_of_the_tiles(tmp_path, torus, surface):
    out = tmp_path / "tiles.stl"
    done(torus, out, "-n", 40)
    content = out.read_bytes()
    (count,) = struct.unpack_from("<I", content, 80)
    assert len(content) == 84 + 50 * count
    vertices, faces = dapple.read_mesh(out)
    assert len(faces) == count
    area = dapple.Surface(vertices, faces).area
    assert area == pytest.approx(expected(surface).areas.sum(), rel=1e-4)


def test_npz(tmp_path, torus, surface):
    out = tmp_path / "tiles.npz"
    done(torus, out, "-n", 40)
    made = expected(surface)
    with np.load(out) as stored:
        for name in ("vertices", "corners", "starts", "classes", "sides", "areas", "loops"):
            np.testing.assert_array_equal(stored[name], getattr(made, name))
        np.testing.assert_array_equal(stored["cells"], made.sites)


def test_tiles_around_points_of_a_file(tmp_path, torus, surface):
    samples = dapple.sample_classes(surface, [dapple.SampleClass(20), dapple.SampleClass(10)])
    points, out = tmp_path / "points.npz", tmp_path / "tiles.npz"
    ids = samples.ids + 100
    names = ("positions", "faces", "barycentric", "classes")
    np.savez(points, ids=ids, **{name: getattr(samples, name) for name in names})
    done(torus, out, "--points", points, "--grout", 0)
    made = dapple.mosaic(surface, samples)
    with np.load(out) as stored:
        np.testing.assert_array_equal(stored["corners"], made.corners)
        np.testing.assert_array_equal(stored["cells"], ids[made.sites])
        np.testing.assert_array_equal(stored["classes"], made.classes)


def test_points_without_faces_are_bound_where_the_mesh_is_nearest(tmp_path, torus, surface):
    points, out = tmp_path / "points.csv", tmp_path / "tiles.npz"
    samples = dapple.sample(surface, 12)
    rows = "\n".join(",".join(map(repr, p)) for p in samples.positions.tolist())
    points.write_text(f"x,y,z\n{rows}\n")
    done(torus, out, "--points", points, "--grout", 0)
    with np.load(out) as stored:
        np.testing.assert_allclose(stored["areas"], dapple.mosaic(surface, samples).areas)


def test_reports(tmp_path, torus, surface):
    found = done(torus, tmp_path / "tiles.ply", "-n", 40, "--json", "-")
    report = json.loads(found.stdout)
    assert report["command"] == "mosaic"
    assert report["settings"]["count"] == 40
    assert report["settings"]["grout"] == pytest.approx(0.1 * surface.spacing(40))
    tiles = report["tiles"]
    assert tiles["cell_area"] == pytest.approx(surface.area)
    assert 0.7 < tiles["area"] / tiles["cell_area"] < 0.9
    assert tiles["with_one_loop"] == 40
    assert tiles["lost_to_the_grout"] == 0


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["tiles.ply"], 2, "Missing option '-n' / '--count', '--spacing' or '--points'."),
        (["tiles.ply", "-n", 5, "--points", "torus.ply"], 2, "give only one of --count"),
        (["tiles.txt", "-n", 5], 1, "unknown format '.txt'; tiles are written as .ply, .obj"),
        (["tiles.ply", "-n", 5, "--grout", -1], 2, "'--grout'"),
        (["torus.ply", "-n", 5], 1, "is read as an input"),
    ],
)
def test_refuses(tmp_path, monkeypatch, torus, arguments, code, message):
    monkeypatch.chdir(tmp_path)
    found = run(torus, *arguments)
    assert found.exit_code == code, found.output
    assert message in found.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["torus.ply"]


def test_tiles_that_are_all_empty_are_not_written(torus, tmp_path):
    out = tmp_path / "tiles.ply"
    found = run(torus, out, "-n", 40, "--grout", 9)
    assert found.exit_code == 1
    assert "all 40 tiles are empty, so it was not written: the grout of 9 is wider" in found.output
    assert not out.exists()


def test_tiles_that_are_empty_are_counted(torus, tmp_path):
    found = done(torus, tmp_path / "tiles.ply", "-n", 40, "--grout", 0)
    assert "are empty" not in found.output
    places = dapple.read_mesh(torus).vertices[::9]
    near = places[0] + 1e-3 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0]])
    np.savetxt(tmp_path / "points.csv", np.concatenate([near, places[1:31]]), delimiter=",")
    given = ("--points", tmp_path / "points.csv", "--grout", 0.1)
    found = done(torus, tmp_path / "tiles.ply", *given)
    counted = re.search(r"tiles\.ply: (\d+) of 35 tiles are empty: the grout of 0\.1", found.output)
    assert counted
    assert int(counted[1]) >= 1
    assert "Warning" not in found.output
