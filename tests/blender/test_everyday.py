# SPDX-License-Identifier: GPL-3.0-or-later
"""Everyday jobs keep their promises: the quick ones of benchmarks/everyday."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[2]))  # Blender's executable does not set it
from benchmarks.everyday import scenes
from benchmarks.everyday.bakes import BAKES
from benchmarks.everyday.stills import STILLS

QUICK = (
    "a grid with Solidify",
    "rocks in grass",
    "three types with radii",
    "off an object",
    "in the camera's view",
    "by area on a mirrored object",
    "a copied character",
    "a preset with object types",
    "a bake with a painted group",
    "off a moving cube",
    "off another scatter that moves",
    "a forward axis",
)


@pytest.mark.parametrize("name", QUICK)
def test_an_everyday_job_keeps_what_it_promises(name):
    job = next(job for job in (*STILLS, *BAKES) if job.name == name)
    scenes.empty()
    assert job.broken(job.run(), None) == []
