# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple remesh: what it writes, what it says, and what it refuses."""

import json

import dapple3d as dapple
import numpy as np
import pytest
from click.testing import CliRunner, Result
from dapple3d.cli.app import main


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, ["remesh", *map(str, arguments)])


def done(*arguments: object) -> Result:
    found = run(*arguments)
    assert found.exit_code == 0, found.output
    return found


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl"])
def test_writes_the_mesh_that_python_makes(tmp_path, torus, surface, suffix):
    out = tmp_path / f"even{suffix}"
    assert "200 vertices, 400 triangles" in done(torus, out, "-n", 200).stdout
    made = dapple.remesh(surface, 200)
    read = dapple.read_mesh(out)
    corners = read.vertices[read.faces]
    np.testing.assert_allclose(corners, made.vertices[made.faces], atol=1e-6)


def test_npz_tells_where_vertices_lie(tmp_path, torus, surface):
    out = tmp_path / "even.npz"
    done(torus, out, "-n", 200)
    made = dapple.remesh(surface, 200)
    with np.load(out) as file:
        for name in ("vertices", "faces", "source_faces", "barycentric", "features", "lines"):
            np.testing.assert_array_equal(file[name], getattr(made, name))


def test_a_spacing_stands_for_a_count(tmp_path, torus, surface):
    spacing = surface.spacing(300)
    assert "300 vertices" in done(torus, tmp_path / "e.ply", "--spacing", spacing).stdout


def test_options_reach_the_library(tmp_path, torus, surface):
    done(torus, tmp_path / "e.ply", "-n", 150, "--feature-angle", 180, "--seed", 3)
    made = dapple.remesh(surface, 150, feature_angle=180, seed=3)
    np.testing.assert_array_equal(dapple.read_mesh(tmp_path / "e.ply").vertices, made.vertices)


def test_json_holds_settings_and_figures(tmp_path, torus):
    found = done(torus, tmp_path / "e.ply", "-n", 150, "--json", "-", "-q")
    written = json.loads(found.stdout)
    assert written["settings"]["feature_angle"] == 30
    assert written["mesh"]["vertices"] == written["settings"]["count"] == 150
    assert written["mesh"]["flaws"] == 0


def test_says_how_many_more_the_topology_needs(tmp_path, torus):
    found = done(torus, tmp_path / "e.ply", "-n", 3)
    assert "more than asked for" in found.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["{out}.xyz", "-n", 10], "unknown format '.xyz'; meshes are written as"),
        (["{out}.ply"], "Missing option '-n'"),
        (["{out}.ply", "-n", 10, "--spacing", 1], "give either --count or --spacing"),
        (["{out}.ply", "-n", 10, "--feature-angle", 190], "not in the range 0"),
        (["{out}.ply", "-n", 10, "--non-manifold", "x"], "'x' is not one of"),
    ],
)
def test_names_what_is_wrong(tmp_path, torus, arguments, message):
    given = [str(a).format(out=tmp_path / "out") for a in arguments]
    found = run(torus, *given)
    assert found.exit_code != 0
    assert message in found.output
    assert not list(tmp_path.glob("out*"))


def test_tells_how_near_it_is_and_what_that_needs(tmp_path, torus, surface):
    said = done(torus, tmp_path / "e.ply", "-n", 60, "--max-distance", 0.03).stdout
    made = dapple.remesh(surface, 60, max_distance=0.03)
    assert len(made) > 60
    assert f"; the distance needs {len(made) - 60} more than asked for" in said
    assert f"; at most {made.report.distance:.3g} from the surface" in said
    assert "from the surface" not in done(torus, tmp_path / "e.ply", "-n", 60).stdout


def test_tells_how_near_an_adaptive_mesh_is(tmp_path, torus, surface):
    said = done(torus, tmp_path / "e.ply", "-n", 60, "--adaptive").stdout
    made = dapple.remesh(surface, 60, adaptive=True)
    assert f"; at most {made.report.distance:.3g} from the surface" in said
