# SPDX-License-Identifier: GPL-3.0-or-later
"""The legend of colors, as it is drawn."""

import addon_host
import drawn
import numpy as np
import pytest

WIDTH, HEIGHT = 260, 80


@pytest.fixture
def legend():
    return addon_host.part("blender.density.legend")


def picture(legend, *words):
    return drawn.picture(
        lambda: legend.draw(*words, 1.0), (0.0, 0.0), (WIDTH, HEIGHT), (WIDTH, HEIGHT)
    )


def of_the_ramp(found, legend):
    """Rows and columns of pixels that it covers, at its lower left, above the words of its ends."""
    left, bottom = legend.EDGE, legend.EDGE + legend.LETTER + legend.GAP
    rows = slice(int(bottom) + 1, int(bottom + legend.HEIGHT) - 1)
    return found[rows, int(left) : int(left + legend.WIDTH)]


def test_the_ramp_goes_from_the_color_of_nothing_to_that_of_the_most(legend):
    strip = of_the_ramp(picture(legend, "", "", ""), legend)
    places, colors = addon_host.part("core.density.colors").ramp()
    along = (np.arange(strip.shape[1]) + 0.5) / strip.shape[1]
    wanted = np.column_stack([np.interp(along, places, colors[:, k]) for k in range(4)])
    np.testing.assert_allclose(strip, np.broadcast_to(wanted, strip.shape), atol=0.02)


def test_words_stand_at_its_ends_and_above(legend):
    def rows_and_columns(*words):
        lit = picture(legend, *words)[..., :3].min(axis=2) > 0.5
        return np.nonzero(lit)

    title, low, high = (
        rows_and_columns(*words) for words in (("X", "", ""), ("", "X", ""), ("", "", "X"))
    )
    left, right = legend.EDGE, legend.EDGE + legend.WIDTH
    above = legend.EDGE + legend.LETTER + legend.GAP + legend.HEIGHT
    assert left - 2 <= title[1].min()
    assert title[0].min() >= above
    assert left - 2 <= low[1].min()
    assert low[1].max() < left + 20
    assert low[0].max() < above
    assert right - 20 < high[1].min()
    assert high[1].max() <= right + 2
    assert high[0].max() < above


def test_a_legend_of_words_wider_than_the_ramp_begins_at_its_left(legend):
    lit = picture(legend, "", "", "X" * 60)[..., :3].min(axis=2) > 0.5
    assert legend.EDGE - 2 <= np.nonzero(lit)[1].min() < legend.EDGE + 10
