# SPDX-License-Identifier: GPL-3.0-or-later
"""What happens where there is no memory left, and where no thread can be started."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("resource", reason="Windows limits no process this way")

PRELUDE = """
import hashlib, os, resource, sys
import dapple3d as dapple
import numpy as np
from shapes import bent, torus

mesh = torus()
surface = dapple.Surface(*mesh)

def digest(samples):
    return hashlib.sha256(samples.positions.tobytes() + samples.faces.tobytes()).hexdigest()

def small(threads=1):
    return digest(dapple.sample(surface, 300, max_evaluations=5, threads=threads))
"""


def run(script: str) -> str:
    """The output of a process of its own, whose limits are nobody else's."""
    environment = os.environ | {
        "PYTHONPATH": str(Path(__file__).parent),
        "OPENBLAS_NUM_THREADS": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    call = [sys.executable, "-c", PRELUDE + script]
    found = subprocess.run(
        call, env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert found.returncode == 0, f"status {found.returncode}:\n{found.stdout}{found.stderr}"
    return found.stdout


HUGE = {
    "sample": "dapple.sample(surface, 3_000_000)",
    "sample_classes": "dapple.sample_classes(surface, [2_000_000, 2_000_000])",
    "sample, in a plane": "dapple.sample(dapple.Torus(), 3_000_000)",
    "resample": "dapple.resample(surface, samples, 3_000_000)",
    "relax": "dapple.relax(surface, samples, np.arange(len(mesh[1])), count=3_000_000)",
    "refine_edges": "dapple.refine_edges(surface, 0.001, max_faces=100_000_000)",
    "texels": "dapple.texels(surface, uv, 6000, 6000)",
    "spectrum": "dapple.spectrum(flat, half_width=4000)",
    "surface_spectrum": "dapple.surface_spectrum(surface, samples, bins=4096)",
    "stipple": "dapple.stipple(np.zeros((200, 200), np.uint8), 3_000_000)",
    "project": "dapple.project(surface, many)",
}

BEYOND = """
samples = dapple.sample(surface, 300, max_evaluations=5)
flat = samples.barycentric[:, :2].copy()
uv = np.zeros((len(mesh[1]), 3, 2)); uv[:, 1, 0] = uv[:, 2, 1] = 1
many = np.random.default_rng(1).random((500_000, 3))
usual = small()
small(0)  # glibc ends the process if a thread starts without memory for thread-local variables
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + (100 << 20)
before = resource.getrlimit(resource.RLIMIT_AS)
resource.setrlimit(resource.RLIMIT_AS, (limit, before[1]))
try:
    {call}
except MemoryError:
    print("MemoryError")
resource.setrlimit(resource.RLIMIT_AS, before)
assert small() == usual
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere nothing limits memory")
@pytest.mark.parametrize("verb", HUGE)
def test_no_memory_is_a_memory_error(verb):
    assert run(BEYOND.format(call=HUGE[verb])) == "MemoryError\n"


ALONE = """
samples = dapple.sample(surface, 200, max_evaluations=3, threads=1)

def tracked(threads):
    return digest(dapple.Tracker(surface, samples, threads=threads).advance(bent(mesh[0], 0.4)))

usual = small(), tracked(1)
import threading
root = os.geteuid() == 0  # no limit applies to root
resource.setrlimit(resource.RLIMIT_NPROC, (0, 0))
if root:
    nobody = 65534
    os.setgroups([])
    os.setgid(nobody)
    os.setuid(nobody)
try:
    threading.Thread(target=int).start()
    print("threads start in spite of the limit")
except RuntimeError:
    for threads in (2, 4, 0):
        assert (small(threads), tracked(threads)) == usual
    print("as usual")
"""


def test_the_result_is_the_same_where_no_thread_can_be_started():
    found = run(ALONE)
    if "in spite of" in found:
        pytest.skip("this system limits no threads")
    assert found == "as usual\n"
