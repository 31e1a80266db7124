# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple track: what it writes, and what it refuses."""

import json
import re
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done, refused, run
from mask_checks import CUBE, CUBE_FACES


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
    expected = dapple.track_window(start, first, frames[1:], closed=True)
    np.testing.assert_array_equal(
        np.load(out)["positions"], [samples.positions for samples in expected]
    )
    settings = json.loads(found.stdout)["settings"]
    assert (settings["closed"], settings["sweeps"], settings["stickiness"]) == (True, 2, 1.0)


def test_refuses_frames(tmp_path, motion, mesh, torus):
    out = tmp_path / "points.npz"
    assert "written as .npz" in refused("track", motion, tmp_path / "out.ply", "-n", 9)
    assert "holds one frame, vertices (800, 3); a motion is several files" in refused(
        "track", torus, out, "-n", 9
    )
    turned = tmp_path / "turned.ply"
    dapple.write_mesh(turned, mesh[0], mesh[1][:, ::-1])
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


def test_points_of_a_class_that_is_too_large_are_named(tmp_path, motion):
    points = tmp_path / "first.npz"
    classes = np.array([0, 0, 2**31 - 1])
    np.savez(points, positions=np.eye(3), classes=classes)
    told = refused("track", motion, tmp_path / "out.npz", "--points", points)
    assert f"{points}: class of point 2 is 2147483647: 1000000 at most is needed" in told


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
    last = dapple.track_window(surface, first, frames[1:], classes=[40, 20])[-1]
    with np.load(out) as stored:
        np.testing.assert_array_equal(stored["positions"][-1], last.positions)


@pytest.mark.parametrize("arguments", [[], ["-n", 5, "--points", "motion.npz"]])
def test_needs_a_count_or_points(tmp_path, monkeypatch, motion, arguments):
    monkeypatch.chdir(tmp_path)
    found = run("track", motion, "points.npz", *arguments)
    assert found.exit_code == 2
    assert ("Missing option" if not arguments else "give only one of --count") in found.stderr


@pytest.fixture
def changing() -> list[tuple]:
    """A torus that grows a little, of other triangles in each frame."""
    return [
        ((1 + 0.02 * k) * vertices, faces)
        for k in range(3)
        for vertices, faces in [shapes.torus(40 + k, 20)]
    ]


def followed(frames: list[tuple], count: int, **options) -> list[dapple.Samples]:
    surface = dapple.Surface(*frames[0])
    first = dapple.sample(surface, count)
    population = dapple.Population(surface, first, **options)
    return [first, *(population.advance(*frame) for frame in frames[1:])]


def test_keeps_the_density_of_other_faces(tmp_path, changing):
    folder, out = tmp_path / "frames", tmp_path / "points.npz"
    folder.mkdir()
    for k, frame in enumerate(changing):
        dapple.write_mesh(folder / f"frame_{k + 9}.ply", *frame)
    found = done("track", folder, out, "-n", 200, "--keep-density", "--fade", 4, "--json", "-")
    expected = followed(changing, 200, fade=4)
    with np.load(out) as stored:
        starts = stored["starts"]
        assert np.diff(starts).tolist() == [len(one) for one in expected]
        for name in ("positions", "normals", "faces", "barycentric", "ids", "fade"):
            joined = np.concatenate([getattr(one, name) for one in expected])
            np.testing.assert_array_equal(stored[name], joined)
        reports = [json.loads(text) for text in stored["reports"]]
    assert [one["births"] for one in reports] == [one.report.births for one in expected]
    assert sum(one["births"] for one in reports) > 0
    assert json.loads(found.stdout)["settings"]["fade"] == 4


def test_reads_an_archive_of_other_faces_to_the_same_bytes(tmp_path, changing):
    files = [tmp_path / f"frame_{k}.npz" for k in range(3)]
    for path, (vertices, faces) in zip(files, changing, strict=True):
        np.savez(path, vertices=vertices, faces=faces)
    numbered = {f"vertices_{k}": frame[0] for k, frame in enumerate(changing)}
    numbered |= {f"faces_{k}": frame[1] for k, frame in enumerate(changing)}
    np.savez(tmp_path / "all.npz", **numbered)
    done("track", *files, tmp_path / "a.npz", "-n", 60, "--keep-density")
    done("track", tmp_path / "all.npz", tmp_path / "b.npz", "-n", 60, "--keep-density")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_keeps_the_density_of_the_same_faces(tmp_path, motion):
    out = tmp_path / "points.npz"
    done("track", motion, out, "-n", 60, "--keep-density")
    with np.load(motion) as stored:
        frames, faces = stored["vertices"], stored["faces"]
    expected = followed([(frame, faces) for frame in frames], 60)
    with np.load(out) as stored:
        joined = np.concatenate([one.positions for one in expected])
        np.testing.assert_array_equal(stored["positions"], joined)


def test_exports_points_that_appear(tmp_path, changing):
    files = [tmp_path / f"frame_{k}.ply" for k in range(3)]
    for path, frame in zip(files, changing, strict=True):
        dapple.write_mesh(path, *frame)
    points, last = tmp_path / "points.npz", tmp_path / "last.npz"
    done("track", *files, points, "-n", 200, "--keep-density")
    done("export", points, last, "--frame", 3)
    with np.load(points) as stored, np.load(last) as exported:
        rows = slice(stored["starts"][2], None)
        np.testing.assert_array_equal(exported["positions"], stored["positions"][rows])
        np.testing.assert_array_equal(exported["ids"], stored["ids"][rows])
        np.testing.assert_array_equal(exported["scales"][:, 0], stored["fade"][rows])
    assert "holds several frames" in refused("analyze", points)


def test_refuses_sequences(tmp_path, motion, mesh, changing):
    out, empty = tmp_path / "points.npz", tmp_path / "empty"
    empty.mkdir()
    assert "empty: holds no .ply" in refused("track", empty, out, "-n", 9)
    assert "a folder is all frames" in refused("track", empty, motion, out, "-n", 9)
    np.savez(tmp_path / "bare.npz", vertices_0=mesh[0])
    said = refused("track", tmp_path / "bare.npz", out, "-n", 9, "--keep-density")
    assert "has 'vertices_0', but no faces" in said
    np.savez(tmp_path / "flat.npz", vertices_0=mesh[0], faces_0=mesh[1].ravel())
    said = refused("track", tmp_path / "flat.npz", out, "-n", 9, "--keep-density")
    assert "are not (v, 3) and (m, 3)" in said
    for k, frame in enumerate(changing):
        dapple.write_mesh(empty / f"{k}.ply", *frame)
    assert "or --keep-density" in refused("track", empty, out, "-n", 9)
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--fade", 3], "need --keep-density"), (["--keep-density", "--together"], "frame by frame")],
)
def test_refuses_options_without_their_mode(tmp_path, motion, options, said):
    found = run("track", motion, tmp_path / "points.npz", "-n", 9, *options)
    assert found.exit_code == 2
    assert said in found.stderr


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        ({"starts": [0, 5, 3]}, "starts does not divide"),
        ({"starts": [0, 2]}, "starts does not divide the 3 rows"),
        ({"starts": [0.0, 3.0]}, "starts does not divide"),
        ({"starts": [0, 3], "fade": [1.0]}, "fade is float64 .1,.: numbers .3,. are needed"),
        ({"starts": [0, 3], "ids": [1]}, "ids has the shape"),
        ({"starts": [0, 1, 3], "times": [1.0]}, "times is float64"),
    ],
)
def test_refuses_damaged_points_that_appear(tmp_path, broken, said):
    path = tmp_path / "points.npz"
    np.savez(path, **{"positions": np.zeros((3, 3))} | broken)
    assert re.search(said, refused("export", path, tmp_path / "out.npz"))
    np.savez(path, starts=[0, 3])
    assert "has starts, but no positions" in refused("export", path, tmp_path / "out.npz")


def passing_cubes(tmp_path):
    """A small cube that comes out of a large one: what is hidden differs on each frame."""
    inner = 0.5 * CUBE
    frames = [
        np.vstack([CUBE, inner + np.array([shift, 0.1, 0.05])])
        for shift in np.linspace(0.6, 1.2, 4)
    ]
    faces = np.vstack([CUBE_FACES, CUBE_FACES + len(CUBE)])
    path = tmp_path / "cubes.npz"
    np.savez(path, vertices=np.stack(frames), faces=faces)
    return path, frames, faces


def hidden_on(stored, frames, faces):
    """How many points are hidden on each frame."""
    return [
        int((dapple.exposure(dapple.Surface(frame, faces), on, weights) == 0.0).sum())
        for frame, on, weights in zip(frames, stored["faces"], stored["barycentric"], strict=True)
    ]


@pytest.mark.parametrize("over_time", ["first-frame", "all-frames", "each-frame"])
def test_decides_over_time_what_is_outside(tmp_path, over_time):
    path, frames, faces = passing_cubes(tmp_path)
    frames, out = frames[::-1], tmp_path / "points.npz"  # the small one goes in
    np.savez(path, vertices=np.stack(frames), faces=faces)
    options = ("--outside", "--outside-over-time", over_time)
    found = done("track", path, out, "-n", 300, *options, "--json", "-")
    assert json.loads(found.stdout)["settings"]["outside_over_time"] == over_time
    with np.load(out) as stored:
        hidden = hidden_on(stored, frames, faces)
        small = [(np.asarray(on) >= len(CUBE_FACES)).sum() for on in stored["faces"]]
        assert stored["faces"].max() < len(faces)
    assert hidden[0] == 0
    if over_time == "first-frame":
        assert hidden[-1] > 5
        assert small[0] == small[-1]
    else:
        assert max(hidden) == 0
    if over_time == "each-frame":
        assert small[-1] < small[0] - 10


def test_points_move_to_what_comes_to_light(tmp_path):
    path, frames, faces = passing_cubes(tmp_path)
    out = tmp_path / "points.npz"
    done("track", path, out, "-n", 300, "--outside", "--outside-over-time", "each-frame")
    with np.load(out) as stored:
        assert max(hidden_on(stored, frames, faces)) == 0
        small = [(np.asarray(on) >= len(CUBE_FACES)).sum() for on in stored["faces"]]
        np.testing.assert_array_equal(stored["ids"], np.arange(300))
    assert small[-1] > small[0] + 5


@pytest.mark.parametrize(
    ("options", "rule"),
    [
        (["--outside-over-time", "all-frames"], "--outside-over-time needs --outside"),
        (
            ["--outside", "--outside-over-time", "each-frame", "--together"],
            "each-frame goes frame by frame, so not with --together",
        ),
    ],
)
def test_refuses_over_time_where_it_means_nothing(tmp_path, motion, options, rule):
    found = run("track", motion, tmp_path / "points.npz", "-n", 60, *options)
    assert found.exit_code == 2
    assert rule in found.output
