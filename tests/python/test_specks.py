# SPDX-License-Identifier: GPL-3.0-or-later
"""Specks beside a body, parts far from each other, and their benchmark."""

from __future__ import annotations

import sys

import dapple3d as dapple
import numpy as np
import pytest

from benchmarks.specks import __main__ as command
from benchmarks.specks.shapes import OCTAHEDRON, TETRAHEDRON, Mesh, around, joined, moved, sphere


def parts_of(samples: dapple.Samples, parts: list[Mesh]) -> list[int]:
    owner = np.repeat(np.arange(len(parts)), [len(faces) for _, faces in parts])
    return list(np.bincount(owner[samples.faces], minlength=len(parts)))


@pytest.mark.parametrize("distance", [3.0, 1e4, 1e8])
def test_a_stray_speck_leaves_the_body_as_even_as_it_was(distance: float) -> None:
    speck = moved(TETRAHEDRON, 0.002, np.array([distance, 0, 0]))
    report = dapple.sample(dapple.Surface(*joined([sphere(4), speck])), 500).report
    alone = dapple.sample(dapple.Surface(*sphere(4)), 500).report
    assert report.converged
    assert report.capacity_variation < 0.01
    assert report.alpha_min > 0.65
    assert report.energy == pytest.approx(alone.energy, rel=0.1)


def test_specks_get_their_share_and_the_others_belong_to_nobody() -> None:
    specks = [moved(OCTAHEDRON, 0.03, place) for place in around(300, np.random.default_rng(0))]
    parts = [sphere(4), *specks]
    surface = dapple.Surface(*joined(parts))
    samples = dapple.sample(surface, 1000)
    shares = [dapple.Surface(*part).capacity / surface.capacity * 1000 for part in parts]
    counts = parts_of(samples, parts)
    assert all(abs(count - share) < 1 for count, share in zip(counts, shares, strict=True))
    assert 0 in counts[1:]
    assert samples.report.converged
    whole = samples.report.whole_count_variation
    assert samples.report.capacity_variation == pytest.approx(whole, abs=0.01)


def test_specks_that_had_no_sample_get_some_where_there_are_more() -> None:
    specks = [moved(sphere(1), 0.05, place * 1.5) for place in around(60, np.random.default_rng(0))]
    parts = [sphere(3), *specks]
    surface = dapple.Surface(*joined(parts))
    few = dapple.sample(surface, 50)
    assert 0 in parts_of(few, parts)
    anew = parts_of(dapple.sample(surface, 3000), parts)
    for more in (
        dapple.resample(surface, few, 3000),
        dapple.relax(surface, few, changed=np.arange(len(surface.faces)), count=3000),
    ):
        counts = parts_of(more, parts)
        assert abs(counts[0] - anew[0]) < 60
        assert all(count >= 2 for count in counts[1:])


def test_bodies_far_from_each_other_are_as_even_as_near_ones() -> None:
    body = sphere(4)
    mesh = joined([body, moved(body, 1, np.array([1e8, 0, 0]))])
    report = dapple.sample(dapple.Surface(*mesh), 1000).report
    assert report.converged
    assert report.capacity_variation < 0.01


def test_all_threads_give_the_same_bytes_among_specks() -> None:
    specks = [moved(TETRAHEDRON, 0.01, place) for place in around(100, np.random.default_rng(0))]
    surface = dapple.Surface(*joined([sphere(4), *specks]))
    one = dapple.sample(surface, 1000, threads=1)
    for threads in (2, 5):
        more = dapple.sample(surface, 1000, threads=threads)
        assert one.positions.tobytes() == more.positions.tobytes()


def test_the_benchmark_judges_each_case(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["specks", "--small"])
    command.main()
    printed = capsys.readouterr().out
    for name in (*command.DISTANCE, *command.NOISE):
        assert f"| {name} |" in printed
