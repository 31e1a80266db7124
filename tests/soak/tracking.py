# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples kept in place on a body that never rests: a torus with waves that run around it."""

import time
from collections.abc import Iterator

import numpy as np
from dapple3d import Surface, Tracker, sample

from benchmarks.progress.cases import torus

SAMPLES = 2_000


def steps(seconds: float) -> Iterator[None]:
    """A frame in each step."""
    vertices, faces = torus(100, 50)
    surface = Surface(vertices, faces)
    samples = sample(surface, SAMPLES, seed=0)
    tracker = Tracker(surface, samples)
    end, frame = time.monotonic() + seconds, 0
    while time.monotonic() < end:
        frame += 1
        bent = vertices.copy()
        bent[:, 2] += 0.1 * np.sin(3.0 * vertices[:, 0] + 0.05 * frame)
        now = tracker.advance(bent)
        assert len(now) == SAMPLES
        assert np.array_equal(now.ids, samples.ids)
        yield
