# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_samples, same_bytes
from shapes import grid

REPORT = {
    "count": int,
    "spacing": float,
    "alpha_min": float,
    "alpha_mean": float,
    "capacity_variation": float,
    "bond_order": float,
    "energy": float,
    "whole_count_variation": float,
    "thin_share": float,
    "evaluations": int,
    "iterations": int,
    "parts": int,
    "converged": bool,
    "seconds": float,
    "profile": dict,
    "energies": list,
    "slide_mean": float,
    "slide_max": float,
    "slide_median": float,
    "births": int,
    "deaths": int,
    "classes": list,
    "worst_overlap": float,
    "overlapping": tuple,
}


@pytest.mark.parametrize("count", [0, 1, 2, 3, 50, 2000])
def test_keeps_the_invariants(surface, dense, count):
    for each in (surface, dense):
        samples = dapple.sample(each, count, max_evaluations=10)
        assert len(samples) == count
        check_samples(each, samples)


def test_takes_more_samples_than_faces():
    square = dapple.Surface(*grid(1))
    check_samples(square, dapple.sample(square, 500))


def test_reports(samples, surface):
    report = samples.report
    for name, kind in REPORT.items():
        assert type(getattr(report, name)) is kind, name
    assert report.to_dict() == {name: getattr(report, name) for name in REPORT}
    assert report.spacing == pytest.approx(surface.spacing(300))
    assert len(report.energies) == report.iterations + 1
    assert report.energy <= report.energies[-1]  # the listed energies include repulsion
    assert np.all(np.diff(report.energies) <= 0)
    assert report.converged
    assert report.seconds > 0


def test_reports_where_the_time_went(dense):
    stages = ["start", "neighbors", "cells", "solver", "projection", "reporting", "other"]
    report = dapple.sample(dense, 300).report
    assert list(report.profile) == stages
    assert min(report.profile.values()) > 0
    assert sum(report.profile.values()) == pytest.approx(report.seconds)
    watched = dapple.sample(dense, 300, context=dapple.Context()).report
    assert min(watched.profile.values()) > 0
    assert dapple.analyze(dense, dapple.sample(dense, 30)).profile == dict.fromkeys(stages, 0.0)


def test_says_when_it_did_not_converge(surface):
    report = dapple.sample(surface, 300, max_evaluations=1).report
    assert (report.converged, report.evaluations, report.iterations) == (False, 1, 0)


def test_gives_the_same_bytes_for_any_threads_and_again(dense):
    base = dapple.sample(dense, 400, seed=3, threads=1)
    for threads in (1, 2, 8, 0):
        again = dapple.sample(dense, 400, seed=3, threads=threads)
        assert same_bytes(again, base), threads
        assert again.report.energies == base.report.energies
    assert not same_bytes(dapple.sample(dense, 400, seed=4), base)


# Ranges of alpha min, alpha mean, capacity variation and energy around the results of the method on
# a torus with the paper's tolerance.
BANDS = {
    "default": ({}, (0.50, 0.85), (0.80, 0.92), (0.0003, 0.008), (0.16037, 0.1715)),
    "random start": (
        {"start": "random", "tolerance": 1e-5},
        (0.40, 0.85),
        (0.79, 0.92),
        (0.0003, 0.01),
        (0.16037, 0.176),
    ),
    "paper": (dapple.PAPER, (0.30, 0.80), (0.79, 0.90), (0.0005, 0.01), (0.16037, 0.179)),
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("way", BANDS)
def test_is_even(surface, way, seed):
    options, *bands = BANDS[way]
    report = dapple.sample(surface, 1000, seed=seed, **options).report
    print(way, report.to_dict())
    found = (report.alpha_min, report.alpha_mean, report.capacity_variation, report.energy)
    assert all(low < value < high for value, (low, high) in zip(found, bands, strict=True)), found


def test_reports_the_evenness_of_a_plane():
    """In the plane the nearest sample is one whose cell touches: all can be measured here."""
    square = dapple.Surface(*grid(6))
    samples = dapple.sample(square, 200)
    gaps = np.linalg.norm(samples.positions[:, None] - samples.positions[None], axis=2)
    np.fill_diagonal(gaps, np.inf)
    alpha = gaps.min(axis=1) / np.sqrt(2 / (np.sqrt(3) * 200))
    assert samples.report.alpha_min == pytest.approx(alpha.min(), rel=1e-12)
    assert samples.report.alpha_mean == pytest.approx(alpha.mean(), rel=1e-12)
    capacities = dapple.evaluate_energy(square, samples.positions, samples.faces).capacities
    assert samples.report.capacity_variation == pytest.approx(capacities.std() * 200, rel=1e-9)


def test_follows_the_density():
    vertices, faces = grid(10)
    samples = dapple.sample(dapple.Surface(vertices, faces, vertices[:, 0]), 900)
    assert np.count_nonzero(samples.positions[:, 0] ** 2 < 1 / 3) == pytest.approx(300, abs=20)


def test_stays_off_what_has_no_density():
    vertices, faces = grid(10)
    density = np.zeros(len(vertices))
    density[60] = 1  # the middle
    start = dapple.sample(dapple.Surface(vertices, faces, density), 100, max_evaluations=1)
    assert np.abs(start.positions[:, :2] - 0.5).max() <= 0.1 + 1e-12


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0), (1e6, 0), (1, 1e6)])
def test_does_not_depend_on_units(mesh, surface, scale, shift):
    vertices, faces = mesh
    moved = dapple.Surface(scale * vertices + shift, faces)
    samples = dapple.sample(moved, 200)
    check_samples(moved, samples)
    expected = dapple.sample(surface, 200).report.energy
    assert samples.report.energy == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"count": -1}, "count.*-1"),
        ({"count": 2**40}, "count"),
        ({"capacity_weight": -1.0}, "capacity_weight.*-1"),
        ({"capacity_weight": np.nan}, "capacity_weight.*nan"),
        ({"tolerance": -1e-3}, "tolerance"),
        ({"tolerance": np.inf}, "tolerance"),
        ({"max_evaluations": 0}, "max_evaluations.*0"),
        ({"threads": -1}, "threads.*-1"),
        ({"start": "lattice"}, "start.*lattice"),
        ({"method": "newton"}, "method.*newton"),
        ({"repulsion_weight": -1.0}, "repulsion_weight.*-1"),
        ({"repulsion_weight": np.nan}, "repulsion_weight.*nan"),
    ],
)
def test_names_the_option_out_of_range(surface, options, match):
    arguments = {"count": 10} | options
    with pytest.raises(ValueError, match=match):
        dapple.sample(surface, arguments.pop("count"), **arguments)


@pytest.mark.parametrize("seed", [-1, 2**64, 0.5, None])
def test_refuses_a_seed_out_of_range(surface, seed):
    with pytest.raises((TypeError, ValueError, OverflowError)):
        dapple.sample(surface, 10, seed=seed)


def test_takes_the_largest_seed(surface):
    assert len(dapple.sample(surface, 10, seed=2**64 - 1)) == 10


def test_takes_options_by_keyword_only(surface):
    with pytest.raises(TypeError):
        dapple.sample(surface, 10, 3)
