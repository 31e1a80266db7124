# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a motion as other programs write them."""

import json
from importlib.util import find_spec
from itertools import pairwise

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done, refused
from dapple3d.cli import sequences
from shapes import grid


def named(folder, names):
    for name in names:
        (folder / name).write_text("")
    return [path.name for path in sequences.files_of([folder])]


@pytest.mark.parametrize(
    "names",
    [
        ["f-3.obj", "f-2.obj", "f-1.obj", "f0.obj", "f1.obj", "f10.obj"],
        ["f-0010.obj", "f-0009.obj", "f0000.obj", "f0002.obj", "f0010.obj"],
        ["f_-2.ply", "f_-1.ply", "f_0.ply", "f_1.ply"],
        ["-2.obj", "-1.obj", "0.obj", "1.obj"],
        ["shot-1.obj", "shot-2.obj", "shot-10.obj"],
        ["shot-1_f-2.obj", "shot-1_f-1.obj", "shot-1_f0.obj", "shot-2_f-1.obj", "shot-2_f0.obj"],
        ["2024-01-02_f1.obj", "2024-01-02_f2.obj", "2024-01-10_f1.obj"],
        ["f1.obj", "f01.obj", "f2.obj"][1:],
    ],
)
def test_frames_come_in_the_order_of_their_numbers(tmp_path, names):
    assert named(tmp_path, sorted(names)) == names


def test_companions_of_macos_are_no_frames(tmp_path):
    assert named(tmp_path, ["f0.obj", "f1.obj", "._f0.obj", "._f1.obj", ".DS_Store"]) == [
        "f0.obj",
        "f1.obj",
    ]


def write_frames(folder, meshes, suffix=".ply"):
    folder.mkdir()
    for k, (vertices, faces) in enumerate(meshes):
        path = folder / f"f{k}{suffix}"
        if len(faces):
            dapple.write_mesh(path, vertices, faces)
        else:
            path.write_text("v 0 0 0\n" if suffix == ".obj" else EMPTY_PLY)
    return folder


EMPTY_PLY = (
    "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
    "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
)
NO_MESH = (np.empty((0, 3)), np.empty((0, 3), np.int32))


def rows_of(out):
    found = np.load(out)
    starts = found["starts"]
    ids = [found["ids"][a:b] for a, b in pairwise(starts)]
    fade = [found["fade"][a:b] for a, b in pairwise(starts)]
    return found, ids, fade


@pytest.mark.parametrize("suffix", [".ply", ".obj"])
def test_frames_without_faces_have_no_points(tmp_path, suffix):
    first, other = grid(6), grid(9)
    meshes = [NO_MESH, first, first, NO_MESH, NO_MESH, other, other]
    folder = write_frames(tmp_path / "splash", meshes, suffix)
    out = tmp_path / "out.npz"
    said = done("track", folder, out, "-n", 100, "--keep-density", "--fade", 4).output
    found, ids, fade = rows_of(out)
    area = [dapple.Surface(*mesh).area if len(mesh[1]) else 0 for mesh in meshes]
    assert [len(one) for one in ids] == [round(100 * a / area[1]) for a in area]
    assert not set(ids[5]) & set(ids[2])  # new samples
    np.testing.assert_array_equal(ids[5], ids[6])
    assert set(fade[5]) == {0.25}
    assert set(fade[6]) == {0.5}
    assert f"{len(ids[5])} appear, 100 vanish" in said
    assert len(found["reports"]) == 7
    if find_spec("pxr"):
        done("export", out, tmp_path / "out.usda")


def test_frames_without_faces_in_one_npz(tmp_path):
    vertices, faces = grid(6)
    arrays = {f"vertices_{k}": vertices for k in range(4)} | {f"faces_{k}": faces for k in range(4)}
    arrays |= {"vertices_1": NO_MESH[0], "faces_1": NO_MESH[1]}
    np.savez(tmp_path / "splash.npz", **arrays)
    done("track", tmp_path / "splash.npz", tmp_path / "out.npz", "-n", 50, "--keep-density")
    _, ids, _ = rows_of(tmp_path / "out.npz")
    assert [len(one) for one in ids] == [50, 0, 50, 50]


def test_a_frame_without_faces_is_named(tmp_path):
    folder = write_frames(tmp_path / "splash", [grid(4), NO_MESH])
    said = refused("track", folder, tmp_path / "out.npz", "-n", 50)
    assert f"{folder / 'f1.ply'}: holds no faces" in said
    folder = write_frames(tmp_path / "nothing", [NO_MESH, NO_MESH])
    said = refused("track", folder, tmp_path / "out.npz", "-n", 50, "--keep-density")
    assert f"{folder / 'f0.ply'}: holds no faces, nor does any later frame" in said


def obj_text(vertices, polygons):
    lines = [f"v {x} {y} {z}" for x, y, z in np.asarray(vertices).tolist()]
    lines += ["f " + " ".join(str(v + 1) for v in corners) for corners in polygons]
    return "\n".join(lines) + "\n"


QUADS = [[k, k + 1, k + 6, k + 5] for k in range(20) if k % 5 < 4]
FIELD = np.array([[x, y, 0.0] for y in range(5) for x in range(5)])


@pytest.mark.parametrize(
    "polygons",
    [
        [corners[1:] + corners[:1] for corners in QUADS],
        QUADS[::-1],
        [corners[k % 4 :] + corners[: k % 4] for k, corners in enumerate(reversed(QUADS))],
    ],
)
def test_polygons_may_begin_at_another_corner_or_come_in_another_order(tmp_path, polygons):
    frames = tmp_path / "frames"
    frames.mkdir()
    for k, faces in enumerate([QUADS, polygons, QUADS]):
        (frames / f"f{k}.obj").write_text(obj_text(FIELD + np.array([0, 0, 0.1 * k]), faces))
    done("track", frames, tmp_path / "out.npz", "-n", 40)
    found = np.load(tmp_path / "out.npz")
    np.testing.assert_allclose(found["positions"][1, :, 2], 0.1)
    done("track", frames, tmp_path / "kept.npz", "-n", 40, "--keep-density")
    _, ids, _ = rows_of(tmp_path / "kept.npz")
    for one in ids:
        np.testing.assert_array_equal(one, ids[0])


def test_a_quad_that_gets_a_dent_is_the_same_quad(tmp_path):
    frames = tmp_path / "frames"
    frames.mkdir()
    dented = FIELD.copy()
    dented[6] = [0.2, 1.7, 0]
    for k, vertices in enumerate([FIELD, dented]):
        (frames / f"f{k}.obj").write_text(obj_text(vertices, QUADS))
    one, other = (dapple.read_mesh(frames / f"f{k}.obj").faces for k in range(2))
    assert not np.array_equal(one, other)
    done("track", frames, tmp_path / "out.npz", "-n", 40)


@pytest.mark.parametrize("change", ["turned", "other"])
def test_other_polygons_are_still_refused(tmp_path, change):
    frames = tmp_path / "frames"
    frames.mkdir()
    polygons = [*QUADS[:-1], QUADS[-1][::-1] if change == "turned" else [0, 1, 6, 7]]
    for k, faces in enumerate([QUADS, polygons]):
        (frames / f"f{k}.obj").write_text(obj_text(FIELD, faces))
    said = refused("track", frames, tmp_path / "out.npz", "-n", 40)
    assert f"{frames / 'f1.obj'}: faces[" in said
    assert "all frames need the same faces" in said


def test_a_slit_opens_in_a_sequence_of_stl(tmp_path):
    vertices, faces = grid(8)
    corners = vertices[faces].reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 3)
    frames = tmp_path / "frames"
    frames.mkdir()
    middle = vertices[:, 0].mean()
    right = np.repeat(corners.reshape(-1, 3, 3)[:, :, 0].mean(axis=1) > middle, 3)
    for k in range(3):
        moved = corners + np.outer(right, [0.02 * k, 0, 0])
        dapple.write_mesh(frames / f"f{k}.stl", moved, faces)
    counts = {len(dapple.read_mesh(path).vertices) for path in frames.iterdir()}
    assert len(counts) > 1
    done("track", frames, tmp_path / "out.npz", "-n", 60)
    found = np.load(tmp_path / "out.npz")
    on_right = right.reshape(-1, 3)[found["faces"][2], 0]
    assert (found["positions"][2, on_right, 0] >= middle + 0.04 - 1e-6).all()
    assert [json.loads(report)["converged"] for report in found["reports"]]
