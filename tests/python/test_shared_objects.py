# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that several threads use, arrays that others write to, what Python frees meanwhile."""

import gc
import subprocess
import sys
import textwrap
import threading
import time

import dapple3d as dapple
import numpy as np
import pytest
from checks import same_bytes
from shapes import bent, torus

LONG = {"tolerance": 0.0, "max_evaluations": 2000}  # minutes, unless cancelled
KINDS = ["Tracker", "Population", "WindowTracker"]


@pytest.fixture(scope="module")
def large():
    surface = dapple.Surface(*torus(160, 80))
    return surface, dapple.sample(surface, 3000, max_evaluations=3)


def moving(kind, large):
    """An object of the kind, its long call with a context, and what else can be asked of it."""
    surface, samples = large
    moved = bent(surface.vertices, 1.0) * [1, 3, 0.2]
    made = getattr(dapple, kind)(surface, samples, **LONG)
    if kind == "WindowTracker":
        return (
            made,
            lambda context: made.advance([moved] * 3, 1, context=context),
            lambda: made.resume(surface.vertices, samples, []),
            ["surface", "samples", "ahead"],
        )
    again = {
        "Tracker": lambda: made.resume(surface.vertices, samples),
        "Population": lambda: made.resume(surface, samples, made.state),
    }[kind]
    names = ["surface", "samples", "settled" if kind == "Tracker" else "state"]
    return made, lambda context: made.advance(moved, context=context), again, names


@pytest.mark.parametrize("kind", KINDS)
def test_a_call_on_what_another_thread_is_changing_is_refused(kind, large):
    made, advance, resume, names = moving(kind, large)
    context, ended = dapple.Context(), []

    def work():
        with pytest.raises(dapple.Cancelled):
            advance(context)
        ended.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    while context.progress == 0.0 and thread.is_alive():
        time.sleep(0.001)
    for name in names:
        with pytest.raises(RuntimeError, match=rf"the {kind} is in use by another thread"):
            getattr(made, name)
    with pytest.raises(RuntimeError, match="in use by another thread"):
        advance(None)
    with pytest.raises(RuntimeError, match="in use by another thread"):
        resume()
    context.cancel()
    thread.join()
    assert ended
    assert same_bytes(made.samples, large[1])
    resume()


@pytest.mark.parametrize("kind", KINDS)
def test_a_tracker_that_failed_is_not_in_use(kind, large):
    made, _, _, names = moving(kind, large)
    frames = [np.zeros((3, 3))]
    with pytest.raises(ValueError, match="vertices"):
        made.advance(frames, 1) if kind == "WindowTracker" else made.advance(frames[0])
    for name in names:
        getattr(made, name)


def test_frames_that_use_the_tracker_as_they_are_read(mesh, surface, samples):
    """They are read before the call begins to change it."""
    tracker = dapple.WindowTracker(surface, samples, max_evaluations=2)

    def frames():
        for angle in (0.1, 0.2):
            assert same_bytes(tracker.samples, samples)
            yield bent(mesh[0], angle)

    assert len(tracker.advance(frames(), 1)) == 2


def written_meanwhile(array, call, good, bad):
    """Call while another thread writes good and bad values into an array, again and again."""
    stop = threading.Event()

    def write():
        while not stop.is_set():
            array[...] = bad
            array[...] = good

    thread = threading.Thread(target=write)
    thread.start()
    try:
        outcomes = set()
        for _ in range(200):
            try:
                call()
                outcomes.add("done")
            except ValueError as error:
                outcomes.add(type(error).__name__)
        return outcomes
    finally:
        stop.set()
        thread.join()


def test_faces_that_another_thread_writes_do_not_crash_a_surface():
    vertices, faces = torus(60, 40)
    written = faces.copy()
    out = np.where(np.arange(faces.size).reshape(faces.shape) % 7 == 0, 2**30, faces)
    found = written_meanwhile(written, lambda: dapple.Surface(vertices, written), faces, out)
    assert found <= {"done", "SurfaceError"}


def test_densities_that_another_thread_writes_are_checked_as_they_are_used():
    vertices, faces = torus(60, 40)
    density = np.ones(len(vertices))

    def call():
        made = dapple.Surface(vertices, faces, density)
        assert np.isfinite(made.capacity)
        assert np.isfinite(made.density).all()

    assert written_meanwhile(density, call, 1.0, np.nan) <= {"done", "SurfaceError"}


def test_changed_faces_that_another_thread_writes_do_not_crash_relax(surface, samples):
    changed = np.arange(10, dtype=np.int32)
    good = changed.copy()
    found = written_meanwhile(
        changed,
        lambda: dapple.relax(surface, samples, changed, max_evaluations=1),
        good,
        np.int32(2**31 - 1),
    )
    assert found <= {"done", "ValueError"}


def test_samples_of_arrays_that_another_thread_writes(surface, samples):
    faces = samples.faces.copy()
    found = written_meanwhile(
        faces,
        lambda: dapple.Samples(surface, faces, samples.barycentric),
        samples.faces,
        np.int32(-5),
    )
    assert found <= {"done", "ValueError"}


class Lazy:
    """A sequence that makes each item as it is asked for it, and keeps none."""

    def __init__(self, count, make):
        self.count, self.make = count, make

    def __len__(self):
        return self.count

    def __getitem__(self, k):
        if k >= self.count:
            raise IndexError(k)
        return self.make()


def test_a_window_resumes_from_samples_that_nobody_keeps(mesh, surface, samples):
    one = dapple.WindowTracker(surface, samples, max_evaluations=3)
    frames = [bent(mesh[0], angle) for angle in (0.1, 0.2, 0.3, 0.4)]
    found = one.advance(frames, 2)
    states = [(f.faces.copy(), f.barycentric.copy()) for f in found[2:]]
    deformed = [surface.deformed(frames[k]) for k in (2, 3)]
    turn = iter(range(1000))

    def make():
        k = next(turn) % 2
        gc.collect()
        return dapple.Samples(deformed[k], *states[k])

    other = dapple.WindowTracker(surface, samples, max_evaluations=3)
    other.resume(frames[1], found[1], Lazy(2, make))
    assert len(other.ahead) == 2
    ahead = [dapple.Samples(deformed[k], *states[k]) for k in (0, 1)]
    kept = dapple.WindowTracker(surface, samples, max_evaluations=3)
    kept.resume(frames[1], found[1], ahead)
    same = zip(kept.advance(frames[2:], 2), other.advance(frames[2:], 2), strict=True)
    assert all(same_bytes(a, b) for a, b in same)


def test_a_window_refuses_what_is_no_samples_by_its_place(surface, samples):
    tracker = dapple.WindowTracker(surface, samples, max_evaluations=3)
    with pytest.raises(TypeError, match=r"ahead\[1\] is 3"):
        tracker.resume(surface.vertices, samples, [samples, 3])


def test_views_outlive_what_they_show(surface, samples):
    views = [samples.positions, samples.report.energies]
    copied = [np.array(view) for view in views]
    made = dapple.Samples(surface, samples.faces, samples.barycentric)
    shown, expected = made.positions, made.positions.copy()
    report = made.report
    del made
    gc.collect()
    np.testing.assert_array_equal(shown, expected)
    assert report.count == len(expected)
    for view, copy in zip(views, copied, strict=True):
        np.testing.assert_array_equal(view, copy)


def bound_classes():
    kinds = vars(dapple._native).values()
    return [k for k in kinds if isinstance(k, type) and not issubclass(k, BaseException)]


@pytest.mark.parametrize("kind", bound_classes(), ids=lambda kind: kind.__name__)
def test_an_object_without_its_constructor_says_so(kind):
    empty = kind.__new__(kind)
    called = 0
    for name in dir(kind):
        if name.startswith("__") and name not in ("__len__", "__getstate__"):
            continue
        if isinstance(getattr(kind, name), property):
            with pytest.raises(TypeError):
                getattr(empty, name)
            called += 1
    if hasattr(kind, "__len__"):
        with pytest.raises(TypeError):
            len(empty)
        called += 1
    assert called or kind.__name__ in ("_Connectivity",)
    if kind is dapple.Surface:
        with pytest.raises(TypeError, match="__init__"):
            dapple.sample(empty, 10)


def test_parts_of_parts_end_at_a_limit():
    context = whole = dapple.Context()
    for _ in range(1000):
        context = context.part(0.0, 1.0)
    with pytest.raises(ValueError, match="1000"):
        context.part(0.0, 1.0)
    context.advance(1.0)
    assert whole.progress == 1.0
    whole.cancel()
    assert context.cancelled
    del context, whole
    gc.collect()


@pytest.mark.parametrize("progress", [float("inf"), float("-inf"), float("nan")])
def test_progress_is_a_finite_number(progress):
    context = dapple.Context()
    with pytest.raises(ValueError, match="progress"):
        context.advance(progress)
    with pytest.raises(ValueError, match="start and end"):
        context.part(progress, 1.0)
    with pytest.raises(ValueError, match="start and end"):
        context.part(0.0, progress)
    assert context.progress == 0.0
    context.advance(7.0)
    assert context.progress == 1.0


@pytest.mark.parametrize(("start", "end"), [(0.6, 0.4), (-0.1, 1.0), (0.0, 1.1)])
def test_a_part_is_a_part(start, end):
    with pytest.raises(ValueError, match="0 <= start <= end <= 1"):
        dapple.Context().part(start, end)


def test_a_program_ends_while_a_daemon_still_works():
    """The call is cancelled, and the thread neither runs Python nor crashes any more."""
    code = """
        import sys, threading, time
        sys.path.insert(0, {path!r})
        import dapple3d as dapple
        from shapes import torus
        surface = dapple.Surface(*torus(160, 80))
        context = dapple.Context()
        def work(context):
            while True:
                try:
                    dapple.sample(surface, 4000, tolerance=0, max_evaluations=9999, context=context)
                except dapple.Cancelled:
                    pass
        for own in (context, None):
            threading.Thread(target=work, args=(own,), daemon=True).start()
        while context.progress == 0:
            time.sleep(0.001)
        sys.exit(7)
    """
    path = __file__.rsplit("/", 1)[0]
    for _ in range(3):
        found = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(code).format(path=path)],
            capture_output=True,
            text=True,
            timeout=60,
        )
        assert (found.returncode, found.stderr) == (7, "")
