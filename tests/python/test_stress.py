# SPDX-License-Identifier: GPL-3.0-or-later
"""Eight threads use the same objects at once, in every way there is, and write to arrays.

The library alone does so under ThreadSanitizer too: tests/native/test_stress.cpp.
"""

import copy
import pickle
import threading
import time
from contextlib import suppress

import dapple3d as dapple
import numpy as np
from checks import same_bytes
from shapes import bent, torus

SECONDS = 4.0
THREADS = 8
FEW = {"max_evaluations": 2}


class Shared:
    def __init__(self):
        self.vertices, self.faces = torus()
        self.surface = dapple.Surface(self.vertices, self.faces)
        self.samples = dapple.sample(self.surface, 100, **FEW)
        self.frames = [bent(self.vertices, 0.1 * k) for k in range(5)]
        made = (self.surface, self.samples)
        self.tracker = dapple.Tracker(*made, **FEW)
        self.population = dapple.Population(*made, **FEW)
        self.window = dapple.WindowTracker(*made, **FEW)
        self.context = dapple.Context()
        self.plane = dapple.Plane.polygon([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)])
        self.uv = np.random.default_rng(0).random((len(self.faces), 3, 2))
        self.written = self.vertices.copy()
        self.indices = self.faces.copy()


def write(s, rng):
    s.written[rng.integers(len(s.written))] = rng.choice([np.nan, 0.5, 1e300])
    s.indices[rng.integers(len(s.indices))] = rng.choice([-1, 3, 2**30])
    s.written[...] = s.vertices
    s.indices[...] = s.faces


def cancelled(s, _rng):
    context = s.context.part(0.0, 0.5)
    threading.Timer(0.002, context.cancel).start()
    s.context = dapple.Context()
    return dapple.sample(s.surface, 150, context=context, max_evaluations=50)


ALONE = {  # calls that return the same bytes whatever other threads do
    "sample": lambda s: dapple.sample(s.surface, 90, **FEW),
    "classes": lambda s: dapple.sample_classes(s.surface, [30, 40], **FEW),
    "resample": lambda s: dapple.resample(s.surface, s.samples, 110, **FEW),
    "relax": lambda s: dapple.relax(s.surface, s.samples, np.arange(300), **FEW),
    "pickle": lambda s: pickle.loads(pickle.dumps(s.samples)),
    "copy": lambda s: dapple.sample(copy.deepcopy(s.surface), 40, **FEW),
    "deformed": lambda s: dapple.sample(s.surface.deformed(s.frames[2]), 40, **FEW),
}
TOGETHER = [  # calls that may be rejected but never crash
    write,
    cancelled,
    lambda s, rng: s.tracker.advance(s.frames[rng.integers(5)]),
    lambda s, rng: s.tracker.resume(s.vertices, s.samples),
    lambda s, rng: (s.tracker.samples, s.tracker.surface, s.tracker.settled),
    lambda s, rng: s.population.advance(s.frames[rng.integers(5)]),
    lambda s, rng: s.population.advance(s.written, s.indices),
    lambda s, rng: s.population.resume(s.surface, s.samples, s.population.state),
    lambda s, rng: (s.population.samples, s.population.state),
    lambda s, rng: s.window.advance(s.frames[:3], 3),
    lambda s, rng: s.window.resume(s.vertices, s.samples, []),
    lambda s, rng: (s.window.samples, s.window.ahead),
    lambda s, rng: dapple.Surface(s.written, s.indices),
    lambda s, rng: s.surface.with_density(np.abs(s.written[:, 0])),
    lambda s, rng: dapple.Samples(s.surface, s.indices[:60, 0], s.samples.barycentric[:60]),
    lambda s, rng: dapple.project(s.surface, s.written),
    lambda s, rng: dapple.analyze(s.surface, s.written[:50]),
    lambda s, rng: dapple.mosaic(s.surface, s.samples, grout=0.01),
    lambda s, rng: dapple.remesh(s.surface, 90, max_evaluations=3),
    lambda s, rng: dapple.sample(dapple.Torus(), 30, **FEW),
    lambda s, rng: dapple.sample(s.plane, int(rng.integers(1, 300)), **FEW),
    lambda s, rng: dapple.evaluate_energy(s.plane, np.abs(s.written[:9, :2])),
    lambda s, rng: dapple.texels(s.surface, s.uv, 16, 16),
    lambda s, rng: dapple.surface_spectrum(s.surface, [s.samples], radius=3.0, bins=16),
    lambda s, rng: dapple.refine_outside(s.surface, 0.2, max_faces=4000),
    lambda s, rng: dapple.exposure(s.surface),
    lambda s, rng: dapple.refine_edges(s.surface, 0.4, max_faces=4000),
    lambda s, rng: dapple.curvedness(s.surface),
    lambda s, rng: (s.surface.topology, s.surface.corner_normals),
    lambda s, rng: dapple.progressive_ranks(s.written),
    lambda s, rng: pickle.dumps(s.tracker),
]
REFUSALS = (ValueError, RuntimeError, TypeError)  # Cancelled and SurfaceError are among them


def work(shared, seed, end, expected, found):
    rng = np.random.default_rng(seed)
    while time.monotonic() < end:
        if rng.random() < 0.4:
            name = rng.choice(list(ALONE))
            if not same_bytes(ALONE[name](shared), expected[name]):
                found.append(f"{name}: different bytes")
        else:
            with suppress(*REFUSALS):
                rng.choice(TOGETHER)(shared, rng)


def test_eight_threads_do_everything_at_once():
    shared, found = Shared(), []
    expected = {name: call(shared) for name, call in ALONE.items()}
    end = time.monotonic() + SECONDS

    def run(seed):
        try:
            work(shared, seed, end, expected, found)
        except BaseException as error:
            found.append(repr(error))
            raise

    threads = [threading.Thread(target=run, args=(seed,)) for seed in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == []
    shared.tracker.resume(shared.vertices, shared.samples)
    assert same_bytes(shared.tracker.samples, shared.samples)
