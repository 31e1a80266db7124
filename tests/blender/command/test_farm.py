# SPDX-License-Identifier: GPL-3.0-or-later
"""Shots on a farm: several Blender processes, one killed; the jobs for schedulers that ship."""

import json
import os
import re
import shutil
import signal
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import addon_host
import bpy
import numpy as np
import pytest
import scenes
import startup

ROOT = Path(__file__).parents[3]
OPENJD, FLAMENCO = (ROOT / "packaging" / "farm" / name for name in ("openjd", "flamenco"))
FRAMES, LONG = 5, 24
PATIENCE = 900  # seconds for a process on a busy machine
TEMPLATES = sorted(OPENJD.glob("*.yaml"))


def shots(folder, frames):
    """Saved files of tails that move for so many frames, each with a scatter of another seed."""
    folder.mkdir()
    paths = []
    for seed, count in enumerate(frames):
        startup.begin()
        bpy.context.scene.frame_start = 1
        obj = scenes.scattered(scenes.tail(frames=count), count=80)
        obj.name, obj.dapple.seed = "Scales", seed
        assert bpy.ops.dapple.optimize() == {"FINISHED"}
        paths.append(folder / f"shot_{seed}.blend")
        bpy.ops.wm.save_as_mainfile(filepath=str(paths[-1]))
    return paths


def bytes_of(path):
    """Points and keys of the scatter in a file."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    obj = bpy.data.objects["Scales"]
    stored = addon_host.part("blender.scatter.key_stores").read_baked(obj)
    columns = {**stored.keys, **stored.triangles, **stored.frames}
    places = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", places)
    found = {name: values.tobytes() for name, values in columns.items()}
    return found | {"points": places.tobytes()}


def bake(blender, path, *arguments):
    words = [str(blender), "-b", str(path), "--command", "dapple", "bake", *map(str, arguments)]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finished(process):
    said, _ = process.communicate(timeout=PATIENCE)
    return process.returncode, said


def killed_in_the_middle(blender, path):
    """Number of frames stored by a bake that was killed while it solved."""
    process = bake(blender, path)
    kept = path.with_suffix(".dapple")
    end = time.monotonic() + PATIENCE
    while len(list(kept.rglob("frame_*.npz"))) < 2 and time.monotonic() < end:
        time.sleep(0.002)
    process.kill()
    code, said = finished(process)
    assert code == -signal.SIGKILL, said
    return len(list(kept.rglob("frame_*.npz")))


def test_four_shots_in_three_processes_one_of_them_killed_are_those_of_a_single_run(
    tmp_path, blender
):
    made = shots(tmp_path / "single", [LONG, *[FRAMES] * 3])
    shutil.copytree(tmp_path / "single", tmp_path / "farm")
    for path in made:
        bpy.ops.wm.open_mainfile(filepath=str(path))
        assert addon_host.part("blender.command.entry").main(["bake", "--quiet"]) == 0
    first, *others = [tmp_path / "farm" / path.name for path in made]
    before = first.read_bytes()
    with ThreadPoolExecutor(3) as workers:
        kept = workers.submit(killed_in_the_middle, blender, first)
        codes = list(workers.map(lambda path: finished(bake(blender, path)), others))
    assert [code for code, _ in codes] == [0] * 3, codes
    assert 2 <= kept.result() < LONG
    assert first.read_bytes() == before
    code, said = finished(bake(blender, first, "--json", tmp_path / "report.json"))
    assert code == 0, said
    (facts,) = json.loads((tmp_path / "report.json").read_text())["scatters"]
    assert (facts["resumed"], facts["solved"]) == (kept.result(), LONG - kept.result())
    for path in made:
        assert bytes_of(path) == bytes_of(tmp_path / "farm" / path.name), path.name
    assert not list((tmp_path / "farm").rglob("*.npz"))


def small_pictures(path):
    """Make renders of the open shot quick, and save it."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.render.resolution_x = scene.render.resolution_y = 16
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def openjd(*arguments):
    program = shutil.which("openjd")
    if program is None:
        pytest.skip("needs openjd-cli")
    words = [program, *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.parametrize("template", TEMPLATES, ids=lambda path: path.stem)
def test_a_template_is_right(template):
    assert "passes validation checks" in openjd("check", template)


def test_a_shot_as_a_job(tmp_path, blender):
    (path,) = shots(tmp_path / "shots", [FRAMES])
    given = ("-p", f"Shot={path}", "-p", f"Blender={blender}", "-p", "Frames=2-4")
    said = openjd("run", OPENJD / "shot.yaml", *given)
    assert "openjd_progress: 100" in said
    bytes_of(path)
    assert bpy.data.objects["Scales"].dapple.baked_keys == 3
    said = openjd("run", OPENJD / "shot.yaml", *given, "-p", "Scatter=Scales")
    assert "'Scales': up to date" in said


def test_many_shots_as_one_job_on_three_workers(tmp_path, blender):
    made = shots(tmp_path / "shots", [FRAMES] * 3)
    listed = json.dumps([str(path) for path in made])
    given = ("-p", f"Shots={listed}", "-p", f"Blender={blender}")
    with ThreadPoolExecutor(3) as workers:
        tasks = [("-tp", f"Shot={path}") for path in made]
        said = workers.map(lambda task: openjd("run", OPENJD / "shots.yaml", *given, *task), tasks)
        assert all("openjd_progress: 100" in one for one in said)
    for path in made:
        bytes_of(path)
        assert bpy.data.objects["Scales"].dapple.baked_keys == FRAMES


def test_a_shot_that_is_baked_and_then_rendered_as_a_job(tmp_path, blender):
    (path,) = shots(tmp_path / "shots", [FRAMES])
    small_pictures(path)
    given = {"Shot": path, "Frames": "1-2", "Pictures": tmp_path / "out", "Blender": blender}
    words = [word for name, value in given.items() for word in ("-p", f"{name}={value}")]
    openjd(
        "run",
        OPENJD / "shot_and_pictures.yaml",
        *("--step", "Render", "--run-dependencies"),
        *words,
    )
    assert sorted(one.name for one in (tmp_path / "out").iterdir()) == [
        "frame_000001.png",
        "frame_000002.png",
    ]
    bytes_of(path)
    assert bpy.data.objects["Scales"].dapple.baked_keys == 2


def compiled(**settings):
    """Tasks that Flamenco makes of a job, or the error of the script about its settings."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node")
    script, manager = FLAMENCO / "dapple_bake.js", Path(__file__).with_name("flamenco.js")
    words = [node, str(manager), str(script), json.dumps(settings, default=str)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE)
    return json.loads(done.stdout) if done.returncode == 0 else done.stderr


def test_a_flamenco_job_bakes_and_then_renders(tmp_path, blender):
    (path,) = shots(tmp_path / "shots", [FRAMES])
    small_pictures(path)
    job = compiled(
        blendfile=path,
        bake_frames=f"1-{FRAMES}",
        scatter="Scales",
        baked_file=tmp_path / "baked.blend",
        render=True,
        frames="1, 3-4",
        chunk_size=2,
        render_output_root=tmp_path,
    )
    done = set()
    for task in job["tasks"]:
        assert done.issuperset(task["dependencies"])
        for command in task["commands"]:
            run_command(blender, **command["parameters"])
        done.add(task["name"])
    assert done == {"bake", "render-1,3", "render-4"}
    pictures = sorted(one.name for one in (tmp_path / "shot").iterdir())
    assert pictures == ["000001.png", "000003.png", "000004.png"]
    bytes_of(tmp_path / "baked.blend")
    assert bpy.data.objects["Scales"].dapple.baked_keys == FRAMES


def run_command(blender, exe, exeArgs, argsBefore, blendfile, args):  # noqa: N803 - their names
    """Run a command as a worker does, with the usual values of both variables."""
    assert (exe, exeArgs) == ("{blender}", "{blenderArgs}")
    words = [str(blender), *argsBefore, "-b", blendfile, *args]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"bake_frames": "1:6"}, "bake_frames is '1:6': a range such as 1-250 is needed"),
        ({"bake_frames": "1-6", "render": True}, "render_output_root is empty"),
    ],
)
def test_a_flamenco_job_with_wrong_settings_is_refused(settings, words):
    assert words in compiled(blendfile="/shots/shot.blend", **settings)


def test_settings_of_the_flamenco_job_are_of_known_kinds():
    settings = compiled(blendfile="/shots/shot.blend", bake_frames="1-6")["type"]["settings"]
    for one in settings:
        assert one["type"] in {"string", "int32", "float", "bool"}, one["key"]
        assert one.get("visible", "web") in {"visible", "hidden", "submission", "web"}, one["key"]
        assert one.get("subtype", "file_path") in {"file_path", "dir_path"}, one["key"]
        assert "description" in one, one["key"]


def test_the_examples_of_the_page_run(tmp_path, blender, monkeypatch):
    page = (ROOT / "docs" / "farm.md").read_text()
    _, templates, commands = re.findall(r"^```sh\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    if shutil.which("openjd") is None:
        templates = ""
    made = shots(tmp_path / "shots", [FRAMES] * 2)
    for path, name in zip(made, ("tail", "arm"), strict=True):
        path.rename(path.with_name(f"{name}.blend"))
    (tmp_path / "packaging").symlink_to(ROOT / "packaging")
    monkeypatch.setenv("PATH", f"{blender.parent}{os.pathsep}{os.environ['PATH']}")
    words = ["sh", "-ec", (templates + commands).replace("/shots/", f"{tmp_path}/shots/")]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr
    for name in ("tail", "arm"):
        bytes_of(tmp_path / "shots" / f"{name}.blend")
        assert bpy.data.objects["Scales"].dapple.baked_frames == FRAMES
