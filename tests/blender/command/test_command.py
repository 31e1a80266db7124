# SPDX-License-Identifier: GPL-3.0-or-later
"""blender --command dapple: exit codes, reports, stops, and a file that is whole or as before."""

import json
import os
import re
import shlex
import signal
import subprocess
from pathlib import Path

import addon_host
import bpy
import child
import numpy as np
import pytest
import scenes

FRAMES = 6
DOCS = Path(__file__).parents[3] / "docs"


def command(*arguments):
    return addon_host.part("blender.command.entry").main([str(one) for one in arguments])


def shot(path, *names, count=60):
    """A saved file of a tail with scatters, open."""
    surface = scenes.tail(frames=FRAMES)
    for name in names or ("Scales",):
        scenes.scattered(surface, count=count).name = name
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def path(tmp_path):
    return shot(tmp_path / "shot one.blend")


def opened(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.data.objects


def packed(obj):
    stored = addon_host.part("blender.scatter.key_stores").read_baked(obj)
    columns = {**stored.keys, **stored.triangles, **stored.frames}
    return {name: values.tobytes() for name, values in columns.items()}


def work_files(path):
    return sorted(path.with_suffix(".dapple").rglob("*.npz"))


def read(path):
    return json.loads(path.read_text())


def test_bake_saves_what_the_operator_bakes(path, tmp_path, capfd):
    assert command("bake", "--json", tmp_path / "report.json") == 0
    stepped = packed(opened(path)["Scales"])
    assert not work_files(path)
    assert not list(tmp_path.glob("*.part*")), "a part was left"
    scenes.activate(bpy.data.objects["Scales"])
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert packed(bpy.data.objects["Scales"]) == stepped
    report = read(tmp_path / "report.json")
    (facts,) = report["scatters"]
    assert (report["exit"], report["saved"], report["command"]) == (0, str(path), "bake")
    assert (facts["name"], facts["state"], facts["frames"]) == ("Scales", "baked", [1, FRAMES])
    assert (facts["points"], facts["solved"], facts["resumed"]) == (60, FRAMES, 0)
    said = capfd.readouterr()
    assert re.search(r"^Dapple: Progress: 100%: done$", said.err, re.MULTILINE)
    assert "Progress" not in said.out


def test_some_frames_of_some_scatters(tmp_path):
    path = shot(tmp_path / "shot.blend", "Leaves", "Scales", "Moss")
    assert command("bake", "--frames", "2-4", "--scatter", "Moss", "--scatter", "Scales") == 0
    there = opened(path)
    keys = [there[name].dapple.baked_keys for name in ("Leaves", "Scales", "Moss")]
    assert keys == [0, 3, 3]
    assert there["Moss"].dapple.baked_start == 2
    scene = bpy.context.scene
    assert (scene.frame_start, scene.frame_end, scene.frame_current) == (1, FRAMES, 1)


def test_another_file_is_saved_and_the_first_stays(path, tmp_path):
    before, output = path.read_bytes(), tmp_path / "baked.blend"
    assert command("bake", "--output", output) == 0
    assert path.read_bytes() == before
    assert opened(output)["Scales"].dapple.baked_keys == FRAMES
    assert opened(path)["Scales"].dapple.baked_keys == 0
    assert not work_files(path)


def test_a_baked_file_is_copied_to_where_it_is_asked_for(path, tmp_path, capfd):
    assert command("bake") == 0
    assert command("bake", "--if-needed", "--output", tmp_path / "again.blend") == 0
    assert "'Scales': up to date\n" in capfd.readouterr().out
    assert opened(tmp_path / "again.blend")["Scales"].dapple.baked_keys == FRAMES


@pytest.mark.parametrize("compress", [True, False])
def test_a_compressed_file_stays_compressed(tmp_path, compress):
    path = tmp_path / "shot.blend"
    scenes.scattered(scenes.sphere())
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=compress)
    opened(path)
    magic = path.read_bytes()[:4]
    assert command("bake", "--frames", "1") == 0
    assert (path.read_bytes()[:4], magic == b"BLEN") == (magic, not compress)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "the following arguments are required: VERB"),
        (("fry",), "invalid choice: 'fry'"),
        (("bake", "--frames", "1:9"), "'1:9' is not a range of frames such as 1-250"),
        (("bake", "--frames", "9-1"), "the range of frames is empty: 9 to 1"),
        (("bake", "--color"), "unrecognized arguments: --color"),
    ],
)
def test_wrong_usage_is_2(path, capfd, arguments, words):
    before = path.read_bytes()
    assert command(*arguments) == 2
    assert words in capfd.readouterr().err
    assert path.read_bytes() == before


def test_help_is_no_error(capfd):
    assert command("bake", "--help") == 0
    assert "--if-needed" in capfd.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--scatter", "Scals"), "There is no scatter 'Scals'; those of 'Scene': 'Scales'"),
        (("--scatter", "Tail"), "There is no scatter 'Tail'"),
        (("--output", "baked.blob"), "'baked.blob' must end in .blend"),
        (("--output", "missing/baked.blend"), "the folder does not exist"),
        (("--json", "."), "'.' is a folder"),
    ],
)
def test_bad_input_is_1_and_is_reported_before_any_work(path, capfd, arguments, words):
    before = path.read_bytes()
    assert command("bake", *arguments) == 1
    assert words in capfd.readouterr().err
    assert path.read_bytes() == before
    assert not path.with_suffix(".dapple").exists()


def test_without_a_file_there_is_nothing_to_do(capfd):
    assert command("check") == 1
    assert "No file is open" in capfd.readouterr().err


def test_one_that_fails_does_not_keep_others_from_being_baked_and_saved(tmp_path, capfd):
    path = shot(tmp_path / "shot.blend", "Leaves", "Scales")
    bpy.data.objects["Leaves"].dapple.density.attribute = "Missing"
    assert command("bake", "--json", tmp_path / "report.json") == 1
    assert "'Leaves': failed: " in capfd.readouterr().err
    states = {one["name"]: one["state"] for one in read(tmp_path / "report.json")["scatters"]}
    assert states == {"Leaves": "failed", "Scales": "baked"}
    there = opened(path)
    assert (there["Leaves"].dapple.baked_keys, there["Scales"].dapple.baked_keys) == (0, FRAMES)


def test_check_names_what_is_not_up_to_date(tmp_path, capfd):
    shot(tmp_path / "shot.blend", "Leaves", "Scales")
    capfd.readouterr()
    assert command("check") == 0
    assert capfd.readouterr().out == "'Leaves': up to date\n'Scales': up to date\n"
    assert command("check", "--baked") == 1
    assert capfd.readouterr().out.startswith("'Leaves': out of date: It is not baked\n")
    assert command("bake", "--quiet") == 0
    assert capfd.readouterr().err == ""
    assert command("check", "--baked") == 0
    bpy.data.objects["Scales"].dapple.seed = 5
    assert command("check", "--scatter", "Leaves") == 0
    assert command("check") == 1
    assert re.search(r"^'Scales': out of date: .*bake again$", capfd.readouterr().out, re.MULTILINE)


def test_check_finds_motion_that_was_changed_in_one_frame(path, capfd):
    assert command("bake") == 0
    curve = bpy.data.objects["Rig"].pose.bones["tip"]
    curve.rotation_euler = (0.6, 0.3, 0.0)
    curve.keyframe_insert("rotation_euler", frame=5)
    curve.rotation_euler = (0.5, 0.0, 0.0)
    bpy.context.scene.frame_set(1)
    assert command("check") == 1
    assert re.search(r"moves differently .*\(frame [2345]\)", capfd.readouterr().out)
    assert bpy.context.scene.frame_current == 1


def test_check_compares_the_frames_that_are_asked_for(path, capfd):
    assert command("bake", "--frames", "2-4") == 0
    assert command("check") == 1
    assert "Frames 2 to 4 are baked, the scene has 1 to 6" in capfd.readouterr().out
    assert command("check", "--frames", "2-4") == 0


def test_only_what_is_out_of_date_is_baked_when_asked(tmp_path):
    path = shot(tmp_path / "shot.blend", "Leaves", "Scales")
    assert command("bake", "--scatter", "Leaves") == 0
    assert command("bake", "--if-needed", "--json", tmp_path / "report.json") == 0
    states = {one["name"]: one["state"] for one in read(tmp_path / "report.json")["scatters"]}
    assert states == {"Leaves": "up to date", "Scales": "baked"}
    assert opened(path)["Scales"].dapple.baked_keys == FRAMES


def test_optimize_keeps_a_bake_unless_it_may_delete_it(path):
    assert command("bake") == 0
    bpy.data.objects["Scales"].dapple.count = 70
    assert command("optimize") == 1
    assert bpy.data.objects["Scales"].dapple.baked_keys == FRAMES
    assert command("optimize", "--delete-keyframes", "--frame", "3") == 0
    obj = opened(path)["Scales"]
    assert (obj.dapple.baked_keys, len(obj.data.vertices)) == (0, 70)
    assert command("check") == 0


def test_export_writes_the_frames_that_are_asked_for(tmp_path):
    before = shot(tmp_path / "shot.blend", "Leaves", "Scales").read_bytes()
    table, several = tmp_path / "points.csv", tmp_path / "motion.npz"
    assert command("export", table, "--scatter", "Scales", "--frame", "3") == 0
    bpy.context.scene.frame_set(3)
    places = np.genfromtxt(table, delimiter=",", names=True)
    shown = scenes.positions(bpy.data.objects["Scales"])
    assert np.allclose(np.column_stack([places[axis] for axis in "xyz"]), shown, atol=1e-6)
    arguments = ("--frames", "2-4", "--json", tmp_path / "report.json")
    assert command("export", several, *arguments) == 0
    report = read(tmp_path / "report.json")
    files = [str(tmp_path / f"motion.{name}.npz") for name in ("Leaves", "Scales")]
    assert [one["files"] for one in report["scatters"]] == [files, files]
    with np.load(files[1]) as arrays:
        assert arrays["times"].tolist() == [2.0, 3.0, 4.0]
        assert np.allclose(arrays["positions"][1], shown, atol=1e-6)
    assert (tmp_path / "shot.blend").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("points.stl",), 1, "'points.stl' has an unknown file extension"),
        (("missing/points.csv",), 1, "the folder does not exist"),
        (("points.csv", "--frame", "1", "--frames", "1-2"), 2, "not allowed with argument"),
    ],
)
def test_what_cannot_be_exported_is_reported(path, capfd, arguments, code, words):
    assert command("export", *arguments) == code
    assert words in capfd.readouterr().err


def test_a_file_that_another_program_has_saved_is_not_overwritten(path, capfd, monkeypatch):
    baking = addon_host.part("blender.bake.steps")
    write = baking.write_bake

    def write_late(*arguments):
        write(*arguments)
        path.write_bytes(b"of an artist")

    monkeypatch.setattr(baking, "write_bake", write_late)
    assert command("bake") == 1
    assert "was changed by another program meanwhile" in capfd.readouterr().err
    assert path.read_bytes() == b"of an artist"
    assert len(work_files(path)) == FRAMES


def test_a_file_that_cannot_be_saved_stays(path, capfd, monkeypatch):
    before, whole = path.read_bytes(), addon_host.part("core.base.atomic_file")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(whole, "sync", full)
    monkeypatch.setattr(
        addon_host.part("core.bake.sidecar").Sidecar, "store", lambda *_, **__: None
    )
    assert command("bake") == 1
    assert "could not be saved: [Errno 28] No space left on device" in capfd.readouterr().err
    assert path.read_bytes() == before
    assert sorted(one.name for one in path.parent.iterdir() if "part" in one.name) == []


def test_frames_that_cannot_be_kept_are_a_warning(path, tmp_path, capfd):
    path.with_suffix(".dapple").write_text("a file where the folder should be")
    assert command("bake", "--json", tmp_path / "report.json") == 0
    assert "Warning: Dapple: Frames cannot be kept in" in capfd.readouterr().err
    (facts,) = read(tmp_path / "report.json")["scatters"]
    assert facts["warnings"][0].startswith("Frames cannot be kept in")
    assert opened(path)["Scales"].dapple.baked_keys == FRAMES


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_stops_and_the_next_run_goes_on(path, tmp_path, monkeypatch, number, code):
    before, kept = path.read_bytes(), 2
    sidecar = addon_host.part("core.bake.sidecar").Sidecar
    store = sidecar.store

    def signaled(self, frame, *rest, **places):
        store(self, frame, *rest, **places)
        if frame == kept:
            os.kill(os.getpid(), number)

    monkeypatch.setattr(sidecar, "store", signaled)
    handler = signal.getsignal(number)
    assert command("bake", "--json", tmp_path / "report.json") == code
    assert signal.getsignal(number) == handler
    (facts,) = read(tmp_path / "report.json")["scatters"]
    assert facts["state"] == "stopped"
    assert "solved frames are kept in" in facts["error"]
    assert path.read_bytes() == before
    monkeypatch.undo()
    solved = len(work_files(path))
    assert kept <= solved < FRAMES
    assert command("bake", "--json", tmp_path / "report.json") == 0
    (facts,) = read(tmp_path / "report.json")["scatters"]
    assert (facts["resumed"], facts["solved"]) == (solved, FRAMES - solved)


def test_a_signal_keeps_what_is_done(tmp_path, monkeypatch):
    path = shot(tmp_path / "shot.blend", "Leaves", "Scales")
    sidecar = addon_host.part("core.bake.sidecar").Sidecar
    store = sidecar.store

    def signaled(self, *arguments, **places):
        store(self, *arguments, **places)
        if self.folder.name.startswith("Scales"):
            os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(sidecar, "store", signaled)
    assert command("bake", "--json", tmp_path / "report.json") == 143
    monkeypatch.undo()
    assert [one["state"] for one in read(tmp_path / "report.json")["scatters"]] == [
        "baked",
        "stopped",
    ]
    there = opened(path)
    assert (there["Leaves"].dapple.baked_keys, there["Scales"].dapple.baked_keys) == (FRAMES, 0)
    assert command("bake", "--if-needed", "--json", tmp_path / "report.json") == 0
    leaves, scales = read(tmp_path / "report.json")["scatters"]
    assert leaves["state"] == "up to date"
    assert scales["resumed"] >= 1


KILLED_WHILE_SAVING = """
import os
from pathlib import Path
import addon_host
addon_host.add_repository(Path(arguments[1]))
addon_host.enable()
whole = addon_host.part("core.base.atomic_file")
sync = whole.sync

def killed(path, flags):
    if path.suffix == ".blend":
        os.kill(os.getpid(), 9)
    sync(path, flags)

whole.sync = killed
bpy.ops.wm.open_mainfile(filepath=arguments[0])
addon_host.part("blender.command.entry").main(["bake"])
"""


def test_a_run_that_is_killed_while_it_saves_leaves_the_file_and_the_frames(path, tmp_path):
    before = path.read_bytes()
    child.killed(KILLED_WHILE_SAVING, path, tmp_path / "repository")
    assert path.read_bytes() == before
    assert len(work_files(path)) == FRAMES
    assert len(list(tmp_path.glob(".*.part.blend"))) == 1
    opened(path)
    assert command("bake", "--json", tmp_path / "report.json") == 0
    assert read(tmp_path / "report.json")["scatters"][0]["resumed"] == FRAMES
    assert not list(tmp_path.glob(".*.part*"))


def test_linked_scatters_are_left_to_their_file(path, tmp_path, capfd):
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.objects = ["Scales", "Tail"]
    for obj in wanted.objects:
        bpy.context.scene.collection.objects.link(obj)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "linking.blend"))
    assert command("bake", "--json", tmp_path / "report.json") == 0
    assert read(tmp_path / "report.json")["scatters"] == []
    assert command("bake", "--scatter", "Scales") == 1
    assert "'Scales' is linked from 'shot one.blend'" in capfd.readouterr().err


def test_a_scatter_that_is_not_in_the_view_layer_is_named(path, capfd):
    collection = bpy.data.collections.new("Away")
    bpy.context.scene.collection.children.link(collection)
    obj = bpy.data.objects["Scales"]
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    bpy.context.view_layer.layer_collection.children["Away"].exclude = True
    assert command("check") == 0
    assert command("check", "--scatter", "Scales") == 1
    assert "Scatter 'Scales' is not in the view layer 'ViewLayer'" in capfd.readouterr().err


@pytest.fixture(scope="module")
def blender(tmp_path_factory):
    """A function that calls Blender or a replacement with options; returns the finished process."""
    program = child.program(tmp_path_factory.mktemp("program"))

    def call(*arguments):
        words = [str(program), *map(str, arguments)]
        return subprocess.run(words, capture_output=True, text=True, timeout=900)

    return call


def test_the_program_runs_the_command_and_ends_with_its_code(path, blender):
    done = blender("-b", path, "--command", "dapple", "bake")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Dapple: Progress: 100%: done\n" in done.stderr
    done = blender("-b", path, "--command", "dapple", "check", "--baked")
    assert (done.returncode, "'Scales': up to date\n" in done.stdout) == (0, True)
    assert opened(path)["Scales"].dapple.baked_keys == FRAMES
    assert blender("-b", path, "--command", "dapple", "fry").returncode == 2


def code(language):
    """The examples of docs/farm.md in a language."""
    page = (DOCS / "farm.md").read_text()
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.DOTALL | re.MULTILINE)


def test_the_examples_of_the_page_run(tmp_path, monkeypatch, blender):
    monkeypatch.chdir(tmp_path)
    path = shot(tmp_path / "shot.blend", "Pebbles")
    bpy.context.scene.frame_end = 3
    bpy.ops.wm.save_mainfile()
    for line in code("sh")[0].splitlines():
        program, *arguments = shlex.split(line.replace("1-250", "1-3"))
        done = blender(*arguments)
        assert (program, done.returncode) == ("blender", 0), done.stdout + done.stderr
    (shown,), report = map(json.loads, code("json")), read(tmp_path / "report.json")
    assert shown.keys() == report.keys()
    assert shown["scatters"][0].keys() == report["scatters"][0].keys()
    assert opened(path)["Pebbles"].dapple.baked_keys == 3


def test_every_option_is_documented():
    page = (DOCS / "farm.md").read_text()
    arguments = addon_host.part("blender.command.arguments")
    parser = arguments.parser()
    (verbs,) = parser._subparsers._group_actions
    for name, verb in verbs.choices.items():
        assert f"| `{name}" in page
        for action in verb._actions:
            option = [*action.option_strings, action.metavar][0]
            assert action.dest == "help" or option in page, action.dest


def test_the_command_comes_and_goes_with_the_addon(addon):
    entry = addon_host.part("blender.command.entry")
    assert entry.is_registered()
    addon.unregister()
    assert not entry.is_registered()
    addon.register()
    assert entry.is_registered()
