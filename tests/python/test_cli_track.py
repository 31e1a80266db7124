# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple track: what it writes, and what it refuses."""

import json
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done, refused, run


@pytest.fixture
def motion(tmp_path, mesh) -> Path:
    vertices, faces = mesh
    path = tmp_path / "motion.npz"
    frames = np.stack([shapes.bent(vertices, time) for time in (0.0, 0.1, 0.2)])
    np.savez(path, vertices=frames, faces=faces)
    return path


def test_tracks(tmp_path, motion, surface):
    out = tmp_path / "points.npz"
    found = done("track", motion, out, "-n", 100, "--stickiness", 0.5, "--json", "-")
    frames = np.load(motion)["vertices"]
    first = dapple.sample(dapple.Surface(frames[0], np.load(motion)["faces"]), 100)
    tracker = dapple.Tracker(surface.deformed(frames[0]), first, stickiness=0.5)
    expected = [first, *(tracker.advance(frame) for frame in frames[1:])]
    stored = np.load(out)
    for name in ("positions", "normals", "faces", "barycentric"):
        np.testing.assert_array_equal(stored[name], [getattr(one, name) for one in expected])
    np.testing.assert_array_equal(stored["ids"], first.ids)
    reports = [json.loads(text) for text in stored["reports"]]
    assert [one["slide_max"] for one in reports] == [one.report.slide_max for one in expected]
    document = json.loads(found.stdout)
    assert document["input"]["frames"] == [f"{motion}[{k}]" for k in range(3)]
    assert document["settings"]["stickiness"] == 0.5
    assert len(document["reports"]) == 3


def test_tracks_files_as_one_archive_to_the_same_bytes(tmp_path, motion, mesh):
    files = [tmp_path / f"frame_{k}.ply" for k in range(3)]
    for path, frame in zip(files, np.load(motion)["vertices"], strict=True):
        dapple.write_mesh(path, frame, mesh[1])
    done("track", motion, tmp_path / "a.npz", "-n", 60, "--threads", 1)
    done("track", *files, tmp_path / "b.npz", "-n", 60)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_tracks_together(tmp_path, motion, surface):
    out = tmp_path / "points.npz"
    found = done("track", motion, out, "-n", 60, "--together", "--closed", "--json", "-")
    frames = np.load(motion)["vertices"]
    start = surface.deformed(frames[0])
    first = dapple.sample(start, 60)
    expected = dapple.track_window(start, frames[1:], first, closed=True)
    np.testing.assert_array_equal(
        np.load(out)["positions"], [samples.positions for samples in expected]
    )
    settings = json.loads(found.stdout)["settings"]
    assert (settings["closed"], settings["sweeps"], settings["stickiness"]) == (True, 2, 1.0)


def test_refuses_frames(tmp_path, motion, mesh, torus):
    out = tmp_path / "points.npz"
    assert "written as .npz" in refused("track", motion, tmp_path / "out.ply", "-n", 9)
    assert r"shape (800, 3): (frames, v, 3)" in refused("track", torus, out, "-n", 9)
    turned = tmp_path / "turned.ply"
    dapple.write_mesh(turned, mesh[0], np.roll(mesh[1], 1, axis=1))
    said = refused("track", torus, turned, out, "-n", 9)
    assert f"{turned}: faces[0] is [" in said
    fewer = tmp_path / "fewer.ply"
    dapple.write_mesh(fewer, mesh[0], mesh[1][:-1])
    assert f"{fewer}: has faces (1599, 3)" in refused("track", torus, fewer, out, "-n", 9)
    arrays = dict(np.load(motion))
    arrays["vertices"][2, 5, 0] = np.inf
    np.savez(motion, **arrays)
    assert f"{motion}[2]: vertices[5] is not" in refused("track", motion, out, "-n", 9)
    assert not out.exists()


def test_begins_with_points_of_a_file(tmp_path, motion):
    points, out = tmp_path / "first.npz", tmp_path / "points.npz"
    with np.load(motion) as stored:
        frames, faces = stored["vertices"], stored["faces"]
    surface = dapple.Surface(frames[0], faces)
    first = dapple.sample(surface, 50, seed=4)
    names = ("positions", "faces", "barycentric")
    np.savez(points, ids=first.ids + 7, **{name: getattr(first, name) for name in names})
    done("track", motion, out, "--points", points)
    begun = dapple.Samples(surface, first.faces, first.barycentric, ids=first.ids + 7)
    tracker = dapple.Tracker(surface, begun)
    expected = [begun, *(tracker.advance(frame) for frame in frames[1:])]
    with np.load(out) as stored:
        np.testing.assert_array_equal(stored["ids"], first.ids + 7)
        np.testing.assert_array_equal(stored["positions"], [one.positions for one in expected])


def test_keeps_the_classes_of_a_file(tmp_path, motion):
    points, out = tmp_path / "first.npz", tmp_path / "points.npz"
    with np.load(motion) as stored:
        frames, faces = stored["vertices"], stored["faces"]
    surface = dapple.Surface(frames[0], faces)
    first = dapple.sample_classes(surface, [40, 20])
    names = ("positions", "faces", "barycentric", "classes")
    np.savez(points, **{name: getattr(first, name) for name in names})
    done("track", motion, out, "--points", points)
    tracker = dapple.Tracker(surface, first, classes=[40, 20])
    last = [tracker.advance(frame) for frame in frames[1:]][-1]
    with np.load(out) as stored:
        np.testing.assert_array_equal(stored["classes"], first.classes)
        np.testing.assert_array_equal(stored["positions"][-1], last.positions)
    done("track", motion, out, "--points", points, "--together")
    last = dapple.track_window(surface, frames[1:], first, classes=[40, 20])[-1]
    with np.load(out) as stored:
        np.testing.assert_array_equal(stored["positions"][-1], last.positions)


@pytest.mark.parametrize("arguments", [[], ["-n", 5, "--points", "motion.npz"]])
def test_needs_a_count_or_points(tmp_path, monkeypatch, motion, arguments):
    monkeypatch.chdir(tmp_path)
    found = run("track", motion, "points.npz", *arguments)
    assert found.exit_code == 2
    assert "give either --count or --points" in found.stderr
