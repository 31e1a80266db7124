# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple3d.sample_symmetric and `dapple sample --symmetry`: points in pairs of mirror images."""

import json

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done, refused, run
from dapple3d import density
from mask_checks import CUBE, CUBE_FACES


def sheet(density=None) -> dapple.Surface:
    return dapple.Surface(*shapes.grid(6), density)


def middle() -> np.ndarray:
    return (sheet().vertices.min(axis=0) + sheet().vertices.max(axis=0)) / 2


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "sheet.ply"
    dapple.write_mesh(path, *shapes.grid(6))
    return path


@pytest.mark.parametrize("count", [0, 1, 50, 101])
def test_samples_come_in_pairs(count):
    made = dapple.sample_symmetric(sheet(), count, normal=(0, 2, 0), point=middle())
    positions, mirror = made.samples.positions, made.mirror
    assert len(made) == len(positions) == made.samples.report.count == count
    np.testing.assert_array_equal(mirror[mirror], np.arange(count))
    images = positions.copy()
    images[:, 1] = 2 * middle()[1] - images[:, 1]
    np.testing.assert_allclose(positions[mirror], images, atol=1e-12)
    assert made.mirror_error < 1e-12
    alone = mirror == np.arange(count)
    np.testing.assert_allclose(positions[alone, 1], middle()[1], atol=1e-12)
    first = np.flatnonzero(mirror == np.arange(count) + 1)
    assert (positions[first, 1] > middle()[1]).all()


def test_samples_move_with_the_surface():
    made = dapple.sample_symmetric(sheet(), 60, point=middle())
    moved = sheet().deformed(2.0 * sheet().vertices)
    again = dapple.Samples(moved, made.samples.faces, made.samples.barycentric)
    np.testing.assert_allclose(again.positions, 2.0 * made.samples.positions, atol=1e-12)


def test_a_density_counts_with_its_image():
    x = sheet().vertices[:, 0]
    made = dapple.sample_symmetric(sheet(x - x.min()), 200, point=middle())
    left = made.samples.positions[:, 0] < middle()[0] - 1e-9
    right = made.samples.positions[:, 0] > middle()[0] + 1e-9
    assert left.sum() == right.sum()
    assert (
        made.samples.report.capacity_variation < 0.02
    )  # of the mean, which is the same everywhere


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"normal": (0, 0, 0)}, r"normal is \(0, 0, 0\)"),
        ({"normal": (1, 0)}, "normal has the shape"),
        ({"normal": (np.nan, 0, 0)}, r"normal\[0\] is not finite"),
        ({"point": "x"}, "point has the"),
        ({"point": (0, np.inf, 0)}, r"point\[0\] is not finite"),
        ({"point": (9.0, 0, 0)}, r"surface is not symmetric: .* vertices\[0\]"),
        ({"max_mirror_error": -1}, "max_mirror_error is -1"),
    ],
)
def test_names_what_is_wrong(given, message):
    with pytest.raises(ValueError, match=message):
        dapple.sample_symmetric(sheet(), 50, **{"point": middle(), **given})


def test_an_odd_count_needs_the_plane():
    vertices, faces = shapes.grid(3)
    apart = np.concatenate([vertices + np.array([9, 0, 0]), vertices * [-1, 1, 1] - [9, 0, 0]])
    surface = dapple.Surface(apart, np.concatenate([faces, faces + len(vertices)]))
    assert len(dapple.sample_symmetric(surface, 20)) == 20
    with pytest.raises(ValueError, match="count is 21: it must be even"):
        dapple.sample_symmetric(surface, 21)


def test_stops_when_cancelled():
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.sample_symmetric(sheet(), 50, point=middle(), context=context)


def test_the_command_writes_what_python_makes(tmp_path, file):
    out, at = tmp_path / "pairs.npz", middle()[0]
    arguments = ("-n", 41, "--symmetry", "x", "--symmetry-at", at, "--json", "-", "-q")
    report = json.loads(done("sample", file, out, *arguments).stdout)
    assert report["settings"]["symmetry"] == "x"
    assert report["mirror_error"] < 1e-9
    mesh = dapple.read_mesh(file)
    surface = dapple.Surface(mesh.vertices, mesh.faces)
    made = dapple.sample_symmetric(surface, 41, point=(at, 0, 0))
    with np.load(out) as written:
        np.testing.assert_array_equal(written["positions"], made.samples.positions)
        np.testing.assert_array_equal(written["mirror"], made.mirror)


@pytest.mark.parametrize("suffix", [".csv", ".ply", ".obj"])
def test_the_command_knows_the_formats(tmp_path, file, suffix):
    out = tmp_path / f"pairs{suffix}"
    done("sample", file, out, "-n", 12, "--symmetry", "y", "--symmetry-at", middle()[1])
    assert out.stat().st_size > 0


def test_the_command_refuses(tmp_path, file):
    out = tmp_path / "p.csv"
    far = ("sample", file, out, "-n", 9, "--symmetry-at", 9)
    assert "not symmetric" in refused(*far, "--symmetry", "x")
    assert "need --symmetry" in run(*far).output
    assert not out.exists()


def across_a_step():
    """A symmetric plate with a block stuck through it, whose faces are cut otherwise on each side
    of the plane of symmetry.
    """
    plate, faces = shapes.grid(5)
    span = np.ptp(plate, axis=0).max()
    plate = (plate - (plate.min(axis=0) + plate.max(axis=0)) / 2) / span
    block = CUBE * [0.2, 0.15, 0.1]
    whole = dapple.Surface(np.vstack([plate, block]), np.vstack([faces, CUBE_FACES + len(plate)]))
    right = whole.vertices[whole.faces].mean(axis=1)[:, 0] > 0.01
    cut = dapple.refine_edges(whole, np.where(right, 0.07, np.inf)).surface
    return dapple.Surface(cut.vertices, cut.faces)


def test_pairs_stay_exact_where_what_is_hidden_is_left_out():
    surface = across_a_step()
    masked = density.MaskedSurface(surface, outside=0.05, count=300)
    made = dapple.sample_symmetric(masked.surface, 300)
    samples = masked.pairs_to_original(made)
    np.testing.assert_array_equal(samples.ids, made.samples.ids)
    flip = np.array([-1.0, 1.0, 1.0])
    np.testing.assert_allclose(samples.positions[made.mirror], samples.positions * flip, atol=1e-9)
    assert dapple.exposure(surface, samples.faces, samples.barycentric).min() > 0.0
    alone = masked.to_original(made.samples)  # each moves along its own face
    assert np.abs(alone.positions[made.mirror] - alone.positions * flip).max() > 1e-4


def test_pairs_on_a_surface_without_masks_are_the_samples():
    masked = density.MaskedSurface(sheet(), count=50)
    made = dapple.sample_symmetric(masked.surface, 50, normal=(0, 2, 0), point=middle())
    found = masked.pairs_to_original(made, (0, 2, 0), middle())
    np.testing.assert_array_equal(found.positions, made.samples.positions)


def test_the_command_keeps_pairs_exact_under_masks(tmp_path):
    surface, out = across_a_step(), tmp_path / "out.npz"
    path = tmp_path / "step.npz"
    np.savez(path, vertices=surface.vertices, faces=surface.faces)
    report = done("sample", path, out, "-n", 300, "--symmetry", "x", "--outside", "--json", "-")
    assert json.loads(report.stdout)["report"]["count"] == 300
    with np.load(out) as found:
        images = found["positions"] * [-1.0, 1.0, 1.0]
        np.testing.assert_allclose(found["positions"][found["mirror"]], images, atol=1e-9)
