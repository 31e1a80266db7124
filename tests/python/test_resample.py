# SPDX-License-Identifier: GPL-3.0-or-later
"""Another count or density for samples that are there."""

import dapple3d as dapple
import numpy as np
import pytest
from checks import check_samples
from shapes import torus


@pytest.fixture(scope="module")
def surface() -> dapple.Surface:
    return dapple.Surface(*torus())


@pytest.mark.parametrize("count", [0, 198, 200, 202])
def test_most_samples_stay(surface: dapple.Surface, count: int) -> None:
    before = dapple.sample(surface, 200)
    after = dapple.resample(surface, before, count)
    check_samples(surface, after)
    assert len(after) == count
    kept = np.isin(after.ids, before.ids)
    assert kept.sum() == min(count, 200)
    if count:
        slides = np.linalg.norm(after.positions[kept] - before.positions[after.ids[kept]], axis=1)
        median = np.sort(slides)[len(slides) // 2] / after.report.spacing
        assert after.report.slide_median == pytest.approx(median)
        assert median < 0.15


def test_samples_of_another_surface_are_refused(surface: dapple.Surface) -> None:
    before = dapple.sample(surface, 200)
    other = dapple.Surface(np.eye(3), [[0, 1, 2]])
    with pytest.raises(ValueError, match=r"faces\["):
        dapple.resample(other, before, 10)
