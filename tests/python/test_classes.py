# SPDX-License-Identifier: GPL-3.0-or-later
"""Several classes of samples at once."""

import dapple3d as dapple
import numpy as np
import pytest
from shapes import torus


@pytest.fixture(scope="module")
def surface() -> dapple.Surface:
    return dapple.Surface(*torus())


def test_counts_and_classes(surface: dapple.Surface) -> None:
    samples = dapple.sample_classes(surface, [30, dapple.SampleClass(0), np.int64(1), 60])
    assert np.bincount(samples.classes, minlength=4).tolist() == [30, 0, 1, 60]
    assert [quality.count for quality in samples.report.classes] == [30, 0, 1, 60]
    assert samples.report.to_dict()["classes"][3]["count"] == 60


def test_torus_is_even_each_and_together() -> None:
    """500 + 500, the mean of five seeds."""
    runs = [
        dapple.sample_classes(dapple.Torus(), [500, 500], seed=seed, max_evaluations=25)
        for seed in range(5)
    ]

    def mean(qualities: list[dapple.Quality], name: str) -> float:
        return float(np.mean([getattr(quality, name) for quality in qualities]))

    classes = [quality for run in runs for quality in run.report.classes]
    union: list[dapple.Quality] = [run.report for run in runs]
    assert mean(classes, "alpha_min") >= 0.62
    assert mean(classes, "alpha_mean") >= 0.76
    assert mean(classes, "capacity_variation") <= 0.02
    assert mean(union, "alpha_min") >= 0.54
    assert mean(union, "alpha_mean") >= 0.70
    assert mean(union, "capacity_variation") <= 0.01


def test_densities_of_classes(surface: dapple.Surface) -> None:
    up = np.clip(surface.vertices[:, 2], 0, None)
    samples = dapple.sample_classes(
        surface,
        [
            dapple.SampleClass(50, density=up),
            dapple.SampleClass(50, density=np.ones(len(surface.faces)), density_at="faces"),
        ],
    )
    assert samples.positions[samples.classes == 0, 2].min() > -0.1
    assert samples.positions[samples.classes == 1, 2].min() < -0.3


def test_things_keep_apart(surface: dapple.Surface) -> None:
    samples = dapple.sample_classes(
        surface, [dapple.SampleClass(6, radius=0.3), dapple.SampleClass(100, radius=0.05)]
    )
    report = samples.report
    assert report.worst_overlap < 0.02
    if report.worst_overlap > 0:
        i, j = report.overlapping
        wanted = sum(0.3 if samples.classes[k] == 0 else 0.05 for k in (i, j))
        distance = np.linalg.norm(samples.positions[i] - samples.positions[j])
        assert report.worst_overlap == pytest.approx(1 - distance / wanted, abs=1e-6)


def within(samples: dapple.Samples | dapple.PlanarSamples) -> float:
    """The smallest distance between a sample of class 0 and one of another."""
    rocks = samples.positions[samples.classes == 0]
    others = samples.positions[samples.classes != 0]
    return float(np.linalg.norm(others[:, None] - rocks[None], axis=2).min())


@pytest.mark.parametrize("radius", [0.15, 0.25])
def test_samples_without_a_radius_stay_outside_those_with_one(
    surface: dapple.Surface, radius: float
) -> None:
    classes = [dapple.SampleClass(20, radius=radius), dapple.SampleClass(300)]
    samples = dapple.sample_classes(surface, classes, seed=1)
    assert within(samples) >= radius
    assert samples.report.worst_overlap == 0
    assert samples.report.overlapping == (-1, -1)


def test_tracked_samples_without_a_radius_stay_outside_those_with_one(
    surface: dapple.Surface,
) -> None:
    classes = [dapple.SampleClass(20, radius=0.2), dapple.SampleClass(300)]
    samples = dapple.sample_classes(surface, classes)
    tracker = dapple.Tracker(surface, samples, classes=classes)
    for frame in range(1, 5):
        tracker.advance(surface.vertices * [1.0 + 0.05 * frame, 1.0, 1.0 - 0.03 * frame])
        report = tracker.samples.report
        assert report.worst_overlap < 0.1
        assert 1 - within(tracker.samples) / 0.2 <= report.worst_overlap + 1e-6


def test_samples_without_a_radius_in_the_plane_stay_outside_those_with_one() -> None:
    classes = [dapple.SampleClass(12, radius=0.08), dapple.SampleClass(200)]
    samples = dapple.sample_classes(dapple.Torus(), classes)
    assert samples.report.worst_overlap == 0
    assert within(samples) >= 0.08


def test_paper_preset(surface: dapple.Surface) -> None:
    samples = dapple.sample_classes(surface, [50, 100], **dapple.PAPER, two_stages=True)
    assert samples.report.capacity_variation < 0.1


def test_locked_samples_stay(surface: dapple.Surface) -> None:
    locked = dapple.sample(surface, 20, seed=5)
    samples = dapple.sample(surface, 200, locked=locked)
    assert np.allclose(samples.positions[:20], locked.positions, atol=1e-12)
    assert len(samples) == 200


def test_tracker_keeps_classes(surface: dapple.Surface) -> None:
    classes = [dapple.SampleClass(50), dapple.SampleClass(100)]
    samples = dapple.sample_classes(surface, classes)
    tracker = dapple.Tracker(surface, samples, classes=classes, repulsion_weight=5.0)
    moved = tracker.advance(surface.vertices * [1.0, 1.0, 1.2])
    assert np.array_equal(moved.classes, samples.classes)
    assert [quality.count for quality in moved.report.classes] == [50, 100]


@pytest.mark.parametrize(
    ("classes", "message"),
    [
        ([], "classes is empty"),
        (["grass"], r"classes\[0\] is 'grass'"),
        ([10, -1], "count is -1"),
        ([dapple.SampleClass(10, radius=-1.0)], "radius is -1"),
        ([dapple.SampleClass(100, radius=10.0)], "radii need discs of area"),
        ([2, dapple.SampleClass(1, density=[1.0])], r"classes\[1\].density has 1 value"),
        (
            [dapple.SampleClass(1, density_at="edges", density=[1.0])],
            r"\[0\].density_at is 'edges'",
        ),
    ],
)
def test_bad_input_is_named(surface: dapple.Surface, classes: list, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        dapple.sample_classes(surface, classes)


def test_images_are_of_one_shape() -> None:
    classes = [
        dapple.SampleClass(5, density=np.ones((2, 2))),
        dapple.SampleClass(5, density=np.ones((3, 2))),
    ]
    with pytest.raises(ValueError, match="density of class 1 is 3 x 2 pixels"):
        dapple.sample_classes(dapple.Plane(1, 1), classes)


def test_locked_samples_stay_in_their_class(surface):
    """They come first in it, and the others are spread around them."""
    free = dapple.sample_classes(surface, [60, 40])
    rows = np.flatnonzero(free.classes == 1)[:7]
    locked = dapple.Samples(surface, free.faces[rows], free.barycentric[rows])
    classes = [dapple.SampleClass(50), dapple.SampleClass(45, locked=locked)]
    samples = dapple.sample_classes(surface, classes, seed=3)
    np.testing.assert_allclose(samples.positions[50:57], locked.positions, rtol=0, atol=1e-12)
    assert (samples.classes[50:] == 1).all()
    assert samples.report.capacity_variation < 0.05


def test_refuses_bad_locked_samples(surface):
    with pytest.raises(ValueError, match=r"locked is 3: Samples"):
        dapple.SampleClass(5, locked=3)
    locked = dapple.sample(surface, 5)
    with pytest.raises(ValueError, match=r"locked holds 5"):
        dapple.sample_classes(surface, [dapple.SampleClass(4, locked=locked)])
    with pytest.raises(ValueError, match=r"classes\[0\] has locked samples"):
        dapple.sample_classes(dapple.Plane(1, 1), [dapple.SampleClass(9, locked=locked)])
