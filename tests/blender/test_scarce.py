# SPDX-License-Identifier: GPL-3.0-or-later
"""Disks that are full or read-only, and paths that are long or of other scripts."""

import os
import subprocess
from pathlib import Path

import addon_host
import bpy
import numpy as np
import pytest
import scenes

# Nothing stays open that Python would warn of later.
pytestmark = pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
FRAMES = 6
NAME = "Scales"
BLOCK = 4096
# Letters that are difficult for programs, and paths longer than Windows accepts by default.
ODD = "Würfel 影 — ŋ'\"&%20 🌿 "
LONG = "long " * 30


def command(*arguments):
    return addon_host.part("blender.command.entry").main([str(one) for one in arguments])


@pytest.fixture
def disk(tmp_path):
    """A small file system of its own."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=16m", "tmpfs", str(folder)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("file systems cannot be mounted here")
    yield folder
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def shot(path):
    """A saved file of a scatter on a body that moves, open."""
    scenes.scattered(scenes.tail(frames=FRAMES), count=60).name = NAME
    assert bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=False) == {"FINISHED"}
    return path


def fill(disk, rest):
    """A file that leaves so many bytes of the disk."""
    filler = disk / "filler"
    found = os.statvfs(disk)
    with filler.open("wb") as stream:
        stream.write(bytes(max(found.f_bavail * found.f_frsize - rest, 0)))
    return filler


def packed(obj):
    stored = addon_host.part("blender.scatter.key_stores").read_baked(obj)
    columns = {**stored.keys, **stored.triangles, **stored.frames}
    return {name: values.tobytes() for name, values in columns.items()}


def opened(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.data.objects[NAME]


def rests(path):
    """From nothing to as much as the file, in blocks: twice as many each time."""
    return [0, *(BLOCK << k for k in range(12) if BLOCK << k <= 2 * path.stat().st_size)]


def test_a_bake_on_a_full_disk_leaves_the_file_and_goes_on_once_there_is_room(disk, capfd):
    path = shot(disk / "shot.blend")
    before = path.read_bytes()
    failed = 0
    for rest in rests(path):
        filler = fill(disk, rest)
        code, said = command("bake"), capfd.readouterr().err
        filler.unlink()
        if code == 0:
            assert opened(path).dapple.baked_keys == FRAMES
            break
        failed += 1
        assert code == 1
        assert "MB are left on the disk" in said, said
        assert "Traceback" not in said
        assert path.read_bytes() == before
        assert not [one.name for one in disk.iterdir() if ".part" in one.name]
        assert opened(path).dapple.baked_keys == 0
    assert failed
    assert command("bake") == 0
    found = packed(opened(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert packed(bpy.data.objects[NAME]) == found


def contents(folder):
    """The bytes of all files by their paths."""
    files = sorted(one for one in folder.rglob("*") if one.is_file())
    return {one.relative_to(folder).as_posix(): one.read_bytes() for one in files}


def meshes_of(ending):
    """Files that an export writes beside its own."""
    name = f"points_meshes/0_0_{NAME}_Cone"
    return [f"{name}.mtl", f"{name}.obj"] if ending == "tscn" else []


@pytest.mark.parametrize("ending", ["csv", "npz", "usda", "glb", "tscn"])
def test_an_export_on_a_full_disk_leaves_what_was_there(
    disk, needs_exporter, tmp_path, capfd, ending
):
    needs_exporter(f".{ending}")
    shot(tmp_path / "shot.blend")
    target = disk / f"points.{ending}"
    assert command("export", target) == 0
    before = contents(disk)
    assert list(before) == [target.name, *meshes_of(ending)]
    bpy.data.objects[NAME].dapple.count = 90
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    capfd.readouterr()
    for rest in range(0, len(before[target.name]), BLOCK):
        filler = fill(disk, rest)
        code, said = command("export", target), capfd.readouterr().err
        filler.unlink()
        assert code == 1, rest
        assert target.name in said
        assert "Traceback" not in said
        assert contents(disk) == before
    assert command("export", target) == 0
    assert target.read_bytes() != before


def test_a_button_that_finds_a_full_disk_says_so_and_the_bake_is_there(disk):
    path = shot(disk / "shot.blend")
    filler = fill(disk, 0)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert bpy.data.objects[NAME].dapple.baked_keys == FRAMES
    with pytest.raises(RuntimeError):
        bpy.ops.wm.save_mainfile()
    filler.unlink()
    assert opened(path).dapple.baked_keys == 0


def test_a_folder_that_is_read_only(disk, capfd):
    path = shot(disk / "shot.blend")
    before = path.read_bytes()
    subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
    try:
        for words in (["bake"], ["optimize"], ["export", disk / "points.npz"]):
            assert command(*words) == 1
            said = capfd.readouterr().err
            assert "Read-only file system" in said or "could not be saved" in said, said
            assert "Traceback" not in said
            opened(path)
        assert bpy.ops.dapple.bake() == {"FINISHED"}
    finally:
        subprocess.run(["mount", "-o", "remount,rw", str(disk)], check=True)
    assert path.read_bytes() == before


@pytest.mark.parametrize("folders", [[ODD], [LONG, LONG]], ids=["odd", "long"])
def test_paths_of_all_kinds(tmp_path, folders):
    folder = Path(tmp_path, *folders)
    folder.mkdir(parents=True)
    path = shot(folder / f"shot {ODD}.blend")
    assert command("bake") == 0
    assert command("check", "--baked") == 0
    obj = opened(path)
    assert obj.dapple.baked_keys == FRAMES
    for ending in ("csv", "npz"):
        assert command("export", folder / f"points {ODD}.{ending}") == 0
    with np.load(folder / f"points {ODD}.npz") as arrays:
        assert len(arrays["positions"]) == len(obj.data.vertices)
    obj.dapple.count = 70
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    bpy.context.scene.frame_end = FRAMES - 1
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert bpy.ops.wm.save_mainfile() == {"FINISHED"}
    assert opened(path).dapple.baked_keys == FRAMES - 1
