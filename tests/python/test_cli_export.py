# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple export: what goes from one format into another, and what is refused."""

import json
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done, refused, run
from dapple3d import instances
from dapple3d.cli import points
from dapple3d.extras import gltf, godot, usd

pytest.importorskip("pxr", reason="usd-core is not installed")


@pytest.fixture
def tracked(tmp_path, mesh) -> Path:
    frames = np.stack([shapes.bent(mesh[0], time) for time in (0.0, 0.1, 0.2)])
    np.savez(tmp_path / "walk.npz", vertices=frames, faces=mesh[1])
    done("track", tmp_path / "walk.npz", tmp_path / "tracked.npz", "-n", 40)
    return tmp_path / "tracked.npz"


@pytest.fixture
def still(tmp_path, samples) -> Path:
    path = tmp_path / "still.npz"
    points.write_points(path, points.points_of(samples))
    return path


def test_a_motion_goes_to_usd_and_back(tmp_path, tracked):
    out, back = tmp_path / "walk.usdc", tmp_path / "back.npz"
    said = done("export", tracked, out, "--fps", 25, "--start", 101, "--up", "y").stdout
    assert said == f"{out}: 40 points on 3 frames\n"
    found = usd.read(out)
    assert found.times.tolist() == [101, 102, 103]
    assert (found.fps, found.up, found.meters_per_unit) == (25, "Y", 1)
    done("export", out, back)
    before, after = np.load(tracked), np.load(back)
    for name in ("positions", "normals"):
        np.testing.assert_array_equal(after[name], before[name].astype(np.float32))
    np.testing.assert_array_equal(after["ids"], before["ids"])
    step = np.diff(before["positions"], axis=0) * 25
    np.testing.assert_allclose(after["velocities"][:2], step, atol=1e-5)
    frames = [instances.Instances(one, normals=one) for one in before["normals"]]
    turns = [one.orientations for one in instances.along_normals(frames, up="Y")]
    np.testing.assert_array_equal(after["orientations"], np.float32(turns))


def test_a_usd_file_keeps_its_scene(tmp_path, tracked):
    done("export", tracked, tmp_path / "a.usda", "--fps", 30, "--start", 7, "--meters-per-unit", 2)
    done("export", tmp_path / "a.usda", tmp_path / "b.usda")
    found = usd.read(tmp_path / "b.usda")
    assert (found.times.tolist(), found.fps, found.meters_per_unit) == ([7, 8, 9], 30, 2)
    done("export", tmp_path / "a.usda", tmp_path / "c.usda", "--start", 1, "--fps", 24)
    found = usd.read(tmp_path / "c.usda")
    assert (found.times.tolist(), found.fps, found.meters_per_unit) == ([1, 2, 3], 24, 2)


@pytest.mark.parametrize("suffix", [".csv", ".ply", ".npz"])
def test_one_frame_goes_to_files_of_points_with_all_it_has(tmp_path, tracked, suffix):
    done("export", tracked, tmp_path / "walk.usda")
    out = tmp_path / f"second{suffix}"
    done("export", tmp_path / "walk.usda", out, "--frame", 2, "--scale", 3)
    found, expected = points.read_points(out), usd.read(tmp_path / "walk.usda").frames[1]
    for name, values in expected.arrays().items():
        np.testing.assert_array_equal(getattr(found, name), values, name)
    assert (found.scales == 3).all()


@pytest.mark.parametrize("suffix", usd.SUFFIXES)
def test_sample_writes_usd_itself(tmp_path, torus, surface, suffix):
    out = tmp_path / f"points{suffix}"
    done("sample", torus, out, "-n", 50)
    (found,) = usd.read(out).frames
    expected = instances.of_samples(dapple.sample(surface, 50))
    np.testing.assert_array_equal(found.positions, expected.positions.astype(np.float32))
    np.testing.assert_array_equal(found.orientations, expected.orientations.astype(np.float32))
    assert "points                   50" in done("analyze", out, "--mesh", torus).stdout


def test_prototypes_stand_at_the_classes(tmp_path, torus, mesh):
    done("classes", torus, tmp_path / "both.csv", "--class", 20, "--class", 10)
    done("sample", torus, tmp_path / "fern.usda", "-n", 5)
    fern = f"{tmp_path / 'fern.usda'}:/dapple/points"
    out = tmp_path / "both.usda"
    given = ["--prototype", torus, "--prototype", fern, "--scale", 0.1, "--json", "-"]
    document = json.loads(done("export", tmp_path / "both.csv", out, *given).stdout)
    assert document["settings"]["prototypes"] == [str(torus), fern]
    assert document["points"] == [30]
    (found,) = usd.read(out).frames
    assert np.bincount(found.classes).tolist() == [20, 10]
    np.testing.assert_allclose(found.scales, 0.1)
    stage = pytest.importorskip("pxr.Usd").Stage.Open(str(out))
    held = stage.GetPrimAtPath("/dapple/points/prototypes/class_0").GetAttribute("points").Get()
    np.testing.assert_array_equal(np.array(held), mesh[0].astype(np.float32))
    assert "@./fern.usda@</dapple/points>" in out.read_text()


def test_gltf_holds_a_frame_with_prototypes(tmp_path, torus, tracked):
    out = tmp_path / "walk.glb"
    done("export", tracked, out, "--frame", 2, "--prototype", torus, "--scale", 0.1)
    found = gltf.read(out)
    expected = np.load(tracked)["positions"][1].astype(np.float32)
    np.testing.assert_array_equal(found.positions, expected)
    np.testing.assert_allclose(found.scales, 0.1, rtol=1e-6)
    assert f"{tracked} has 3 frames, and " in refused("export", tracked, out)
    done("export", out, tmp_path / "back.csv")
    np.testing.assert_array_equal(points.read_points(tmp_path / "back.csv").positions, expected)
    done("export", out, tmp_path / "more.gltf", "--prototype", f"{out}:points_0")
    assert len(gltf.read(tmp_path / "more.gltf")) == 40


@pytest.mark.parametrize("suffix", gltf.SUFFIXES)
def test_sample_writes_gltf_itself(tmp_path, torus, surface, suffix):
    out = tmp_path / f"points{suffix}"
    done("sample", torus, out, "-n", 50)
    expected = dapple.sample(surface, 50).positions.astype(np.float32)
    np.testing.assert_array_equal(gltf.read(out).positions, expected)
    assert "points                   50" in done("analyze", out, "--mesh", torus).stdout


def test_scenes_of_godot_have_meshes_beside_them(tmp_path, torus, still):
    out, rock = tmp_path / "a.tscn", tmp_path / "rock.tres"
    rock.touch()
    done("sample", torus, tmp_path / "b.tscn", "-n", 9)
    assert "instance_count = 9" in (tmp_path / "b.tscn").read_text()
    done("export", still, out, "--prototype", torus)
    assert 'path="a_meshes/points_0.obj"' in out.read_text()
    assert len(dapple.read_mesh(tmp_path / "a_meshes" / "points_0.obj").faces) > 0
    done("export", still, out, "--prototype", rock)
    assert 'path="rock.tres"' in out.read_text()
    done("export", still, out, "--prototype", "res://rocks/rock.obj")
    assert 'path="res://rocks/rock.obj"' in out.read_text()
    said = refused("export", still, out, "--prototype", "res://rocks/rock.glb")
    assert "Godot loads meshes from .obj, .res, .tres, .mesh" in said
    said = refused("export", still, tmp_path / "a.glb", "--prototype", "res://rocks/rock.obj")
    assert "cannot stand in .glb, another format" in said
    assert "points are read from" in refused("export", out, tmp_path / "back.csv")
    assert godot.SUFFIXES == (".tscn",)


def test_scenes_of_godot_hold_a_frame(tmp_path, tracked):
    out = tmp_path / "walk.tscn"
    assert f"{tracked} has 3 frames, and " in refused("export", tracked, out)
    done("export", tracked, out, "--frame", 2)
    assert "instance_count = 40" in out.read_text()


def test_prototypes_are_of_the_format_of_the_output(tmp_path, torus, still):
    done("sample", torus, tmp_path / "fern.glb", "-n", 3)
    done("sample", torus, tmp_path / "fern.usda", "-n", 3)
    said = refused("export", still, tmp_path / "a.usda", "--prototype", tmp_path / "fern.glb")
    assert "fern.glb: cannot stand in .usda, another format" in said
    said = refused("export", still, tmp_path / "a.glb", "--prototype", tmp_path / "fern.usda")
    assert "fern.usda: cannot stand in .glb, another format" in said


def test_points_of_the_plane_lie_at_height_zero(tmp_path):
    (tmp_path / "flat.csv").write_text("x,y\n1,2\n3,4\n")
    done("export", tmp_path / "flat.csv", tmp_path / "flat.usda")
    (found,) = usd.read(tmp_path / "flat.usda").frames
    assert found.positions.tolist() == [[1, 2, 0], [3, 4, 0]]
    assert found.orientations is None


def test_what_cannot_be_is_refused(tmp_path, tracked, still):
    out = tmp_path / "out.usda"
    assert "has 3 frames, so there is no 4" in refused("export", tracked, out, "--frame", 4)
    said = refused("export", tracked, tmp_path / "out.ply")
    assert f"{tracked} has 3 frames, and " in said
    done("export", tracked, tmp_path / "walk.usda")
    assert "holds 3 frames" in refused("analyze", tmp_path / "walk.usda", "--mesh", still)


def test_an_output_is_not_its_own_prototype(tmp_path, still):
    done("export", still, tmp_path / "a.usda")
    said = refused("export", still, tmp_path / "a.usda", "--prototype", tmp_path / "a.usda")
    assert "is read as an input" in said
    found = run("export", still, tmp_path / "b.usda", "--prototype", tmp_path / "none.usd:/tree")
    assert found.exit_code == 2
    assert f"'{tmp_path / 'none.usd'}': there is no such file" in found.stderr
    found = run("export", still, tmp_path / "b.csv", "--prototype", tmp_path / "a.usda")
    assert found.exit_code == 2
    assert ".csv holds points alone" in found.stderr


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"normals": np.ones((2, 4, 3))}, "normals has 2 frames, but positions 3"),
        ({"ids": [0, 1, 2, 0.5]}, "ids of point 3 is 0.5"),
        ({"scales": np.ones((4, 2))}, r"scales is float64 (4, 2): numbers (4, 3)"),
        ({"positions": np.ones((0, 4, 3))}, "positions holds no frame"),
        ({"positions": np.ones((3, 4, 5))}, "positions is float64 (3, 4, 5): numbers"),
        ({"orientations": np.zeros((3, 4, 4)) + np.nan}, "orientations[0] is not finite"),
    ],
)
def test_broken_motions_are_named(tmp_path, arrays, said):
    path = tmp_path / "motion.npz"
    np.savez(path, **{"positions": np.ones((3, 4, 3))} | arrays)
    assert f"{path}: {said}" in refused("export", path, tmp_path / "out.usda")


def test_points_that_come_and_go_need_usd(tmp_path):
    frames = [instances.Instances(np.ones((n, 3)), ids=np.arange(n)) for n in (3, 2)]
    usd.write(tmp_path / "changing.usda", frames)
    said = refused("export", tmp_path / "changing.usda", tmp_path / "out.npz")
    assert "ids change over the frames" in said
    done("export", tmp_path / "changing.usda", tmp_path / "same.usdc")
    assert [len(frame) for frame in usd.read(tmp_path / "same.usdc").frames] == [3, 2]
    done("export", tmp_path / "changing.usda", tmp_path / "last.csv", "--frame", 2)
    assert len(points.read_points(tmp_path / "last.csv").positions) == 2
