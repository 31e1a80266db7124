# SPDX-License-Identifier: GPL-3.0-or-later
"""Discs of classes that stay inside the border of a surface and of what a density leaves."""

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done, refused, run
from dapple3d import density
from dapple3d.density import Range, border_edges
from mask_checks import SQUARE, TWO, by_hand
from shapes import grid, torus

RADIUS = 0.3


def plane() -> dapple.Surface:
    """A square from -2 to 2 of two triangles."""
    return dapple.Surface(SQUARE, TWO)


def solved(masked, *, count=25, threads=0):
    """Large things that stay inside, among small ones."""
    large = dapple.SampleClass(count, radius=RADIUS, **masked.class_density("large"))
    found = dapple.sample_classes(masked.surface, [large, 300], threads=threads)
    return masked.to_original(found)


def test_no_disc_sticks_out_over_the_border():
    masked = density.MaskedSurface(plane(), count=360)
    masked.clear_borders({"large": ("", RADIUS)})
    samples = solved(masked)
    away = 2.0 - np.abs(samples.positions[:, :2]).max(axis=1)
    assert away[samples.classes == 0].min() >= RADIUS
    assert away[samples.classes == 1].min() < RADIUS, "the others are up to the border"
    assert np.bincount(samples.classes).tolist() == [25, 300]
    assert masked.cleared_share("large") == pytest.approx((3.4 / 4.0) ** 2, rel=0.03)


def test_no_point_of_a_face_that_is_clear_is_nearer():
    for distance in (0.02, 0.5, 1.3):
        masked = density.MaskedSurface(plane(), count=200)
        masked.clear_borders({"large": ("", distance)})
        faces = masked.surface.faces[masked.corner_density("large").max(axis=1) > 0.0]
        weights = np.random.default_rng(1).dirichlet(np.ones(3), size=len(faces))
        points = np.einsum("mk,mkd->md", weights, masked.surface.vertices[faces])
        assert len(points)
        assert by_hand(points, border_edges(SQUARE, TWO)).min() >= distance


def test_areas_without_density_have_a_border_too():
    half = density.Height(Range(high=0.0))
    slope = SQUARE + SQUARE[:, :1] * [0.0, 0.0, 1.0]  # z = x
    values = {"moist": np.array([[1.0], [0.0]])}
    masked = density.MaskedSurface(dapple.Surface(slope, TWO), [half], count=300, values=values)
    masked.clear_borders({"large": ("", RADIUS), "both": ("moist", RADIUS)})
    samples = solved(masked, count=20)
    large = samples.positions[samples.classes == 0]
    spacing = masked.surface.spacing(320)
    assert (-large[:, 0] * np.sqrt(2.0)).min() >= RADIUS - 0.3 * spacing
    both = masked.corner_density("both").max(axis=1) > 0.0
    assert both.any()
    assert not (both & (masked.corner_density("large").max(axis=1) == 0.0)).any()
    assert (masked.pieces[0][both] == 0).all(), "where its own values are"


def test_the_frame_of_a_camera_is_no_border():
    clip = np.diag([1.0, 1.0, 1.0, 0.0]) + np.eye(4)[3][:, None] * np.eye(4)[3]  # |x|, |y| < 1
    masked = density.MaskedSurface(plane(), [density.Camera(clip)], count=300)
    masked.clear_borders({"large": ("", RADIUS)})
    assert masked.cleared_share("large") == 1.0
    assert np.abs(solved(masked).positions[:, :2]).max() > 0.97


def test_a_closed_surface_has_no_border():
    masked = density.MaskedSurface(dapple.Surface(*torus()), count=300)
    masked.clear_borders({"large": ("", RADIUS)})
    assert masked.class_density("large") == {}
    assert masked.cleared_share("large") == 1.0
    assert not masked.is_cut


def test_the_border_is_that_of_the_surface_at_rest():
    vertices, faces = grid()
    first = density.MaskedSurface(dapple.Surface(vertices, faces), count=300)
    later = density.MaskedSurface(
        dapple.Surface(vertices * [1.0, 1.5, 1.0], faces), count=300, rest=vertices
    )
    for one in (first, later):
        one.clear_borders({"large": ("", 0.1)})
    np.testing.assert_array_equal(first.corner_density("large"), later.corner_density("large"))


def test_the_same_bytes_for_any_number_of_threads():
    made = []
    for threads in (1, 2, 3):
        masked = density.MaskedSurface(plane(), count=360)
        masked.clear_borders({"large": ("", RADIUS)})
        made.append(solved(masked, threads=threads).positions.tobytes())
    assert len(set(made)) == 1


def test_what_is_refused():
    masked = density.MaskedSurface(plane(), count=300, values={"moist": np.ones(4)})
    for name, wanted, said in (
        ("moist", ("", 1.0), "clear_borders 'moist': another name is needed"),
        ("", ("", 1.0), "clear_borders '': another name is needed"),
        ("large", ("dry", 1.0), "clear_borders 'large': there are no values 'dry'"),
        ("large", ("", 0.0), "clear_borders 'large': the distance is 0.0: it must be finite and"),
        ("large", ("", np.nan), "clear_borders 'large': the distance is nan"),
    ):
        with pytest.raises(ValueError, match=said):
            masked.clear_borders({name: wanted})


def test_cutting_can_be_cancelled():
    context = dapple.Context()
    masked = density.MaskedSurface(plane(), count=300, context=context)
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        masked.clear_borders({"large": ("", RADIUS)})


@pytest.fixture
def square(tmp_path):
    path = tmp_path / "square.npz"
    np.savez(path, vertices=SQUARE, faces=TWO)
    return path


def test_the_command_moves_in_or_removes(tmp_path, square):
    counts = {}
    for borders in ("keep", "move-in", "remove"):
        out = tmp_path / f"{borders}.npz"
        wanted = f"25:radius={RADIUS},borders={borders}"
        done("classes", square, out, "--class", wanted, "--class", "300")
        with np.load(out) as stored:
            large = stored["positions"][stored["classes"] == 0]
        counts[borders] = len(large)
        nearest = (2.0 - np.abs(large[:, :2]).max(axis=1)).min()
        assert (nearest >= RADIUS) == (borders != "keep")
    assert counts["keep"] == counts["move-in"] == 25
    assert counts["remove"] in (17, 18), "a share of (3.4 / 4)^2 is left of 25"


def test_the_command_says_what_is_wrong(tmp_path, square):
    out = tmp_path / "out.csv"
    said = refused("classes", square, out, "--class", "9:radius=3,borders=move-in")
    assert "class 0 has no room: no place is 3 away from the border" in said
    found = run("classes", square, out, "--class", "9:borders=trim")
    assert found.exit_code == 2
    assert "B is one of keep, move-in, remove" in found.stderr
