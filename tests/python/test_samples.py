# SPDX-License-Identifier: GPL-3.0-or-later
import gc

import dapple3d as dapple
import numpy as np
import pytest
from checks import ARRAYS, check_samples, same_bytes


def test_are_bound_again(surface, samples):
    again = dapple.Samples(
        surface, samples.faces, samples.barycentric, ids=samples.ids, classes=samples.classes
    )
    assert same_bytes(again, samples)


def test_survive_single_precision(surface, samples):
    again = dapple.Samples(surface, samples.faces, samples.barycentric.astype(np.float32))
    check_samples(surface, again)
    np.testing.assert_allclose(again.positions, samples.positions, atol=1e-6)


def test_count_ids_up_from_zero(surface):
    bound = dapple.Samples(surface, [3, 1, 1], np.full((3, 3), 1 / 3))
    np.testing.assert_array_equal(bound.ids, [0, 1, 2])
    np.testing.assert_array_equal(bound.classes, [0, 0, 0])


def test_may_be_none(surface):
    bound = dapple.Samples(surface, np.zeros(0, np.int32), np.zeros((0, 3)))
    check_samples(surface, bound)
    assert len(bound) == 0


@pytest.mark.parametrize("name", ARRAYS)
def test_show_their_memory_without_copies(samples, name):
    assert np.shares_memory(getattr(samples, name), getattr(samples, name))
    with pytest.raises(ValueError, match="read-only"):
        getattr(samples, name)[0] = 0


def test_live_as_long_as_their_arrays(surface):
    positions = dapple.sample(surface, 50).positions
    expected = dapple.sample(surface, 50).positions.copy()
    gc.collect()
    np.testing.assert_array_equal(positions, expected)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"faces": [0, -1, 2]}, r"faces\[1\].*-1"),
        ({"faces": [0, 1, 10**6]}, r"faces\[2\].*1000000"),
        ({"faces": [0, 1, 2**32]}, "faces"),
        ({"faces": [0, 1]}, "barycentric.*3.*2"),
        ({"faces": [0.0, 1.0, 2.0]}, "faces.*integer"),
        ({"barycentric": [[1, 0, 0], [0, np.nan, 1], [0, 0, 1]]}, r"barycentric\[1\].*nan"),
        ({"barycentric": [[1, 0, 0], [0, np.inf, 1], [0, 0, 1]]}, r"barycentric\[1\].*inf"),
        ({"barycentric": [[1, 0, 0], [-0.5, 0.5, 1], [0, 0, 1]]}, r"barycentric\[1\].*-0.5"),
        ({"barycentric": [[1, 0, 0], [1, 0, 0], [0.5, 0, 0.25]]}, r"barycentric\[2\].*0.75"),
        ({"barycentric": np.ones((3, 2))}, r"barycentric.*\(3, 2\)"),
        ({"ids": [1, 2]}, "ids.*2.*3"),
        ({"ids": [1, 2, 1]}, "ids.*1"),
        ({"ids": [1, 2, 2**40]}, "ids"),
        ({"classes": [1, 2]}, "classes.*2.*3"),
    ],
)
def test_refuse(surface, change, match):
    arguments = {
        "faces": [0, 1, 2],
        "barycentric": np.eye(3),
        "ids": None,
        "classes": None,
    } | change
    faces, barycentric = arguments.pop("faces"), arguments.pop("barycentric")
    with pytest.raises(ValueError, match=match):
        dapple.Samples(surface, faces, barycentric, **arguments)
