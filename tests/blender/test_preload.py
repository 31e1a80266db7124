# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender executable exports its own Embree and oneTBB: the native package must bear that."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

SAMPLE = """
import os, sys
import bpy
import dapple
import hashlib
import numpy as np
bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16)
mesh = bpy.context.object.data
mesh.calc_loop_triangles()
vertices = np.array([v.co for v in mesh.vertices], dtype=np.float64)
faces = np.array([t.vertices[:] for t in mesh.loop_triangles], dtype=np.int32)
samples = dapple.sample(dapple.Surface(vertices, faces), 200, seed=1)
print(hashlib.sha256(samples.positions.tobytes()).hexdigest())
sys.stdout.flush()
os._exit(0)
"""


def sampled(preload):
    environment = {**os.environ, "LD_PRELOAD": " ".join(map(str, preload))}
    done = subprocess.run(
        [sys.executable, "-c", SAMPLE],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()[-1]


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="needs bpy as a module of Python")
@pytest.mark.skipif(sys.platform != "linux", reason="LD_PRELOAD is Linux's")
def test_blenders_own_embree_and_tbb_change_nothing():
    lib = Path(bpy.utils.resource_path("LOCAL")).parent / "lib"
    preload = [*lib.glob("libembree4.so.4"), *lib.glob("libtbb.so.12")]
    assert len(preload) == 2
    assert sampled(preload) == sampled([])
