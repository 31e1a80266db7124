# SPDX-License-Identifier: GPL-3.0-or-later
"""The still examples: rebuilt small, compared with a dump, opened without the add-on."""

import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import addon_host
import bpy
import child
import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
DUMPS = Path(__file__).parent / "dumps"  # made by: python -m blend_examples.NAME --width 0
COUNTS = {
    "meadow": 300,
    "studs": 200,
    "mosaic": 60,
    "portrait": 400,
    "city": 200,
    "decals": 30,
    "edges": 80,
    "trimmed": 40,
    "leaning": 60,
    "colored": 80,
    "seen": 80,
    "logs": 200,
    "remeshed": 800,
    "hair": 60,
    "robot": 120,
    "reef": 120,
    "knight": 120,
    "scales": 120,
}
LARGEST = 2**20  # bytes of a .blend

OPENED = """
bpy.ops.wm.open_mainfile(filepath=arguments[0])
assert not hasattr(bpy.types.Object, "dapple")
depsgraph = bpy.context.evaluated_depsgraph_get()
print("shown", sum(one.is_instance for one in depsgraph.object_instances))
"""


def write(name, count, folder):
    run(name, "--count", count, "--width", 0, "--out", folder)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Folder with the output of all examples, without pictures."""
    folder = tmp_path_factory.mktemp("examples")
    with ThreadPoolExecutor(2) as workers:
        list(workers.map(lambda one: write(*one, folder), COUNTS.items()))
    return folder


def run(name, *arguments):
    """Run an example; returns its output."""
    if addon_host.TESTED_ZIP:
        pytest.skip("the examples import the add-on as it lies in the checkout")
    if bpy.app.binary_path:
        pytest.skip("the examples are run by the bpy module")
    done = subprocess.run(
        [sys.executable, "-m", f"blend_examples.{name}", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("name", COUNTS)
def test_an_example_is_as_it_was(built, name):
    found = json.loads((built / f"{name}.json").read_text())
    before = json.loads((DUMPS / f"{name}.json").read_text())
    assert found["instances"] == before["instances"]
    assert found["polygons"] == pytest.approx(before["polygons"], rel=0.02)
    assert np.allclose(found["box"], before["box"], atol=0.1)


def test_studs_side_by_side(tmp_path):
    said = run(
        "side_by_side", "--count", 60, "--frames", 4, "--only", 2, "--width", 40, "--out", tmp_path
    )
    kept = {name: figures for name, figures in re.findall(r"   (.*): (.*) per frame", said)}
    assert kept["Dapple"] == "always 60 studs, 0 % replaced"
    assert not kept["Blender: Poisson Disk"].endswith(" 0 % replaced")
    with Image.open(tmp_path / "side_by_side.webp") as picture:
        assert picture.n_frames == 2


@pytest.mark.parametrize("name", COUNTS)
def test_an_example_opens_without_the_add_on(built, name):
    file = built / f"{name}.blend"
    assert file.stat().st_size < LARGEST
    expected = sum(json.loads((DUMPS / f"{name}.json").read_text())["instances"].values())
    said = child.run(OPENED, file)
    assert said.split()[-1] == str(expected), said
