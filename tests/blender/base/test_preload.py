# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender executable exports its own Embree and oneTBB: the native package must bear that."""

import sys
from pathlib import Path

import addon_host
import bpy
import child
import numpy as np
import pytest
import scenes

SAMPLE = """
import hashlib
import dapple3d as dapple
import numpy as np
surface = dapple.Surface(*np.load(arguments[0]).values())
samples = dapple.sample(surface, 200, seed=1)
print(hashlib.sha256(samples.positions.tobytes()).hexdigest())
"""


def sampled(surface, preload):
    return child.run(SAMPLE, surface, LD_PRELOAD=" ".join(map(str, preload))).split()[-1]


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="needs bpy as a module of Python")
@pytest.mark.skipif(bool(addon_host.TESTED_ZIP), reason="test_package.py tests that of the zip")
@pytest.mark.skipif(sys.platform != "linux", reason="LD_PRELOAD is Linux's")
def test_blenders_own_embree_and_tbb_change_nothing(tmp_path):
    lib = Path(bpy.utils.resource_path("LOCAL")).parent / "lib"
    preload = [*lib.glob("libembree4.so.4"), *lib.glob("libtbb.so.12")]
    assert len(preload) == 2
    reading = addon_host.part("blender.surface.mesh")
    read = reading.read_mesh(scenes.sphere())
    np.savez(tmp_path / "sphere.npz", read.vertices, read.faces)
    assert sampled(tmp_path / "sphere.npz", preload) == sampled(tmp_path / "sphere.npz", [])
