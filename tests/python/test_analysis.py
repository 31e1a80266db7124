# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures of samples, spectra and their pictures."""

import io
import subprocess
import sys

import dapple3d as dapple
import numpy as np
import pytest
from shapes import grid, torus


def hexagons(columns: int = 24, rows: int = 28) -> np.ndarray:
    """Offset rows that close around the unit torus."""
    row, column = (index.ravel() for index in np.indices((rows, columns)))
    return np.column_stack([(column + 0.5 * (row % 2)) / columns, row / rows])


def white_runs(runs: int = 10, count: int = 400) -> list[np.ndarray]:
    random = np.random.default_rng(7)
    return [random.random((count, 2)) for _ in range(runs)]


def test_analyzes_as_reported(surface, samples):
    report = dapple.analyze(surface, samples)
    for name in ("count", "spacing", "alpha_min", "alpha_mean", "capacity_variation", "bond_order"):
        assert getattr(report, name) == pytest.approx(getattr(samples.report, name), rel=1e-6)
    assert report.to_dict()["bond_order"] == report.bond_order
    assert 0.3 < report.bond_order < 0.7


def test_analyzes_points(surface, samples):
    from_points = dapple.analyze(surface, samples.positions)
    assert from_points.alpha_mean == pytest.approx(samples.report.alpha_mean, rel=1e-6)


def test_analyzes_a_lattice():
    """The border's hexagons are cut and left out."""
    columns, rows = 20, 22
    height = rows * np.sqrt(3) / 2
    vertices, faces = grid(1)
    surface = dapple.Surface(vertices * [columns, height, 1], faces)
    row, column = (index.ravel() for index in np.indices((rows, columns)))
    points = np.column_stack(
        [column + 0.25 + 0.5 * (row % 2), (row + 0.5) * np.sqrt(3) / 2, 0 * row]
    )
    assert dapple.analyze(surface, points).bond_order == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (np.full((3, 3), np.nan), "points[0] is not finite"),
        (np.zeros((3, 2)), "samples has the shape (3, 2)"),
        ("none", "samples has the"),
    ],
)
def test_names_bad_samples(surface, points, words):
    with pytest.raises(ValueError, match=r"samples|points") as caught:
        dapple.analyze(surface, points)
    assert words in str(caught.value)


def test_is_the_squared_fourier_sum():
    points = white_runs(1, 60)[0]
    found = dapple.spectrum(points, half_width=8)
    f = np.arange(-8, 9)
    waves = (
        np.exp(-2j * np.pi * f[:, None] * points[:, 0]),
        np.exp(-2j * np.pi * f[:, None] * points[:, 1]),
    )
    expected = np.abs(waves[1] @ waves[0].T) ** 2 / 60
    np.testing.assert_allclose(found.periodogram, expected, atol=1e-11)
    assert found.frequency_unit == pytest.approx(np.sqrt(60))


def test_takes_runs_in_any_sequence():
    runs = white_runs(3, 50)
    expected = dapple.spectrum(runs).periodogram
    for same in (tuple(runs), np.array(runs), [run.tolist() for run in runs]):
        np.testing.assert_array_equal(dapple.spectrum(same).periodogram, expected)
    np.testing.assert_array_equal(
        dapple.spectrum(runs[0].tolist()).periodogram, dapple.spectrum(runs[0]).periodogram
    )
    uneven = dapple.spectrum([runs[0], runs[1][:20]])
    assert uneven.runs == 2


def test_white_noise_is_white():
    found = dapple.spectrum(white_runs())
    np.testing.assert_allclose(found.radial.mean[5:], 1, atol=0.5)
    assert found.radial.mean.mean() == pytest.approx(1, abs=0.03)
    assert (10 ** (found.radial.anisotropy[10:] / 10)).mean() == pytest.approx(0.1, rel=0.1)


def test_a_lattice_is_its_reciprocal():
    found = dapple.spectrum(hexagons(), half_width=60)
    y, x = np.nonzero(found.periodogram > 1e-6)
    assert set((x - 60) % 24) == {0}
    assert set((y - 60) % 14) == {0}
    np.testing.assert_allclose(found.periodogram[y, x], 24 * 28)


def test_shows_arrays_without_copies():
    found = dapple.spectrum(white_runs(), half_width=9)
    assert found.periodogram.shape == (19, 19)
    for array in (found.periodogram, found.radial.mean, found.radial.anisotropy):
        assert array.dtype == np.float64
        assert not array.flags.writeable
    assert found.periodogram.ctypes.data == found.periodogram.ctypes.data
    mean = found.radial.mean
    kept = mean.copy()
    del found
    np.testing.assert_array_equal(mean, kept)


@pytest.mark.parametrize(
    ("runs", "words"),
    [
        ([], "runs"),
        (np.zeros((0, 2)), "runs[0] has no points"),
        ([np.zeros((2, 2)), np.zeros((0, 2))], "runs[1] has no points"),
        ([[0.5, np.nan]], "runs[0][0] is not in the unit square"),
        ([[0.5, 0.5], [0.5, 640.0]], "runs[0][1] is not in the unit square"),
        (np.zeros((4, 3)), "runs has the shape (4, 3)"),
        ([np.zeros((4, 2)), np.zeros((4, 3))], "runs[1] has the shape (4, 3)"),
        (np.zeros((2, 4, 3)), "runs[0] has the shape (4, 3)"),
        ("points", "runs"),
        (None, "runs"),
    ],
)
def test_names_bad_points(runs, words):
    with pytest.raises(ValueError, match=r"runs") as caught:
        dapple.spectrum(runs)
    assert words in str(caught.value)


def test_surface_spectrum_is_blue(surface, samples):
    found = dapple.surface_spectrum(surface, samples, radius=4.0, bins=64)
    assert found.runs == 1
    assert found.centers == len(samples)
    assert found.differentials.shape == (64, 64)
    assert np.isnan(found.differentials[0, 0])
    near = found.radial_differentials
    assert near.mean[near.radius < 0.5].max() == 0
    power = found.radial_power
    assert power.mean[(power.radius > 0.2) & (power.radius < 0.5)].max() < 0.4
    assert 0.8 < power.radius[power.mean.argmax()] < 1.3


def test_surface_spectrum_takes_points_and_runs(surface, samples):
    other = dapple.sample(surface, 300, seed=1)
    one = dapple.surface_spectrum(surface, samples)
    two = dapple.surface_spectrum(surface, [samples, other])
    assert (one.runs, two.runs) == (1, 2)
    points = dapple.surface_spectrum(surface, [samples.positions, other.positions])
    np.testing.assert_allclose(points.radial_power.mean, two.radial_power.mean, atol=1e-3)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"radius": -1.0}, "radius is -1"),
        ({"bins": 7}, "bins is 7"),
        ({"runs": []}, "runs is empty"),
        ({"runs": np.zeros((1, 3))}, "runs[0] has 1 samples"),
        ({"runs": [np.zeros((4, 2))]}, "runs[0] has the shape (4, 2)"),
    ],
)
def test_names_bad_options(surface, samples, options, words):
    with pytest.raises(ValueError, match=r"radius|bins|runs") as caught:
        dapple.surface_spectrum(surface, **{"runs": samples, **options})
    assert words in str(caught.value)


def test_is_cancelled(surface, samples):
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.spectrum(white_runs(), context=context)
    with pytest.raises(dapple.Cancelled):
        dapple.surface_spectrum(surface, samples, context=context)


def figures() -> dict:
    pytest.importorskip("matplotlib")
    from dapple3d import plot

    surface = dapple.Surface(*torus())
    plane, around = (
        dapple.spectrum(white_runs()),
        dapple.surface_spectrum(surface, dapple.sample(surface, 300)),
    )
    return {
        "points": plot.points(hexagons(), title="Hexagons"),
        "points of a surface": plot.points(dapple.sample(surface, 100)),
        "periodogram": plot.periodogram(plane, title="White noise"),
        "periodogram of a surface": plot.periodogram(around),
        "radial power": plot.radial_power(plane),
        "radial power of a surface": plot.radial_power(around),
        "anisotropy": plot.anisotropy(plane),
        "anisotropy of a lattice": plot.anisotropy(dapple.spectrum(hexagons())),
        "differentials": plot.differentials(around),
        "summary": plot.summary(plane),
    }


def test_draws_labeled_pictures():
    from PIL import Image

    for name, figure in figures().items():
        for axes in figure.axes:
            assert axes.get_ylabel(), name
            assert axes.get_xlabel() or axes.get_label() == "<colorbar>", name
        file = io.BytesIO()
        figure.savefig(file, format="png")
        pixels = np.asarray(Image.open(file).convert("L"))
        assert pixels.std() > 5, name
        assert len(np.unique(pixels)) > 20, name


def test_draws_without_global_state():
    pytest.importorskip("matplotlib")
    code = "\n".join(
        [
            "import sys, numpy, dapple3d",
            "from dapple3d import plot",
            "assert 'matplotlib' not in sys.modules",
            "plot.points(numpy.random.rand(9, 2))",
            "assert 'matplotlib.pyplot' not in sys.modules",
        ]
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr


def test_says_that_matplotlib_is_missing(monkeypatch):
    from dapple3d import plot

    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ImportError, match="matplotlib, which is not installed"):
        plot.points(hexagons())


def test_names_the_shape_of_bad_points():
    from dapple3d import plot

    with pytest.raises(ValueError, match=r"positions has the shape \(4,\)"):
        plot.points(np.zeros(4))
