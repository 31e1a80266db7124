# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array, check_samples
from shapes import bent, grid


def flat_uv(mesh):
    """u = x, v = y."""
    vertices, faces = mesh
    return vertices[faces][:, :, :2]


def checks(rows=32, columns=32, squares=4):
    row, column = np.indices((rows, columns))
    return ((row * squares // rows + column * squares // columns) % 2).astype(float)


@pytest.fixture(scope="module")
def refined():
    square = grid(5)
    return dapple.refine_image(dapple.Surface(*square), flat_uv(square), checks())


def test_refines_to_an_image(refined):
    surface = refined.surface
    assert refined.resolved
    assert surface.density_at == "corners"
    assert surface.area == pytest.approx(1, rel=1e-12)
    assert surface.capacity == pytest.approx(0.5, rel=0.01)
    check_array(refined.parents, np.int32, (len(surface.faces),))
    check_array(refined.barycentric, np.float64, (len(surface.faces), 3, 3))
    corners = refined.original.vertices[refined.original.faces[refined.parents]]
    there = np.einsum("fkc,fcd->fkd", refined.barycentric, corners)
    np.testing.assert_allclose(surface.vertices[surface.faces], there, rtol=0, atol=1e-12)


def test_brings_samples_back(refined):
    fine = dapple.sample(refined.surface, 200)
    samples = refined.to_original(fine)
    check_samples(refined.original, samples)
    np.testing.assert_allclose(samples.positions, fine.positions, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(samples.ids, fine.ids)
    assert samples.report.to_dict() == fine.report.to_dict()
    x, y = samples.positions[:, :2].T
    white = checks(4, 4)[np.minimum(4 * y, 3).astype(int), np.minimum(4 * x, 3).astype(int)] == 1
    assert white.mean() > 0.95  # one pixel of 32 leads from white to black


def test_brings_samples_there(refined):
    samples = dapple.sample(refined.original, 200)
    fine = refined.from_original(samples)
    check_samples(refined.surface, fine)
    np.testing.assert_allclose(fine.positions, samples.positions, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(refined.parents[fine.faces], samples.faces)


def test_cuts_long_edges():
    surface = dapple.Surface(*grid(2))
    refined = dapple.refine_edges(surface, 0.1)
    corners = refined.surface.vertices[refined.surface.faces]
    assert np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() <= 0.1
    assert refined.surface.density is None
    assert refined.surface.area == pytest.approx(1, rel=1e-12)
    few = dapple.refine_edges(surface, [0.05] + 7 * [np.inf])
    assert len(refined.surface.faces) > 100 < len(few.surface.faces) < 2000
    with pytest.raises(ValueError, match=r"longest.*0"):
        dapple.refine_edges(surface, 0)
    with pytest.raises(ValueError, match=r"longest.*2.*8"):
        dapple.refine_edges(surface, [1.0, 1.0])
    with pytest.raises(ValueError, match=r"max_faces.*0"):
        dapple.refine_edges(surface, 0.1, max_faces=0)


def test_follows_a_deformation(refined):
    moved = bent(refined.original.vertices, 1.0)
    carried = refined.deformed(moved)
    np.testing.assert_array_equal(carried.surface.vertices, refined.vertices(moved))
    tracker = dapple.Tracker(refined.surface, dapple.sample(refined.surface, 100))
    samples = carried.to_original(tracker.advance(refined.vertices(moved)))
    check_samples(carried.original, samples)


def test_refines_twice(refined):
    finer = dapple.refine_obstacles(refined.surface, [[0.5, 0.5, 0]], 0.2)
    both = refined.then(finer)
    fine = dapple.sample(both.surface, 100)
    samples = both.to_original(fine)
    check_samples(refined.original, samples)
    np.testing.assert_allclose(samples.positions, fine.positions, rtol=0, atol=1e-12)
    assert np.linalg.norm(samples.positions - [0.5, 0.5, 0], axis=1).min() >= 0.2
    with pytest.raises(ValueError, match="finer"):
        finer.then(refined)


def test_keeps_off_obstacles(surface, mesh):
    random = np.random.default_rng(3)
    points = mesh[0][random.choice(len(mesh[0]), 12, replace=False)]
    radii = random.uniform(0.05, 0.2, 12)
    refined = dapple.refine_obstacles(surface, points, radii)
    samples = refined.to_original(dapple.sample(refined.surface, 400))
    check_samples(surface, samples)
    gaps = np.linalg.norm(samples.positions[:, None] - points, axis=2) - radii
    assert gaps.min() >= 0
    assert samples.report.capacity_variation < 0.01


def test_keeps_off_areas(surface):
    areas = surface.vertices[surface.faces].mean(axis=1)[:, 0] < 0
    refined = dapple.refine_obstacles(surface, np.empty((0, 3)), 1.0, areas=areas)
    assert not areas[dapple.sample(refined.surface, 200).faces].any()


def test_gives_the_same_bytes_again():
    square = grid(3)
    image = np.random.default_rng(5).random((20, 30))
    one, two = (
        dapple.refine_image(dapple.Surface(*square), flat_uv(square), image) for _ in range(2)
    )
    for name in ["vertices", "faces", "density"]:
        assert getattr(one.surface, name).tobytes() == getattr(two.surface, name).tobytes()


def test_says_when_faces_are_too_few():
    square = grid(2)
    refined = dapple.refine_image(
        dapple.Surface(*square), flat_uv(square), checks(200, 200, 20), max_faces=1000
    )
    assert not refined.resolved
    assert len(refined.surface.faces) <= 1000


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"uv": np.zeros((32, 3))}, r"uv.*\(32, 3\).*\(m, 3, 2\)"),
        ({"uv": np.zeros((31, 3, 2))}, "uv.*31.*32"),
        ({"uv": np.full((32, 3, 2), np.nan)}, r"uv\[0, 0\].*nan"),
        ({"image": np.ones(9)}, r"image.*\(9,\)"),
        ({"image": np.zeros((3, 3))}, "image.*0 everywhere"),
        ({"image": [[1, 2], [3, -4]]}, r"image\[1, 1\].*-4"),
        ({"max_error": 0}, "max_error.*0"),
        ({"texels": -1}, "texels.*-1"),
        ({"max_faces": 0}, "max_faces.*0"),
    ],
)
def test_refuses_a_bad_image(change, match):
    square = grid(4)
    arguments = {"uv": flat_uv(square), "image": checks()} | change
    with pytest.raises(ValueError, match=match):
        dapple.refine_image(dapple.Surface(*square), **arguments)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"points": np.zeros((2, 2))}, r"points.*\(2, 2\)"),
        ({"points": [[0, 0, np.inf]], "radii": 1}, r"points\[0\].*inf"),
        ({"radii": [1.0]}, "radii.*1.*2"),
        ({"radii": 0}, r"radii\[0\].*0"),
        ({"radii": 9.0}, "points.*all of the surface"),
        ({"areas": np.zeros(32)}, "areas"),
        ({"areas": np.zeros(31, bool)}, "areas.*31.*32"),
        ({"edge": np.nan}, "edge.*nan"),
        ({"max_faces": 300_000_000}, "max_faces.*300000000"),
    ],
)
def test_refuses_bad_obstacles(change, match):
    arguments = {"points": [[0.2, 0.2, 0], [0.8, 0.8, 0]], "radii": [0.1, 0.1]} | change
    with pytest.raises(ValueError, match=match):
        dapple.refine_obstacles(dapple.Surface(*grid(4)), **arguments)


def test_stops_when_cancelled():
    context = dapple.Context()
    context.cancel()
    square = grid(4)
    surface = dapple.Surface(*square)
    with pytest.raises(dapple.Cancelled):
        dapple.refine_image(surface, flat_uv(square), checks(), context=context)
    with pytest.raises(dapple.Cancelled):
        dapple.refine_obstacles(surface, [[0, 0, 0]], 0.1, context=context)
    with pytest.raises(dapple.Cancelled):
        dapple.refine_edges(surface, 0.1, context=context)
