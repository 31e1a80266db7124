# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender executable exports its own Embree and oneTBB: the native package must bear that."""

import os
import subprocess
import sys
from pathlib import Path

import addon_host
import bpy
import numpy as np
import pytest
import scenes

SAMPLE = """
import hashlib, os, sys
import bpy
import dapple
import numpy as np
surface = dapple.Surface(*np.load(sys.argv[1]).values())
samples = dapple.sample(surface, 200, seed=1)
print(hashlib.sha256(samples.positions.tobytes()).hexdigest())
sys.stdout.flush()
os._exit(0)
"""


def sampled(surface, preload):
    environment = {**os.environ, "LD_PRELOAD": " ".join(map(str, preload))}
    done = subprocess.run(
        [sys.executable, "-c", SAMPLE, str(surface)],
        env=environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()[-1]


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="needs bpy as a module of Python")
@pytest.mark.skipif(sys.platform != "linux", reason="LD_PRELOAD is Linux's")
def test_blenders_own_embree_and_tbb_change_nothing(tmp_path):
    lib = Path(bpy.utils.resource_path("LOCAL")).parent / "lib"
    preload = [*lib.glob("libembree4.so.4"), *lib.glob("libtbb.so.12")]
    assert len(preload) == 2
    meshio = addon_host.part("blender.meshio")
    read = meshio.read_surface(scenes.sphere(), bpy.context.evaluated_depsgraph_get())
    np.savez(tmp_path / "sphere.npz", read.vertices, read.faces)
    assert sampled(tmp_path / "sphere.npz", preload) == sampled(tmp_path / "sphere.npz", [])
