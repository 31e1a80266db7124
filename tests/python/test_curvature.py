# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array
from shapes import grid, torus


def test_measures_a_torus():
    vertices, faces = torus(120, 60)
    found = dapple.curvedness(dapple.Surface(vertices, faces))
    check_array(found, np.float64, (len(vertices),))
    ring = np.hypot(vertices[:, 0], vertices[:, 1])
    expected = np.hypot(1 / 0.4, (ring - 1) / 0.4 / ring) / np.sqrt(2)
    np.testing.assert_allclose(found, expected, rtol=0.03)


def test_makes_a_density(surface):
    density = dapple.curvature_density(surface)
    check_array(density, np.float64, (len(surface.vertices),))
    assert density.min() >= 0.1
    assert density.max() == 1
    values = dapple.curvedness(surface, smoothing=1)
    steep = dapple.curvature_density(surface, exponent=3, floor=0, percentile=100, smoothing=1)
    np.testing.assert_allclose(steep, (values / values.max()) ** 3, rtol=1e-12)
    samples = dapple.sample(surface.with_density(steep), 200)
    assert samples.report.capacity_variation < 0.02


def test_is_one_on_a_plane():
    np.testing.assert_array_equal(dapple.curvature_density(dapple.Surface(*grid(4))), 1)


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("exponent", 0),
        ("exponent", np.nan),
        ("floor", -0.1),
        ("floor", 1.5),
        ("percentile", 0),
        ("percentile", 101),
        ("smoothing", -1),
        ("smoothing", 101),
    ],
)
def test_names_the_option_out_of_range(surface, option, value):
    with pytest.raises(ValueError, match=rf"{option} is {value}"):
        dapple.curvature_density(surface, **{option: value})


def thin(width: float, rows: int, height: float) -> dapple.Surface:
    """A strip of length 1, flat or waved."""
    y, x = np.mgrid[: rows + 1, :61].astype(float)
    vertices = np.stack([x / 60, width * y, height * np.sin(x / 8)], axis=2).reshape(-1, 3)
    corner = (np.arange(rows)[:, None] * 61 + np.arange(60)).ravel()
    beside, above, across = corner + 1, corner + 61, corner + 62
    faces = np.stack([[corner, beside, across], [corner, across, above]], axis=2)
    return dapple.Surface(vertices, faces.T.reshape(-1, 3))


@pytest.mark.parametrize("smoothing", [0, 2, 5])
@pytest.mark.parametrize("rows", [1, 6])
@pytest.mark.parametrize("height", [0.0, 0.1])
@pytest.mark.parametrize("width", [1e-2, 1e-6, 1e-9, 1e-12])
def test_is_finite_on_strips_that_are_welded_to_themselves(width, height, rows, smoothing):
    surface = thin(width, rows, height)
    found = dapple.curvedness(surface, smoothing=smoothing)
    assert np.isfinite(found).all()
    assert height > 0.0 or found.max() < 1e-6
    assert np.isfinite(dapple.curvature_density(surface, smoothing=smoothing)).all()


def test_is_finite_beside_a_spike():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1e6, 1e6, 1]]
    surface = dapple.Surface(vertices, [[0, 1, 2], [1, 3, 2]])
    assert np.isfinite(dapple.curvedness(surface)).all()
