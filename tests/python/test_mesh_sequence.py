# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple3d.MeshSequence: remeshes of surfaces whose faces change."""

import itertools
import json

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from click.testing import CliRunner
from dapple3d.cli.app import main
from numpy.typing import NDArray

COUNT = 400
Frame = tuple[NDArray[np.float64], NDArray[np.int32]]


def splash(frame: int) -> Frame:
    """A plate, cut into triangles that differ from frame to frame, in which a cone rises; on later
    frames there is a ring above it.
    """
    cells = 24 + frame % 2
    vertices, faces = shapes.grid(cells)
    away = np.linalg.norm(vertices[:, :2] - [0.75, 0.5], axis=1)
    vertices[:, 2] = 0.08 * frame * np.maximum(1.0 - away / 0.2, 0.0)
    if frame < 3:
        return vertices, faces
    ring, more = shapes.torus(16, 8)
    joined = np.concatenate([vertices, 0.15 * ring + [0.3, 0.5, 0.5]])
    return joined, np.concatenate([faces, more + len(vertices)])


def surface_of(frame: int) -> dapple.Surface:
    return dapple.Surface(*splash(frame))


@pytest.fixture(scope="module")
def frames() -> list[dapple.SequenceMesh]:
    sequence = dapple.MeshSequence(surface_of(0), COUNT)
    found = [sequence.first]
    for frame in range(1, 5):
        found.append(sequence.advance(surface_of(frame)))
    return found


def test_what_does_not_change_stays(frames):
    for before, after in itertools.pairwise(frames):
        here = after.mesh.vertices[:, 0] < 0.4
        here &= after.mesh.vertices[:, 2] == 0.0
        _, old, new = np.intersect1d(before.ids, after.ids[here], return_indices=True)
        assert len(new) == here.sum() > 100
        np.testing.assert_allclose(
            before.mesh.vertices[old], after.mesh.vertices[here][new], atol=1e-12
        )
        assert after.kept >= here.sum()


def test_triangles_stay_with_their_vertices(frames):
    def triangles(one: dapple.SequenceMesh) -> set[tuple[int, ...]]:
        corners = one.mesh.vertices[one.mesh.faces]
        here = (corners[:, :, 0].max(axis=1) < 0.4) & (corners[:, :, 2].max(axis=1) == 0.0)
        rows = one.ids[one.mesh.faces[here]]
        return {tuple(np.roll(row, -row.argmin()).tolist()) for row in rows}

    assert len(triangles(frames[0])) > 200
    for before, after in itertools.pairwise(frames):
        assert triangles(before) == triangles(after)


def test_ids_are_not_used_again(frames):
    seen: set[int] = set()
    for before, after in zip([None, *frames], frames, strict=False):
        assert len(set(after.ids.tolist())) == len(after.ids) == len(after.mesh)
        known = set(before.ids.tolist()) if before else set()
        new = set(after.ids.tolist()) - known
        assert not new & seen
        assert len(new) == after.born
        assert len(known - set(after.ids.tolist())) == after.gone
        seen |= new


def test_the_number_of_vertices_goes_with_the_area(frames):
    for frame, found in enumerate(frames):
        wanted = COUNT * surface_of(frame).area / surface_of(0).area
        assert len(found.mesh) == pytest.approx(wanted, rel=0.03)
        assert found.mesh.report.flaws == 0
        assert found.mesh.report.mean_smallest_angle > 48


def test_a_frame_without_a_surface_begins_anew():
    sequence = dapple.MeshSequence(surface_of(0), COUNT)
    assert sequence.advance(None) is None
    after = sequence.advance(surface_of(0))
    assert len(after.mesh) == COUNT
    assert after.ids.tolist() == list(range(COUNT, 2 * COUNT))
    assert after.born == COUNT


def test_marked_edges_stay():
    vertices, faces = shapes.grid(8)
    middle = np.flatnonzero(vertices[:, 0] == 0.5)
    middle = middle[np.argsort(vertices[middle, 1])]
    edges = np.stack([middle[:-1], middle[1:]], axis=1)
    surface = dapple.Surface(vertices, faces)
    sequence = dapple.MeshSequence(surface, 100)
    found = sequence.advance(surface, edges=edges)
    ends = found.mesh.vertices[found.mesh.lines]
    assert (ends[:, :, 0] == 0.5).all(axis=1).sum() >= 8


def test_names_what_is_wrong():
    with pytest.raises(TypeError, match="unexpected keyword argument 'adaptive'"):
        dapple.MeshSequence(surface_of(0), COUNT, adaptive=True)
    with pytest.raises(ValueError, match="feature_angle is 300"):
        dapple.MeshSequence(surface_of(0), COUNT, feature_angle=300)
    mesh = dapple.remesh(surface_of(0), 50)
    with pytest.raises(ValueError, match="capacity is -1: it must be > 0"):
        dapple.remesh_next(surface_of(0), mesh, surface_of(0), -1.0)


def test_is_unchanged_if_it_is_cancelled():
    sequence = dapple.MeshSequence(surface_of(0), COUNT)
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        sequence.advance(surface_of(4), context=context)
    assert sequence.advance(surface_of(0)).kept == COUNT


# The command


def written(folder, frames: range) -> str:
    arrays = {}
    for k in frames:
        arrays[f"vertices_{k}"], arrays[f"faces_{k}"] = splash(k)
    path = folder / "splash.npz"
    np.savez(path, **arrays)
    return str(path)


def run(*words: str) -> str:
    result = CliRunner().invoke(main, ["remesh", *words], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_the_command_writes_all_frames_as_npz(tmp_path):
    out = tmp_path / "even.npz"
    said = run(written(tmp_path, range(3)), str(out), "-n", "200")
    assert "3 frames with 200 to 2" in said
    with np.load(out) as arrays:
        assert len(arrays["vertices_0"]) == len(arrays["ids_0"]) == 200
        assert arrays["faces_2"].max() == len(arrays["vertices_2"]) - 1
        reports = [json.loads(text) for text in arrays["reports"]]
    assert reports[1]["kept"] > 100
    assert reports[1]["flaws"] == 0


def test_the_command_writes_all_frames_into_a_folder(tmp_path):
    source = tmp_path / "in"
    source.mkdir()
    for k in (0, 2, 3):
        dapple.write_mesh(source / f"splash_{k}.obj", *splash(k))
    empty = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
    empty += (
        "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
    )
    (source / "splash_1.ply").write_text(empty)
    out = tmp_path / "even"
    run(str(source), str(out), "-n", "200")
    assert sorted(path.name for path in out.iterdir()) == [f"splash_{k}.ply" for k in range(4)]
    assert len(dapple.read_mesh(out / "splash_0.ply").vertices) == 200
    assert len(dapple.read_mesh(out / "splash_1.ply", may_be_empty=True).vertices) == 0
    assert len(dapple.read_mesh(out / "splash_3.ply").vertices) > 220


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["even.obj", "-n", "9"], "written into a folder, or as .npz"),
        (["even", "-n", "9", "--least-angle", "9"], "--least-angle needs a motion"),
        (["even", "-n", "9", "--adaptive"], "--adaptive is for one mesh"),
        (["even", "-n", "9", "--non-manifold", "cut"], "--non-manifold is for one mesh"),
    ],
)
def test_the_command_names_what_does_not_fit(tmp_path, words, message):
    words = [written(tmp_path, range(2)), str(tmp_path / words[0]), *words[1:]]
    result = CliRunner().invoke(main, ["remesh", *words])
    assert result.exit_code != 0
    assert message in " ".join(result.output.split())
    assert [path.name for path in tmp_path.iterdir()] == ["splash.npz"]
