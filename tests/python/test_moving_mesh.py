# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple3d.MeshTracker: a remesh on a surface that deforms."""

import json

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from click.testing import CliRunner
from dapple3d.cli.app import main

BOX = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def torus() -> tuple[dapple.Surface, np.ndarray]:
    """A torus, and its vertices on 8 frames: one side swells to three times its thickness."""
    vertices, faces = shapes.torus(48, 24)
    around = np.arctan2(vertices[:, 1], vertices[:, 0])
    ring = np.column_stack([np.cos(around), np.sin(around), np.zeros(len(around))])
    ring *= np.linalg.norm(vertices[:, :2], axis=1).mean()
    share = np.maximum(np.cos(around), 0.0)[:, None]
    frames = [ring + (vertices - ring) * (1.0 + 0.25 * k * share) for k in range(8)]
    return dapple.Surface(vertices, faces), np.array(frames)


def variation(surface: dapple.Surface, faces: np.ndarray, places: np.ndarray) -> float:
    return dapple.analyze(surface, dapple.Samples(surface, faces, places)).capacity_variation


def test_vertices_are_even_on_each_frame():
    surface, frames = torus()
    mesh = dapple.remesh(surface, 400)
    tracker = dapple.MeshTracker(surface, mesh)
    for frame in frames[1:]:
        moved = tracker.advance(frame)
    last = surface.deformed(frames[-1])
    corners = last.vertices[last.faces[moved.source_faces]]
    np.testing.assert_allclose(
        (corners * moved.barycentric[:, :, None]).sum(axis=1), moved.vertices, atol=1e-12
    )
    tracked = variation(last, moved.source_faces, moved.barycentric)
    assert tracked < 0.5 * variation(last, mesh.source_faces, mesh.barycentric)


def test_the_first_frame_is_the_remesh():
    surface, _ = torus()
    mesh = dapple.remesh(surface, 400)
    tracker = dapple.MeshTracker(surface, mesh)
    np.testing.assert_array_equal(tracker.faces, mesh.faces)
    np.testing.assert_allclose(tracker.first.vertices, mesh.vertices, atol=1e-12)
    assert tracker.first.smallest_angle == pytest.approx(mesh.report.smallest_angle)
    assert tracker.first.below_15 == tracker.first.flipped == tracker.first.held == 0


def test_slides_make_no_triangle_thin():
    surface, frames = torus()
    mesh = dapple.remesh(surface, 400)
    strict, free = (dapple.MeshTracker(surface, mesh, least_angle=angle) for angle in (20.0, 0.0))
    last = strict.first
    for frame in frames[1:]:
        moved, slid = strict.advance(frame), free.advance(frame)
        carried = dapple.Samples(surface.deformed(frame), last.source_faces, last.barycentric)
        before = smallest_angles(np.asarray(carried.positions), mesh.faces)
        now = smallest_angles(moved.vertices, mesh.faces)
        assert (now > np.minimum(before, 20.0) - 1e-6).all()
        last = moved
    assert moved.held > slid.held


def smallest_angles(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    corners = vertices[faces]
    found = []
    for k in range(3):
        a, b = corners[:, k - 1] - corners[:, k], corners[:, k - 2] - corners[:, k]
        cosines = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        found.append(np.degrees(np.arccos(cosines)))
    return np.min(found, axis=0)


def test_corners_and_creases_stay_in_their_places():
    faces = np.array([t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))])
    surface = dapple.Surface(BOX, faces)
    mesh = dapple.remesh(surface, 200)
    moved = dapple.MeshTracker(surface, mesh).advance(BOX * [1.0, 1.0, 2.5])
    on_lines = mesh.features != 0
    np.testing.assert_allclose(
        moved.vertices[on_lines], mesh.vertices[on_lines] * [1.0, 1.0, 2.5], atol=1e-12
    )
    a, b, c = np.moveaxis(moved.vertices[mesh.faces], 1, 0)
    assert abs((a * np.cross(b, c)).sum() / 6 - 2.5) < 1e-9


def test_same_bytes_for_any_number_of_threads():
    surface, frames = torus()
    mesh = dapple.remesh(surface, 200)
    trackers = [dapple.MeshTracker(surface, mesh, threads=count) for count in (1, 2)]
    for frame in frames[1:4]:
        one, two = (tracker.advance(frame) for tracker in trackers)
        assert one.vertices.tobytes() == two.vertices.tobytes()
        assert one.figures() == two.figures()


def test_a_canceled_frame_changes_nothing():
    surface, frames = torus()
    mesh = dapple.remesh(surface, 200)
    tracker, other = dapple.MeshTracker(surface, mesh), dapple.MeshTracker(surface, mesh)
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        tracker.advance(frames[3], context=context)
    np.testing.assert_array_equal(
        tracker.advance(frames[1]).vertices, other.advance(frames[1]).vertices
    )


def test_vertices_of_cut_edges_stay_together():
    """Three sheets that meet along an edge are cut apart: its vertices are there three times."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, -1, 1], [1, -1, 1.0]])
    vertices = np.concatenate([vertices, [[0, -1, -1], [1, -1, -1]]])
    faces = np.array([f for k in (2, 4, 6) for f in ((0, 1, k + 1), (0, k + 1, k))])
    surface = dapple.Surface(vertices, faces)
    mesh = dapple.remesh(surface, 80, non_manifold="cut")
    moved = dapple.MeshTracker(surface, mesh).advance(vertices * [2.0, 1.0, 1.0])
    assert np.isfinite(moved.vertices).all()
    on_lines = mesh.features != 0
    np.testing.assert_allclose(
        moved.vertices[on_lines], mesh.vertices[on_lines] * [2.0, 1.0, 1.0], atol=1e-12
    )


def test_refuses_what_does_not_fit():
    surface, frames = torus()
    mesh = dapple.remesh(surface, 100)
    for angle in (-1.0, 61.0, float("nan")):
        with pytest.raises(ValueError, match=r"least_angle is .*: it must be in 0\.\.60"):
            dapple.MeshTracker(surface, mesh, least_angle=angle)
    with pytest.raises(ValueError, match="classes are given"):
        dapple.MeshTracker(surface, mesh, classes=[100])
    with pytest.raises(ValueError, match="stickiness"):
        dapple.MeshTracker(surface, mesh, stickiness=-1.0)
    small = dapple.Surface(BOX[:3], np.array([[0, 1, 2]]))
    with pytest.raises(ValueError, match="outside the surface's faces"):
        dapple.MeshTracker(small, mesh)
    tracker = dapple.MeshTracker(surface, mesh)
    with pytest.raises(dapple.SurfaceError):
        tracker.advance(frames[1][:-1])
    with pytest.raises(dapple.SurfaceError):
        tracker.advance(np.full_like(frames[1], np.nan))
    assert tracker.advance(frames[1]).flipped == 0


def run(*arguments: object):
    return CliRunner().invoke(main, ["remesh", *map(str, arguments)])


def test_the_command_writes_all_frames(tmp_path):
    surface, frames = torus()
    np.savez(tmp_path / "swell.npz", vertices=frames[:4], faces=surface.faces)
    out = tmp_path / "even.npz"
    found = run(tmp_path / "swell.npz", out, "-n", 200, "--json", tmp_path / "report.json")
    assert found.exit_code == 0, found.output
    assert "4 frames, no triangle below 15 degrees" in found.output
    tracker = dapple.MeshTracker(surface, dapple.remesh(surface, 200))
    meshes = [tracker.first, *(tracker.advance(frame) for frame in frames[1:4])]
    with np.load(out) as file:
        np.testing.assert_array_equal(file["faces"], tracker.faces)
        np.testing.assert_array_equal(file["vertices"], [mesh.vertices for mesh in meshes])
        assert json.loads(str(file["reports"][3])) == meshes[3].figures()
    written = json.loads((tmp_path / "report.json").read_text())
    assert written["frames"][3] == meshes[3].figures()


def test_the_command_reads_a_folder(tmp_path):
    surface, frames = torus()
    (tmp_path / "swell").mkdir()
    for k in range(3):
        dapple.write_mesh(tmp_path / f"swell/swell_{k}.ply", frames[k], surface.faces)
    found = run(tmp_path / "swell", tmp_path / "even.npz", "-n", 150, "--least-angle", 30)
    assert found.exit_code == 0, found.output
    with np.load(tmp_path / "even.npz") as file:
        assert file["vertices"].shape == (3, 150, 3)


def test_the_command_refuses_what_does_not_fit(tmp_path):
    surface, frames = torus()
    np.savez(tmp_path / "swell.npz", vertices=frames[:2], faces=surface.faces)
    dapple.write_mesh(tmp_path / "still.ply", surface.vertices, surface.faces)
    found = run(tmp_path / "swell.npz", tmp_path / "even.ply", "-n", 150)
    assert "the meshes of all frames are written as .npz" in found.output
    found = run(tmp_path / "still.ply", tmp_path / "even.ply", "-n", 150, "--least-angle", 9)
    assert "--least-angle needs a motion" in found.output
    assert not (tmp_path / "even.ply").exists()
    (tmp_path / "empty").mkdir()
    found = run(tmp_path / "empty", tmp_path / "even.npz", "-n", 150)
    assert found.exit_code == 1
    assert "holds no" in found.output
    broken = frames[:2].copy()
    broken[1, 7] = np.inf
    np.savez(tmp_path / "broken.npz", vertices=broken, faces=surface.faces)
    found = run(tmp_path / "broken.npz", tmp_path / "even.npz", "-n", 150)
    assert "broken.npz[1]" in found.output
    assert not (tmp_path / "even.npz").exists()
