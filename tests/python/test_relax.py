# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples made even again where something has changed."""

import dapple3d as dapple
import numpy as np
import pytest
from checks import check_samples
from shapes import torus


@pytest.fixture(scope="module")
def surface() -> dapple.Surface:
    return dapple.Surface(*torus(96, 48))


@pytest.fixture(scope="module")
def before(surface: dapple.Surface) -> dapple.Samples:
    return dapple.sample(surface, 1000)


def with_spot(surface: dapple.Surface, middle: np.ndarray, inside: float) -> dapple.Surface:
    near = np.linalg.norm(surface.vertices - middle, axis=1) < 0.3
    return surface.with_density(np.where(near, inside, 1.0))


@pytest.mark.parametrize("inside", [0.0, 0.5, 3.0])
def test_a_changed_density_is_followed_and_far_samples_stay(surface, before, inside) -> None:
    middle = before.positions[0]
    after = with_spot(surface, middle, inside)
    changed = dapple.changed_faces(surface, after)
    assert changed.dtype == np.int32
    assert 0 < len(changed) < len(surface.faces) / 10
    relaxed = dapple.relax(after, before, changed)
    check_samples(after, relaxed)
    assert len(relaxed) == pytest.approx(1000 * after.capacity / surface.capacity, abs=2)
    assert relaxed.report.count == len(relaxed)
    kept = np.flatnonzero(np.isin(relaxed.ids, before.ids))
    origin = np.searchsorted(before.ids, relaxed.ids[kept])
    away = np.linalg.norm(before.positions[origin] - middle, axis=1)
    far = away > 0.3 + 3.5 * relaxed.report.spacing
    same = (relaxed.positions[kept] == before.positions[origin]).all(axis=1)
    assert far.sum() > 500
    assert same[far].mean() >= 0.99
    assert dapple.analyze(after, relaxed).capacity_variation < 0.01


def test_nothing_changed_moves_nothing(surface, before) -> None:
    relaxed = dapple.relax(surface, before, dapple.changed_faces(surface, surface))
    assert np.array_equal(relaxed.positions, before.positions)
    assert np.array_equal(relaxed.ids, before.ids)


def test_the_count_and_what_is_locked(surface, before) -> None:
    middle = before.positions[0]
    changed = dapple.changed_faces(surface, with_spot(surface, middle, 2.0))
    locked = np.arange(0, 1000, 3)
    relaxed = dapple.relax(surface, before, changed, count=1010, locked=locked)
    assert len(relaxed) == 1010
    there = np.searchsorted(relaxed.ids[: len(before)], before.ids[locked])
    assert np.array_equal(relaxed.ids[there], before.ids[locked])
    assert np.array_equal(relaxed.positions[there], before.positions[locked])


def test_moved_vertices_carry_their_samples(surface, before) -> None:
    vertices = surface.vertices.copy()
    middle = before.positions[5]
    away = np.linalg.norm(vertices - middle, axis=1)
    vertices[:, 2] += 0.2 * np.clip(1 - away / 0.4, 0, None) ** 2
    after = surface.deformed(vertices)
    relaxed = dapple.relax(after, before, dapple.changed_faces(surface, after))
    check_samples(after, relaxed)
    assert dapple.analyze(after, relaxed).capacity_variation < 0.01


def test_what_is_wrong_is_named(surface, before) -> None:
    with pytest.raises(ValueError, match=r"changed\[0\] is -1"):
        dapple.relax(surface, before, [-1])
    with pytest.raises(ValueError, match=r"locked\[1\] is 1000, outside 0..999"):
        dapple.relax(surface, before, [0], locked=[0, 1000])
    with pytest.raises(ValueError, match="count is 9 and there are 1000 samples, 10 of which stay"):
        dapple.relax(surface, before, [0], count=9, locked=np.arange(10))
    with pytest.raises(TypeError, match="cells"):
        dapple.relax(surface, before, [0], cells="euclidean")
    moved = surface.deformed(surface.vertices * 1.5)
    with pytest.raises(ValueError, match=r"samples.positions\[\d+\]"):
        dapple.relax(moved, before, [0])
    other = dapple.Surface(*torus(96, 48))
    with pytest.raises(ValueError, match="other faces"):
        dapple.changed_faces(surface, other)
