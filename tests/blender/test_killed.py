# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender is killed at random moments: the .blend opens, and work continues with the same bytes."""

import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import addon_host
import bpy
import child
import numpy as np
import pytest
import scenes

KILLS = int(os.environ.get("DAPPLE_KILLS", "1"))
FRAMES = 24
NAME = "Scales"


@pytest.fixture
def shot(tmp_path):
    """A saved file of a scatter on a body that moves."""
    path = tmp_path / "shot" / "shot.blend"
    path.parent.mkdir()
    scenes.scattered(scenes.tail(frames=FRAMES), count=150).name = NAME
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def copied(shot, name):
    """The shot with its folder, elsewhere."""
    return shutil.copytree(shot.parent, shot.parent.with_name(name)) / shot.name


class Work:
    """A command of the add-on in a process of its own, on a file."""

    def __init__(self, blender, path, *arguments):
        command = [blender, "-b", path, "--command", "dapple", *arguments]
        self.process = subprocess.Popen(
            [str(word) for word in command],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        self.said = ""
        for line in self.process.stderr:
            self.said += line
            if "Progress" in line:
                break
        self.begun = time.monotonic()

    def seconds(self):
        """Seconds from the first progress message to the end."""
        self.said += self.process.communicate()[1]
        assert self.process.returncode == 0, self.said
        return time.monotonic() - self.begun

    def kill(self, moment):
        """Kill it some seconds after its first progress message; returns whether it was still
        working.
        """
        time.sleep(moment)
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.communicate()
        return self.process.returncode == -signal.SIGKILL


def packed(path):
    """The bytes of the keyframes in a file."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    stored = addon_host.part("blender.scatter.key_stores").read_baked(bpy.data.objects[NAME])
    columns = {**stored.keys, **stored.triangles, **stored.frames}
    return {name: values.tobytes() for name, values in columns.items()}


def scatter(path):
    """The scatter of a file, whose points must be complete."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects[NAME]
    ids = addon_host.part("blender.scatter.points").point_columns_of(obj)["id"]
    assert len(np.unique(ids)) == len(obj.data.vertices) == obj.dapple.report.count
    return obj


def test_a_bake_that_is_killed_again_and_again_gives_the_same_bytes(blender, shot):
    whole = copied(shot, "whole")
    seconds = Work(blender, whole, "bake").seconds()
    wanted, chance = packed(whole), random.Random(0)
    for number in range(KILLS):
        path = copied(shot, f"killed {number}")
        for _ in range(2):
            Work(blender, path, "bake").kill(chance.uniform(0.0, seconds))
            obj = scatter(path)
            assert obj.dapple.baked_keys in (0, FRAMES)
        Work(blender, path, "bake").seconds()
        assert packed(path) == wanted
        assert not [one.name for one in path.parent.iterdir() if ".part" in one.name]
        shutil.rmtree(path.parent)


@pytest.mark.parametrize(
    ("ending", "frames"),
    [("npz", f"1-{FRAMES}"), ("usda", f"1-{FRAMES}"), ("csv", ""), ("glb", "")],
)
def test_a_killed_export_leaves_a_whole_file_or_none(blender, needs_exporter, shot, ending, frames):
    needs_exporter(f".{ending}")
    target = shot.with_name(f"points.{ending}")
    before = shot.read_bytes()
    arguments = ["export", target, *(["--frames", frames] if frames else [])]
    seconds = Work(blender, shot, *arguments).seconds()
    wanted, chance = target.read_bytes(), random.Random(1)
    for _ in range(KILLS):
        target.unlink()
        Work(blender, shot, *arguments).kill(chance.uniform(0.0, seconds))
        assert not target.exists() or target.read_bytes() == wanted
        Work(blender, shot, *arguments).seconds()
        assert target.read_bytes() == wanted
    assert shot.read_bytes() == before


SAVING = """
import itertools
from pathlib import Path
import addon_host
addon_host.add_repository(Path(arguments[1]))
addon_host.enable()
bpy.ops.wm.open_mainfile(filepath=arguments[0])
obj = bpy.data.objects["Scales"]
print("Progress", file=sys.stderr, flush=True)
for number in itertools.count():
    obj.dapple.count = 40 + number % 50
    bpy.ops.dapple.optimize()
    if number % 3 == 1:
        bpy.context.scene.frame_end = 3
        bpy.ops.dapple.bake()
    bpy.ops.wm.save_mainfile()
"""


def saved(path):
    """A file that Blender may have been saving. It writes a new one aside, renames the old one and
    then the new one: between these two there is none of the name, which is put right here.
    """
    if not path.exists():
        assert Path(f"{path}1").exists()
        Path(f"{path}@").rename(path)
    return path


def test_a_file_that_is_killed_while_it_is_saved_opens(shot, tmp_path):
    chance = random.Random(2)
    for number in range(KILLS):
        with child.started(SAVING, shot, tmp_path / f"repository {number}") as process:
            next(line for line in process.stderr if "Progress" in line)
            time.sleep(chance.uniform(0.0, 1.0))
            assert process.poll() is None, process.stderr.read()
            process.kill()
        obj = scatter(saved(shot))
        assert obj.dapple.baked_keys in (0, 3)
        assert not scenes.node_warnings(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.wm.save_mainfile() == {"FINISHED"}
