# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in one thread, Python in another."""

import threading
import time

import dapple3d as dapple
import numpy as np
import pytest
from checks import same_bytes
from shapes import bent, torus

LONG = {"tolerance": 0.0, "max_evaluations": 2000}  # minutes, unless cancelled


@pytest.fixture(scope="module")
def large():
    return dapple.Surface(*torus(160, 80))


def cancel_at(context: dapple.Context, progress: float) -> threading.Thread:
    def watch() -> None:
        while context.progress < progress:
            time.sleep(0.001)
        context.cancel()

    thread = threading.Thread(target=watch)
    thread.start()
    return thread


@pytest.mark.parametrize("progress", [0.0, 0.002, 0.01, 0.03])
def test_is_cancelled_while_it_samples(large, progress):
    context = dapple.Context()
    watcher = cancel_at(context, progress)
    with pytest.raises(dapple.Cancelled):
        dapple.sample(large, 4000, context=context, **LONG)
    watcher.join()
    assert context.cancelled
    assert progress <= context.progress < 1


def test_is_cancelled_before_it_begins(large, mesh, surface, samples):
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.sample(large, 10, context=context)
    tracker = dapple.Tracker(surface, samples)
    with pytest.raises(dapple.Cancelled):
        tracker.advance(bent(mesh[0], 1.0), context=context)
    assert same_bytes(tracker.samples, samples)
    np.testing.assert_array_equal(tracker.surface.vertices, mesh[0])


def test_a_cancelled_frame_leaves_the_tracker_as_it_was(large):
    samples = dapple.sample(large, 2000, max_evaluations=30)
    options = {"tolerance": 0.0, "max_evaluations": 2000, "capacity_weight": 5.0}
    tracker = dapple.Tracker(large, samples, **options)
    context = dapple.Context()
    watcher = cancel_at(context, 1e-4)
    moved = large.vertices * [1, 3, 0.2]  # too far to settle within two evaluations
    with pytest.raises(dapple.Cancelled):
        tracker.advance(moved, context=context)
    watcher.join()
    assert same_bytes(tracker.samples, samples)
    np.testing.assert_array_equal(tracker.surface.vertices, large.vertices)


def test_lets_other_threads_run(large):
    """With the lock held, the loop below could not run before the work has ended."""
    context = dapple.Context()
    outcome = []

    def work() -> None:
        try:
            dapple.sample(large, 4000, context=context, **LONG)
        except dapple.Cancelled:
            outcome.append("cancelled")

    thread = threading.Thread(target=work)
    thread.start()
    turns, seen = 0, [context.progress]
    while thread.is_alive() and context.progress < 0.02:
        turns += 1
        seen.append(context.progress)
        time.sleep(0.001)
    context.cancel()
    thread.join()
    assert outcome == ["cancelled"]
    assert turns > 10
    assert seen == sorted(seen)


def test_runs_twice_at_once(large):
    """Two samplings at the same time do not disturb each other."""
    expected = [dapple.sample(large, 500, seed=seed, max_evaluations=5) for seed in (1, 2)]
    found = [None, None]

    def work(k: int) -> None:
        found[k] = dapple.sample(large, 500, seed=k + 1, max_evaluations=5)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(same_bytes(a, b) for a, b in zip(found, expected, strict=True))


def test_ends_with_full_progress(surface):
    context = dapple.Context()
    assert (context.progress, context.cancelled) == (0.0, False)
    dapple.sample(surface, 100, context=context)
    assert context.progress == 1.0
