# SPDX-License-Identifier: GPL-3.0-or-later
"""Unfinished bakes: they continue after a kill, a cancellation or a rename, from their files."""

import shutil
from pathlib import Path

import addon_host
import bpy
import child
import pytest
import scenes
from frame_files import rewritten

FRAMES = 6


@pytest.fixture
def sidecar():
    return addon_host.part("core.bake.sidecar")


def packed(obj):
    stored = addon_host.part("blender.scatter.key_stores").read_baked(obj)
    columns = {**stored.keys, **stored.triangles, **stored.frames}
    return {name: values.tobytes() for name, values in columns.items()}


def saved_scatter(path):
    obj = scenes.scattered(scenes.tail(frames=FRAMES))
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return obj


def opened(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.context.object


def files_of(obj):
    return addon_host.part("blender.freshness.unfinished_bakes").work_files(obj)


KILLED = """
import os
from pathlib import Path
import addon_host
addon_host.add_repository(Path(arguments[2]))
addon_host.enable()
sidecar = addon_host.part("core.bake.sidecar")
frame, moment = int(arguments[1].split()[0]), arguments[1].split()[1]
replaced, written = Path.replace, Path.write_bytes

def replace(part, target):
    if target.name == f"frame_{frame:06d}.npz" and moment == "before-renaming":
        os.kill(os.getpid(), 9)
    done = replaced(part, target)
    if target.name == f"frame_{frame:06d}.npz" and moment == "after-renaming":
        os.kill(os.getpid(), 9)
    return done

def torn(part, data):
    if f"frame_{frame:06d}" in part.name and moment == "while-writing":
        written(part, data[: len(data) // 2])
        os.kill(os.getpid(), 9)
    return written(part, data)

Path.replace, Path.write_bytes = replace, torn
bpy.ops.wm.open_mainfile(filepath=arguments[0])
bpy.ops.dapple.bake()
"""


@pytest.mark.parametrize(
    ("moment", "kept"), [("4 while-writing", 3), ("4 before-renaming", 3), ("3 after-renaming", 3)]
)
def test_a_killed_bake_goes_on_to_the_same_bytes(tmp_path, moment, kept):
    path = tmp_path / "kill me.blend"
    obj = saved_scatter(path)
    child.killed(KILLED, path, moment, tmp_path / "repository")
    obj = opened(path)
    files = files_of(obj)
    assert files.folder.parent == tmp_path / "kill me.dapple"
    assert files.frames() == kept
    assert addon_host.part("blender.freshness.unfinished_bakes").unfinished(obj) == kept
    stores, advances = counted_solves(), counted_advances()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    resumed = packed(obj)
    assert stores() == advances() == FRAMES - kept
    files.clear()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert packed(obj) == resumed


KILLED_IN_PIECES = KILLED.replace(
    "bpy.ops.wm.open_mainfile",
    """together = addon_host.part("core.bake.window_bake")
together.PIECE, together.OVERLAP = 3, 1
bpy.ops.wm.open_mainfile""",
)


def saved_in_pieces(path, monkeypatch):
    """A scatter whose frames are solved together, the first three of them, then the last four."""
    together = addon_host.part("core.bake.window_bake")
    monkeypatch.setattr(together, "PIECE", 3)
    monkeypatch.setattr(together, "OVERLAP", 1)
    obj = scenes.scattered(scenes.tail(frames=FRAMES))
    obj.dapple.smoothing = "LOOP"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return obj


def taken():
    """Bake; how many frames were solved before."""
    steps, baking = addon_host.part("core.base.steps"), addon_host.part("blender.bake.steps")
    return steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES)).taken


@pytest.mark.parametrize(
    ("moment", "kept", "of_whole_pieces"),
    [("1 after-renaming", 1, 0), ("2 after-renaming", 2, 2), ("4 while-writing", 3, 2)],
)
def test_a_killed_bake_in_pieces_goes_on_to_the_same_bytes(
    tmp_path, monkeypatch, moment, kept, of_whole_pieces
):
    path = tmp_path / "pieces.blend"
    saved_in_pieces(path, monkeypatch)
    child.killed(KILLED_IN_PIECES, path, moment, tmp_path / "repository")
    obj = opened(path)
    assert addon_host.part("blender.freshness.unfinished_bakes").unfinished(obj) == kept
    assert taken() == of_whole_pieces
    resumed = packed(obj)
    files_of(obj).clear()
    assert taken() == 0
    assert packed(obj) == resumed


def test_a_canceled_bake_in_pieces_goes_on_from_the_last_whole_piece(tmp_path, monkeypatch):
    obj = saved_in_pieces(tmp_path / "canceled.blend", monkeypatch)
    said = stop_after(1)
    assert said.startswith("Canceled: the scatter is unchanged; 2 solved frames are kept in")
    assert (going_on(obj), left_over(obj)) == (2, 0)
    assert taken() == 2
    bpy.ops.wm.save_mainfile()
    assert not list(tmp_path.rglob("*.npz"))


def exchanged(one, other):
    first, second = one.read_bytes(), other.read_bytes()
    one.write_bytes(second)
    other.write_bytes(first)


DAMAGES = {
    "exchanged": lambda one, other: exchanged(one, other),
    "truncated": lambda one, _: one.write_bytes(one.read_bytes()[:-200]),
    "other places": lambda one, _: rewritten(one, barycentric=lambda weights: weights[:, ::-1]),
    "gone": lambda one, _: one.unlink(),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_frames_are_solved_again_to_the_same_bytes(tmp_path, damage):
    obj = saved_scatter(tmp_path / "damaged.blend")
    stop_after(4)
    files = files_of(obj)
    DAMAGES[damage](files.path(2), files.path(3))
    assert 1 <= taken() < 4
    resumed = packed(obj)
    files.clear()
    assert taken() == 0
    assert packed(obj) == resumed


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("ahead", [False, True])
def test_damaged_pieces_are_solved_again_to_the_same_bytes(tmp_path, monkeypatch, damage, ahead):
    obj = saved_in_pieces(tmp_path / "damaged.blend", monkeypatch)
    stop_after(1)
    files = files_of(obj)
    one = files.path(3, ahead=True) if ahead else files.path(1)
    DAMAGES[damage](one, files.path(2))
    assert taken() == 0
    resumed = packed(obj)
    files.clear()
    assert taken() == 0
    assert packed(obj) == resumed


def test_frames_ahead_follow_when_the_file_is_saved_under_another_name(tmp_path, monkeypatch):
    obj = saved_in_pieces(tmp_path / "first.blend", monkeypatch)
    stop_after(1)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "second.blend"))
    assert not (tmp_path / "first.dapple").exists()
    assert [path.name for path in files_of(obj).folder.glob("ahead_*")] == ["ahead_000003.npz"]
    assert taken() == 2


def test_pieces_of_another_length_are_solved_anew(tmp_path, monkeypatch):
    saved_in_pieces(tmp_path / "longer.blend", monkeypatch)
    stop_after(1)
    monkeypatch.setattr(addon_host.part("core.bake.window_bake"), "OVERLAP", 2)
    assert taken() == 0


def counted_advances():
    """Counts frames that the tracker solves from here on; call the result to read it and stop."""
    baker = addon_host.part("core.bake.baker").Baker
    advance, seen = baker.advance, []

    def noting(self, context):
        seen.append(self.done)
        return advance(self, context)

    def count():
        baker.advance = advance
        return len(seen)

    baker.advance = noting
    return count


def counted_solves():
    """Counts frames that are stored from here on; call the result to read it and stop."""
    sidecar = addon_host.part("core.bake.sidecar").Sidecar
    store, seen = sidecar.store, []

    def noting(self, frame, *rest, **named):
        seen.append(frame)
        return store(self, frame, *rest, **named)

    def count():
        sidecar.store = store
        return len(seen)

    sidecar.store = noting
    return count


def test_a_bake_that_was_never_saved_is_taken_as_a_whole(tmp_path):
    path = tmp_path / "crash.blend"
    obj = saved_scatter(path)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    expected = packed(obj)
    obj = opened(path)  # after a crash the file has no keys
    assert obj.dapple.baked_keys == 0
    solves = counted_solves()
    obj.dapple.keyframe_step = 1
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert solves() == 0
    assert packed(obj) == expected


def test_other_settings_or_motion_solve_anew(tmp_path):
    obj = saved_scatter(tmp_path / "other.blend")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    obj.dapple.repulsion_weight = 1.0
    solves = counted_solves()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert solves() == FRAMES
    bpy.data.objects["Rig"].pose.bones["root"].scale = (1.0, 1.2, 1.0)
    solves = counted_solves()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert solves() == FRAMES


def test_work_files_go_when_the_bake_is_saved_and_only_then(tmp_path):
    path = tmp_path / "kept.blend"
    obj = saved_scatter(path)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    files = files_of(obj)
    assert files.frames() == FRAMES
    (files.folder / "notes.txt").write_text("not ours")
    bpy.ops.wm.save_mainfile()
    assert files.frames() == 0
    assert [item.name for item in files.folder.iterdir()] == ["notes.txt"]


def test_work_files_of_an_unfinished_bake_outlive_saving(tmp_path):
    obj = saved_scatter(tmp_path / "unfinished.blend")
    stop_after(3)
    assert files_of(obj).frames() == 3
    bpy.ops.wm.save_mainfile()
    assert files_of(obj).frames() == 3
    assert bpy.ops.dapple.discard_unfinished_bake() == {"FINISHED"}
    assert files_of(obj).frames() == 0
    assert not bpy.ops.dapple.discard_unfinished_bake.poll()


def stop_after(count):
    """Bake in steps and cancel after this number of frames; returns the message."""
    steps, baking = addon_host.part("core.base.steps"), addon_host.part("blender.bake.steps")
    files = files_of(bpy.context.object)
    stepper = steps.Stepper(baking.bake_steps(bpy.context, 1, FRAMES))
    try:
        while not stepper.poll(wait=5.0):
            if files.frames() >= count:
                stepper.cancel()
    except addon_host.part("core.base.errors").StoppedError as stopped:
        return str(stopped)
    finally:
        stepper.close()
    raise AssertionError("the bake was not stopped")


def test_canceling_says_what_is_kept_and_baking_goes_on(tmp_path):
    obj = saved_scatter(tmp_path / "canceled.blend")
    said = stop_after(2)
    kept = files_of(obj).frames()
    assert said.startswith(f"Canceled: the scatter is unchanged; {kept} solved frames are kept in")
    assert obj.dapple.baked_keys == 0
    solves = counted_solves()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert solves() == FRAMES - kept


def test_an_unsaved_file_keeps_its_frames_in_the_temporary_folder_and_says_so():
    obj = scenes.scattered(scenes.tail(frames=FRAMES))
    workfiles = addon_host.part("blender.freshness.unfinished_bakes")
    assert Path(bpy.app.tempdir) in files_of(obj).folder.parents
    assert "after Blender closes" in workfiles.unsaved_note()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert files_of(obj).frames() == FRAMES
    files_of(obj).clear()


def test_a_folder_that_cannot_be_written_does_not_stop_the_bake(tmp_path):
    obj = saved_scatter(tmp_path / "blocked.blend")
    (tmp_path / "blocked.dapple").write_text("a file where the folder should be")
    steps, baking = addon_host.part("core.base.steps"), addon_host.part("blender.bake.steps")
    baker = steps.run_now(baking.bake_steps(bpy.context, 1, FRAMES))
    assert baker.trouble.startswith(f"Frames cannot be kept in '{tmp_path}")
    assert obj.dapple.baked_frames == FRAMES


def stopped(path=None):
    """A scatter whose bake was stopped after three frames, in a saved file."""
    obj = scenes.scattered(scenes.tail(frames=FRAMES))
    if path is not None:
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
    stop_after(3)
    assert going_on(obj) == files_of(obj).frames() >= 3
    return obj


def going_on(obj):
    return addon_host.part("blender.freshness.unfinished_bakes").unfinished(obj)


def left_over(obj):
    return addon_host.part("blender.freshness.unfinished_bakes").left_over(obj)


def expect_to_go_on(obj, kept):
    """Bake solves only frames that are not stored."""
    assert (going_on(obj), left_over(obj)) == (kept, 0)
    solves = counted_solves()
    scenes.activate(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert solves() == FRAMES - kept


def expect_nothing_left(*folders):
    bpy.ops.wm.save_mainfile()
    for folder in folders:
        assert not list(folder.rglob("*.npz"))
        assert not list(folder.glob("*.dapple"))


def test_frames_of_a_file_that_was_never_saved_follow_when_it_is(tmp_path):
    obj = stopped()
    kept = going_on(obj)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "first.blend"))
    assert files_of(obj).folder.parent == tmp_path / "first.dapple"
    assert not list(Path(bpy.app.tempdir).rglob("*.npz"))
    expect_to_go_on(obj, kept)
    expect_nothing_left(tmp_path)


def test_frames_follow_when_the_file_is_saved_under_another_name(tmp_path):
    obj = stopped(tmp_path / "first.blend")
    kept = going_on(obj)
    (tmp_path / "elsewhere").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "elsewhere" / "second.blend"))
    assert not (tmp_path / "first.dapple").exists()
    expect_to_go_on(obj, kept)
    expect_nothing_left(tmp_path, tmp_path / "elsewhere")


def test_frames_stay_when_a_copy_of_the_file_is_saved(tmp_path):
    obj = stopped(tmp_path / "first.blend")
    kept = going_on(obj)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "copy.blend"), copy=True)
    assert not (tmp_path / "copy.dapple").exists()
    expect_to_go_on(obj, kept)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "copy.blend"), copy=True)
    assert files_of(obj).frames() == FRAMES  # the file does not contain the bake yet


def test_frames_follow_a_file_that_was_renamed_while_it_was_closed(tmp_path):
    kept = going_on(stopped(tmp_path / "first.blend"))
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    (tmp_path / "first.blend").rename(tmp_path / "renamed.blend")
    (tmp_path / "first.blend1").unlink(missing_ok=True)
    obj = opened(tmp_path / "renamed.blend")
    assert not (tmp_path / "first.dapple").exists()
    expect_to_go_on(obj, kept)
    expect_nothing_left(tmp_path)


def test_a_copied_file_does_not_take_the_frames_of_the_first_away(tmp_path):
    kept = going_on(stopped(tmp_path / "first.blend"))
    bpy.ops.wm.save_mainfile()
    shutil.copy(tmp_path / "first.blend", tmp_path / "copy.blend")
    obj = opened(tmp_path / "copy.blend")
    assert (going_on(obj), left_over(obj)) == (0, 0)
    expect_to_go_on(opened(tmp_path / "first.blend"), kept)


def test_frames_are_found_when_the_scatter_is_called_otherwise(tmp_path):
    obj = stopped(tmp_path / "first.blend")
    kept = going_on(obj)
    obj.name = "Scales/of: a newt"
    bpy.ops.wm.save_mainfile()
    expect_to_go_on(opened(tmp_path / "first.blend"), kept)
    expect_nothing_left(tmp_path)


def test_a_copy_of_the_scatter_has_work_files_of_its_own(tmp_path):
    obj = stopped(tmp_path / "first.blend")
    kept = going_on(obj)
    scenes.activate(obj)
    assert bpy.ops.object.duplicate() == {"FINISHED"}
    copy = bpy.context.object
    assert (going_on(copy), left_over(copy)) == (0, 0)
    solves = counted_solves()
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert solves() == FRAMES
    expect_to_go_on(obj, kept)
    assert files_of(copy).frames() == FRAMES
    expect_nothing_left(tmp_path)


def test_frames_of_a_deleted_scatter_go_with_it_when_the_file_is_saved(tmp_path):
    obj = stopped(tmp_path / "first.blend")
    (tmp_path / "first.dapple" / "mine-12345678").mkdir()
    (tmp_path / "first.dapple" / "mine-12345678" / "notes.txt").write_text("not ours")
    bpy.data.objects.remove(obj)
    bpy.ops.wm.save_mainfile()
    assert sorted(path.name for path in tmp_path.rglob("*.*") if path.is_file()) == [
        "first.blend",
        "first.blend1",
        "notes.txt",
    ]


@pytest.mark.parametrize("name", ["seed", "count", "repulsion_weight"])
def test_bake_is_not_said_to_go_on_with_other_settings(tmp_path, name):
    obj = stopped(tmp_path / "first.blend")
    kept, before = going_on(obj), getattr(obj.dapple, name)
    setattr(obj.dapple, name, before + 1)
    assert (going_on(obj), left_over(obj)) == (0, kept)
    setattr(obj.dapple, name, before)
    assert (going_on(obj), left_over(obj)) == (kept, 0)
    obj.dapple.smoothing = "LOOP"
    assert (going_on(obj), left_over(obj)) == (0, kept)


def test_bake_is_not_said_to_go_on_from_other_points_or_another_first_frame(tmp_path):
    obj = stopped(tmp_path / "first.blend")
    kept = going_on(obj)
    bpy.context.scene.frame_start = 2
    assert (going_on(obj), left_over(obj)) == (0, kept)
    bpy.context.scene.frame_start = 1
    assert (going_on(obj), left_over(obj)) == (kept, 0)
    bpy.context.scene.frame_set(4)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert (going_on(obj), left_over(obj)) == (0, kept)
    assert bpy.ops.dapple.discard_unfinished_bake() == {"FINISHED"}
    assert (going_on(obj), left_over(obj)) == (0, 0)
    assert not (tmp_path / "first.dapple").exists()


def test_two_settings_that_were_stopped_are_not_in_the_way_of_each_other(tmp_path):
    obj = stopped(tmp_path / "first.blend")
    first = going_on(obj)
    obj.dapple.repulsion_weight = 1.0
    stop_after(3)
    second = going_on(obj)
    assert (second >= 3, left_over(obj)) == (True, first)
    obj.dapple.repulsion_weight = 3.0
    assert (going_on(obj), left_over(obj)) == (first, second)


def test_an_unfinished_bake_is_not_said_to_go_on_after_clear_bake(tmp_path):
    obj = saved_scatter(tmp_path / "cleared.blend")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert (going_on(obj), left_over(obj)) == (0, 0)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert (going_on(obj), left_over(obj)) == (0, 0)
    assert not (tmp_path / "cleared.dapple").exists()


def test_a_stopped_bake_over_a_finished_one_is_said_to_go_on(tmp_path):
    obj = saved_scatter(tmp_path / "again.blend")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    obj.dapple.repulsion_weight = 1.0
    stop_after(3)
    kept = going_on(obj)
    assert kept >= 3
    bpy.ops.wm.save_mainfile()
    expect_to_go_on(obj, kept)


def test_a_scatter_that_took_the_place_of_another_is_baked(tmp_path):
    obj = saved_scatter(tmp_path / "replaced.blend")
    surface = obj.dapple.surface
    for count in (40, 50):
        assert going_on(obj) == 0, "what is known of the one is not of the next"
        assert bpy.ops.dapple.remove_scatter() == {"FINISHED"}
        bpy.context.view_layer.objects.active = surface
        assert bpy.ops.dapple.add_scatter(count=count) == {"FINISHED"}
        obj = bpy.context.object
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert bpy.ops.dapple.clear_bake() == {"FINISHED"}


def test_a_copy_by_a_script_has_work_files_of_its_own(tmp_path):
    obj = saved_scatter(tmp_path / "copied.blend")
    files_of(obj)
    cube = bpy.data.objects.new("Cube", None)
    files_of(obj)
    bpy.data.objects.remove(cube)
    copy = obj.copy()
    copy.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    assert files_of(copy).folder != files_of(obj).folder


def test_a_bake_begins_with_points_that_a_script_has_changed(tmp_path):
    obj = saved_scatter(tmp_path / "changed.blend")
    before = files_of(obj).folder
    ids = obj.data.attributes["id"].data
    ids[0].value, ids[1].value = ids[1].value, ids[0].value  # no update handler is called
    assert files_of(obj).folder != before


def test_the_panel_looks_at_the_disk_only_when_something_was_changed(tmp_path, monkeypatch):
    obj = stopped(tmp_path / "first.blend")
    kept = going_on(obj)
    workfiles = addon_host.part("blender.freshness.unfinished_bakes")
    for name in ("count_frames", "start_digest"):
        monkeypatch.setattr(workfiles, name, lambda *_: pytest.fail("it was looked up anew"))
    assert going_on(obj) == kept
