# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array


def test_every_beginning_is_even(surface, samples):
    ranks = dapple.progressive_ranks(samples.positions)
    check_array(ranks, np.int32, (len(samples),))
    assert sorted(ranks) == list(range(len(samples)))
    for count in (len(samples) // 2, len(samples) // 3, len(samples) // 8):
        kept = dapple.analyze(surface, samples.positions[ranks < count])
        assert kept.alpha_mean > 0.65
        assert kept.alpha_min > 0.4


def test_classes_keep_their_shares(surface):
    samples = dapple.sample_classes(surface, [300, 100])
    ranks = dapple.progressive_ranks(samples.positions, samples.classes)
    for count in (200, 100, 40):
        own = np.bincount(samples.classes[ranks < count], minlength=2)
        np.testing.assert_allclose(own, [0.75 * count, 0.25 * count], atol=1)


@pytest.mark.parametrize(
    ("points", "classes", "match"),
    [
        ([[0, 0, np.nan]], None, r"points\[0\].*nan"),
        (np.zeros((2, 2)), None, r"points.*\(2, 2\)"),
        (np.zeros((2, 3)), [0, -1], r"classes\[1\].*-1"),
        (np.zeros((2, 3)), [0], "classes.*1.*2"),
    ],
)
def test_refuses_bad_arguments(points, classes, match):
    with pytest.raises(ValueError, match=match):
        dapple.progressive_ranks(points, classes)


def test_away_from_neighbors():
    points = np.random.default_rng(2).random((200, 3))
    apart = points[:, None] - points
    far = np.linalg.norm(apart, axis=2) + np.diag(np.full(200, np.inf))
    reach = 3.0 * far.min(axis=1)[:, None]
    nearest = far.argsort(axis=1).argsort(axis=1) < 24
    weights = np.where(nearest & (far < reach), (1.0 - np.minimum(far / reach, 1.0)) ** 2, 0.0)
    np.fill_diagonal(far, 1.0)
    sums = np.einsum("nm,nmd->nd", weights / far, apart)
    expected = sums / np.maximum(weights.sum(axis=1), 1.0)[:, None]
    np.testing.assert_allclose(dapple.away_from_neighbors(points), expected, atol=1e-12)
    with pytest.raises(ValueError, match=r"points\[0\].*inf"):
        dapple.away_from_neighbors([[0, np.inf, 0]])


def test_nearest_distances():
    points = np.random.default_rng(2).random((200, 3))
    apart = np.linalg.norm(points[:, None] - points, axis=2) + np.diag(np.full(200, np.inf))
    np.testing.assert_allclose(dapple.nearest_distances(points), apart.min(axis=1))
    assert np.isinf(dapple.nearest_distances(points[:1])).all()
    with pytest.raises(ValueError, match=r"points\[0\].*inf"):
        dapple.nearest_distances([[0, np.inf, 0]])
