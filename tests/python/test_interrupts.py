# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C in every call: heard soon, and nothing is changed by it."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
from checks import same_bytes
from shapes import bent, torus

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

LONG = {"tolerance": 0.0, "max_evaluations": 5000}
SOON = 0.5  # seconds of processor time of all threads


@pytest.fixture(autouse=True)
def _ctrl_c_raises():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def delay_of(call, after=0.15):
    """Seconds of work from Ctrl-C, so long after the call began, to its end; None: it was done.

    Those of the processor: whatever else the machine does is not counted.
    """
    sent = []

    def send():
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, send)
    timer.start()
    try:
        call()
    except KeyboardInterrupt:
        return time.process_time() - sent[0]
    finally:
        timer.cancel()
        timer.join()
    return None


class Bodies:
    """What the calls work on, made once."""

    def __init__(self, folder):
        self.vertices, self.faces = torus(400, 200)
        self.surface = dapple.Surface(self.vertices, self.faces)
        self.samples = dapple.sample(self.surface, 20_000, max_evaluations=2)
        self.few = dapple.sample(self.surface, 3000, max_evaluations=2)
        self.moved = bent(self.vertices, 1.0) * [1, 3, 0.2]
        self.points = np.random.default_rng(0).random((400_000, 3))
        self.uv = np.random.default_rng(1).random((len(self.faces), 3, 2))
        self.image = np.random.default_rng(2).random((1024, 1024))
        self.fine = np.repeat(np.repeat(self.image, 2, 0), 2, 1)
        self.folder = folder
        dapple.write_mesh(folder / "in.obj", self.vertices, self.faces)
        made = (self.surface, self.few)
        self.tracker = dapple.Tracker(*made, **LONG)
        self.population = dapple.Population(*made, **LONG)
        self.window = dapple.WindowTracker(*made, **LONG)


@pytest.fixture(scope="module")
def bodies(tmp_path_factory):
    return Bodies(tmp_path_factory.mktemp("bodies"))


def many(call, times=50):
    """Calls that are short by themselves."""
    for _ in range(times):
        call()


CALLS = {
    "Surface": lambda b: many(lambda: dapple.Surface(b.vertices, b.faces)),
    "deformed": lambda b: many(lambda: b.surface.deformed(b.moved), 300),
    "with_density": lambda b: many(lambda: b.surface.with_density(b.vertices[:, 0] + 9), 300),
    "corner_normals": lambda b: many(lambda: b.surface.corner_normals),
    "topology": lambda b: many(lambda: b.surface.topology),
    "Samples": lambda b: dapple.Samples(
        b.surface, np.tile(b.samples.faces, 100), np.tile(b.samples.barycentric, (100, 1))
    ),
    "sample": lambda b: dapple.sample(b.surface, 20_000, **LONG),
    "sample PAPER": lambda b: dapple.sample(b.surface, 20_000, **dapple.PAPER | LONG),
    "sample_classes": lambda b: dapple.sample_classes(
        b.surface, [2000, dapple.SampleClass(8000, radius=0.001)], **LONG
    ),
    "resample": lambda b: dapple.resample(b.surface, b.samples, 25_000, **LONG),
    "relax": lambda b: dapple.relax(
        b.surface, b.samples, np.arange(len(b.faces) // 2), count=21_000, **LONG
    ),
    "sample, in a plane": lambda b: dapple.sample(dapple.Torus(), 30_000, **LONG),
    "sample_classes, in a plane": lambda b: dapple.sample_classes(
        dapple.Plane(1, 1), [3000, 9000], **LONG
    ),
    "evaluate_energy, in a plane": lambda b: dapple.evaluate_energy(
        dapple.Plane(1, 1), b.points[:, :2]
    ),
    "Plane": lambda b: many(lambda: dapple.Plane(1, 1, b.fine)),
    "Torus": lambda b: many(lambda: dapple.Torus(b.fine)),
    "analyze": lambda b: many(lambda: dapple.analyze(b.surface, b.samples)),
    "evaluate_energy": lambda b: many(
        lambda: dapple.evaluate_energy(b.surface, b.samples.positions, b.samples.faces)
    ),
    "Tracker": lambda b: b.tracker.advance(b.moved),
    "Population": lambda b: b.population.advance(b.moved),
    "WindowTracker": lambda b: b.window.advance([b.moved] * 5, 5),
    "track_window": lambda b: dapple.track_window(b.surface, b.few, [b.moved] * 5, **LONG),
    "track_pieces": lambda b: list(dapple.track_pieces(b.surface, b.few, [b.moved] * 5, **LONG)),
    "project": lambda b: many(lambda: dapple.project(b.surface, b.points)),
    "away_from_neighbors": lambda b: many(lambda: dapple.away_from_neighbors(b.points)),
    "nearest_distances": lambda b: many(lambda: dapple.nearest_distances(b.points)),
    "progressive_ranks": lambda b: many(lambda: dapple.progressive_ranks(b.points)),
    "spectrum": lambda b: dapple.spectrum(b.points[:, :2], half_width=800),
    "surface_spectrum": lambda b: dapple.surface_spectrum(b.surface, [b.samples] * 50),
    "curvedness": lambda b: many(lambda: dapple.curvedness(b.surface, smoothing=100)),
    "refine_edges": lambda b: dapple.refine_edges(b.surface, 0.002, max_faces=100_000_000),
    "refine_image": lambda b: dapple.refine_image(b.surface, b.uv, b.image, max_faces=20_000_000),
    "refine_obstacles": lambda b: many(
        lambda: dapple.refine_obstacles(
            b.surface, b.samples.positions, 0.004, edge=0.05, max_faces=20_000_000
        )
    ),
    "refine_outside": lambda b: dapple.refine_outside(b.surface, 0.003, max_faces=20_000_000),
    "seen_from": lambda b: many(
        lambda: dapple.seen_from(b.surface, [9.0, 0.0, 0.0, 1.0], b.points)
    ),
    "exposure": lambda b: many(lambda: dapple.exposure(b.surface)),
    "reached_by_solids": lambda b: many(
        lambda: dapple.reached_by_solids(
            b.vertices, b.faces, b.vertices, [4] * (len(b.vertices) // 4)
        )
    ),
    "touching_solids": lambda b: many(
        lambda: dapple.touching_solids(b.vertices, [4] * (len(b.vertices) // 4))
    ),
    "remesh": lambda b: dapple.remesh(b.surface, 20_000, max_evaluations=1000, tolerance=0),
    "mosaic": lambda b: many(lambda: dapple.mosaic(b.surface, b.samples, grout=0.001)),
    "texels": lambda b: many(lambda: dapple.texels(b.surface, b.uv, 4096, 4096)),
    "stipple_inks": lambda b: dapple.stipple_inks(b.image[None], 50_000, **LONG),
    "separate_inks": lambda b: many(lambda: dapple.separate_inks(np.stack([b.image] * 3))),
    "write_mesh": lambda b: many(
        lambda: dapple.write_mesh(b.folder / "out.obj", b.vertices, b.faces)
    ),
    "read_mesh": lambda b: many(lambda: dapple.read_mesh(b.folder / "in.obj")),
}


@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_is_heard_soon(name, bodies):
    seconds = delay_of(lambda: CALLS[name](bodies))
    print(f"{name}: {seconds}")
    assert seconds is not None, "it was done before Ctrl-C"
    assert seconds < SOON
    assert [f for f in os.listdir(bodies.folder) if f.endswith(".part")] == []


def test_what_ctrl_c_interrupts_is_left_as_it_was(bodies):
    surface = bodies.surface
    samples = dapple.sample(surface, 500, max_evaluations=2)
    small = {"max_evaluations": 3}
    for kind in (dapple.Tracker, dapple.Population):
        made, other = kind(surface, samples, **small), kind(surface, samples, **small)
        slow = kind(surface, samples, **LONG)
        assert delay_of(lambda slow=slow: slow.advance(bodies.moved), 0.05) is not None
        assert same_bytes(slow.samples, samples)
        assert slow.surface.vertices.tobytes() == surface.vertices.tobytes()
        assert same_bytes(made.advance(bodies.moved), other.advance(bodies.moved))
    context = dapple.Context()
    assert delay_of(lambda: dapple.sample(surface, 20_000, context=context, **LONG)) is not None
    assert not context.cancelled, "a Context serves whoever comes next"


def test_a_handler_that_does_not_raise_does_not_stop_the_work(bodies):
    heard = []
    signal.signal(signal.SIGINT, lambda *_: heard.append(time.process_time()))
    expected = dapple.sample(bodies.surface, 9000, max_evaluations=15)
    sent = []

    def send():
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.1, send)
    timer.start()
    found = dapple.sample(bodies.surface, 9000, max_evaluations=15)
    timer.join()
    assert len(heard) == 1
    assert heard[0] - sent[0] < SOON
    assert same_bytes(found, expected)


def test_a_handler_may_call_what_it_interrupted(bodies):
    """It is refused what the interrupted call is changing, and gets the rest."""
    seen = []

    def handler(*_):
        try:
            bodies.tracker.samples  # noqa: B018
        except RuntimeError as error:
            seen.append(str(error))
        seen.append(len(dapple.sample(bodies.surface, 50, max_evaluations=1)))
        raise ValueError("enough")

    signal.signal(signal.SIGINT, handler)
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(ValueError, match="enough"):
        bodies.tracker.advance(bodies.moved)
    assert seen == ["the Tracker is in use by a call of this thread that has not ended", 50]
    assert len(bodies.tracker.samples) == len(bodies.few)


def test_a_handler_may_sample_the_polygon_that_is_being_cut():
    """A polygon is cut for its samples when it is first used."""
    outline = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
    expected = dapple.sample(dapple.Plane.polygon(outline), 40, max_evaluations=1)
    heard = []
    for k in range(8):
        plane = dapple.Plane.polygon(outline)

        def handler(*_, plane=plane):
            heard.append(dapple.sample(plane, 40, max_evaluations=1))

        signal.signal(signal.SIGINT, handler)
        threading.Timer(0.03 * k, os.kill, (os.getpid(), signal.SIGINT)).start()
        found = dapple.sample(plane, 30_000, max_evaluations=2)
        assert len(found) == 30_000
        deadline = time.monotonic() + 10
        while len(heard) <= k and time.monotonic() < deadline:
            time.sleep(0.01)
    assert len(heard) == 8
    assert all(one.positions.tobytes() == expected.positions.tobytes() for one in heard)


def test_other_threads_do_not_hear_ctrl_c(bodies):
    """As Python has it: the main thread alone does."""
    found = []

    def work():
        found.append(dapple.sample(bodies.surface, 9000, max_evaluations=10))

    thread = threading.Thread(target=work)
    thread.start()
    time.sleep(0.05)
    threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        time.sleep(5)
    thread.join()
    assert len(found[0]) == 9000


def hear_ctrl_c():
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


SCRIPT = Path(sys.executable).with_name("dapple")


@pytest.mark.skipif(not SCRIPT.is_file(), reason="the package is not installed beside its Python")
def test_the_command_ends_in_a_sentence_whenever_ctrl_c_comes(tmp_path):
    mesh, out = tmp_path / "in.ply", tmp_path / "out.ply"
    dapple.write_mesh(mesh, *torus(60, 30))
    long = ["--tolerance", "0", "--max-evaluations", "100000"]
    for k in range(25):
        process = subprocess.Popen(
            [SCRIPT, "sample", mesh, out, "-n", "5000", "-q", *long],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=hear_ctrl_c,
        )
        time.sleep(0.04 * k)
        process.send_signal(signal.SIGINT)
        shown, said = process.communicate(timeout=60)
        assert "Traceback" not in said, f"after {0.04 * k:.2f} s: {said}"
        assert shown == ""
        # the interrupt came while the shell was starting Python
        if process.returncode != -signal.SIGINT:
            assert (process.returncode, said) == (130, "Cancelled: nothing was written.\n")
        assert not out.exists()


class InterruptedPath:
    """A path during one of whose readings Ctrl-C comes."""

    def __init__(self, path, reading):
        self.path, self.left = path, reading

    def __fspath__(self):
        self.left -= 1
        if not self.left:
            raise KeyboardInterrupt
        return str(self.path)


@pytest.mark.parametrize(
    ("call", "reading"),
    [
        (dapple.read_mesh, 2),
        (dapple._native._read_vertex_columns, 1),
        (lambda path: dapple.write_mesh(path, *torus(60, 30)), 1),
    ],
)
def test_an_interrupt_while_a_path_is_read_stays_one(tmp_path, call, reading):
    path = tmp_path / "in.ply"
    dapple.write_mesh(path, *torus(60, 30))
    before = path.read_bytes()
    with pytest.raises(KeyboardInterrupt):
        call(InterruptedPath(path, reading))
    assert path.read_bytes() == before


class BrokenPath:
    def __fspath__(self):
        raise RuntimeError("no such drive")


def test_what_a_path_raises_is_raised(tmp_path):
    with pytest.raises(RuntimeError, match="no such drive"):
        dapple.write_mesh(BrokenPath(), *torus(60, 30))
    with pytest.raises(TypeError, match=r"expected str, bytes or .*, not int"):
        dapple.write_mesh(3, *torus(60, 30))
    with pytest.raises(ValueError, match="null byte"):
        dapple.write_mesh("a\0.ply", *torus(60, 30))
    dapple.write_mesh(bytes(tmp_path / "as_bytes.off"), *torus(60, 30))
    assert (tmp_path / "as_bytes.off").exists()
