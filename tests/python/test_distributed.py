# SPDX-License-Identifier: GPL-3.0-or-later
"""Work by processes of Dask: a scheduler and workers, as on a farm."""

import os
import signal
import sys
import threading
import time
from functools import partial
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from dapple3d.extras.distributed import map_shots, sample_tiles, track_shot
from dapple3d.extras.distributed.shots import work_digest
from test_tiles import TILE, contents, hills

distributed = pytest.importorskip("distributed")
psutil = pytest.importorskip("psutil")

COUNT = 12_000  # points: six tiles


@pytest.fixture(scope="module")
def client():
    """A scheduler and two worker processes."""
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as own,
        distributed.Client(own) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """The tiles as this process makes them."""
    return sample_tiles(hills(100, 150), tmp_path_factory.mktemp("here"), COUNT, tile=TILE)


@pytest.fixture
def shots(tmp_path):
    """Motions of a torus, each bent another way."""
    vertices, faces = shapes.torus()
    paths = [tmp_path / f"shot_{k}.npz" for k in range(4)]
    for k, path in enumerate(paths):
        frames = [shapes.bent(vertices, 0.1 * k * time) for time in range(3)]
        np.savez(path, vertices=np.array(frames), faces=faces)
    return paths


def wait_for(there, seconds=600.0):
    """Look again and again."""
    end = time.monotonic() + seconds
    while not there():
        assert time.monotonic() < end
        time.sleep(0.01)


def kill_worker(client):
    """End a worker as a machine does that fails.

    Returns:
        its name, which another one that takes its place does not have.
    """
    address, pid = next(iter(client.run(os.getpid).items()))
    os.kill(pid, signal.SIGKILL)
    return address


def killed_in_the_middle(client, folder: Path, call):
    """The result of a call, one of whose workers is killed once there is a file in the folder."""
    results = []
    thread = threading.Thread(target=lambda: results.append(call()))
    thread.start()
    wait_for(lambda: folder.is_dir() and any(folder.glob("[!.]*.npz")))
    assert thread.is_alive()
    killed = kill_worker(client)
    thread.join()
    wait_for(lambda: len(client.scheduler_info()["workers"]) == 2)
    assert killed not in client.scheduler_info()["workers"]
    return results[0]


def test_tiles_of_workers_have_the_bytes_of_those_made_here(client, here, tmp_path):
    address = client.scheduler.address
    sample_tiles(hills(100, 150), tmp_path, COUNT, tile=TILE, scheduler=address)
    assert contents(tmp_path) == contents(here.folder)
    assert not (tmp_path / "work").exists()


def test_a_worker_that_is_killed_changes_no_byte_of_the_tiles(client, here, tmp_path):
    make = partial(sample_tiles, hills(100, 150), tmp_path, COUNT, tile=TILE, scheduler=client)
    assert len(killed_in_the_middle(client, tmp_path / "work", make)) == COUNT
    assert not (tmp_path / "work").exists()
    assert contents(tmp_path) == contents(here.folder)


def test_shots_are_each_a_file(client, shots, tmp_path):
    files = map_shots(partial(track_shot, count=300), shots, tmp_path / "out", scheduler=client)
    assert [file.name for file in files] == [shot.name for shot in shots]
    for shot, file in zip(shots, files, strict=True):
        with np.load(file) as found:
            for name, values in track_shot(shot, 300).items():
                assert np.array_equal(found[name], values)


def times(files):
    return [file.stat().st_mtime_ns for file in files]


def test_a_shot_that_is_there_is_left_as_it_is(client, shots, tmp_path):
    work = partial(track_shot, count=300)
    files = map_shots(work, shots[:2], tmp_path / "out", scheduler=client)
    written = times(files)
    files[1].unlink()
    map_shots(partial(track_shot, count=300), shots[:2], tmp_path / "out", scheduler=client)
    assert times(files)[0] == written[0]
    assert np.load(files[1])["positions"].shape == (3, 300, 3)


def test_a_shot_that_has_changed_is_done_again(client, shots, tmp_path):
    work = partial(track_shot, count=300)
    files = map_shots(work, shots[:2], tmp_path / "out", scheduler=client)
    written = times(files)
    shots[0].write_bytes(shots[3].read_bytes())
    map_shots(work, shots[:2], tmp_path / "out", scheduler=client)
    assert times(files)[0] != written[0]
    assert times(files)[1] == written[1]
    last = track_shot(shots[3], 300)
    assert np.array_equal(np.load(files[0])["positions"], last["positions"])


@pytest.mark.parametrize("content", [b"", b"no archive", None], ids=["empty", "text", "cut off"])
def test_a_result_that_is_damaged_is_made_again(client, shots, tmp_path, content):
    work = partial(track_shot, count=300)
    (file,) = map_shots(work, shots[:1], tmp_path / "out", scheduler=client)
    before = file.read_bytes()
    file.write_bytes(before[:-500] if content is None else content)
    map_shots(work, shots[:1], tmp_path / "out", scheduler=client)
    assert file.read_bytes() == before


def test_results_of_other_shots_and_other_work_are_made_again(client, shots, tmp_path):
    work = partial(track_shot, count=300)
    files = map_shots(work, shots[:2], tmp_path / "out", scheduler=client)
    before = [file.read_bytes() for file in files]
    files[0].write_bytes(before[1])
    map_shots(work, shots[:2], tmp_path / "out", scheduler=client)
    assert [file.read_bytes() for file in files] == before
    map_shots(partial(track_shot, count=200), shots[:2], tmp_path / "out", scheduler=client)
    assert np.load(files[0])["positions"].shape == (3, 200, 3)


def test_an_npz_that_is_no_result_is_not_replaced(client, shots, tmp_path):
    np.savez(tmp_path / "shot_1.npz.npz", kept=np.ones(3))
    (tmp_path / "out").mkdir()
    kept = (tmp_path / "shot_1.npz.npz").rename(tmp_path / "out" / "shot_1.npz")
    with pytest.raises(ValueError, match=r"out/shot_1\.npz: is no result of map_shots\(\)"):
        map_shots(partial(track_shot, count=300), shots, tmp_path / "out", scheduler=client)
    assert np.load(kept)["kept"].tolist() == [1, 1, 1]


def test_digests_of_work_tell_arguments_and_functions_apart():
    assert work_digest(partial(track_shot, count=3)) == work_digest(partial(track_shot, count=3))
    works = [track_shot, memory_setting, partial(track_shot, count=3), partial(track_shot, 3)]
    works += [partial(track_shot, count=4), partial(track_shot, seed=3), lambda _: {}]
    assert len({work_digest(work) for work in works}) == len(works)


def test_a_worker_that_is_killed_costs_no_shot(client, shots, tmp_path):
    work = partial(track_shot, count=3_000)
    make = partial(map_shots, work, shots, tmp_path / "out", scheduler=client)
    files = killed_in_the_middle(client, tmp_path / "out", make)
    map_shots(work, shots, tmp_path / "again", scheduler=client)
    for file in files:
        assert file.read_bytes() == (tmp_path / "again" / file.name).read_bytes()


def test_a_wrong_shot_is_named(client, shots, tmp_path):
    np.savez(shots[2], vertices=np.zeros((5, 3)), faces=np.zeros((1, 3), int))
    with pytest.raises(ValueError, match=r"shot_2\.npz: 'vertices' has the shape \(5, 3\)"):
        map_shots(partial(track_shot, count=300), shots, tmp_path / "out", scheduler=client)


def test_two_shots_of_one_name_are_refused(shots, tmp_path):
    with pytest.raises(ValueError, match=r"would be written to shot_0\.npz"):
        map_shots(track_shot, [shots[0], tmp_path / "other" / "shot_0.npz"], tmp_path / "out")


def test_a_folder_where_a_result_would_replace_a_shot_is_refused(shots, tmp_path):
    with pytest.raises(
        ValueError, match=r"shot_0\.npz: is a shot, and its result would replace it"
    ):
        map_shots(track_shot, shots, tmp_path)


def test_workers_stop_when_the_work_is_cancelled(client, tmp_path):
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        sample_tiles(hills(100, 150), tmp_path, COUNT, tile=TILE, scheduler=client, context=context)
    wait_for(lambda: not any(client.processing().values()))


def test_a_line_tells_how_far_it_is(client, shots, tmp_path, capsys):
    work = partial(track_shot, count=300)
    map_shots(work, shots[:2], tmp_path / "out", scheduler=client, progress=True)
    assert capsys.readouterr().err.endswith("\rshots: 1 of 2\rshots: 2 of 2\n")


def test_what_is_missing_is_said_where_dask_is_missing(monkeypatch, shots, tmp_path):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ImportError, match=r"needs distributed.*dapple3d\[farm\]"):
        map_shots(track_shot, shots, tmp_path / "out")


def test_a_cluster_of_its_own_is_started_and_ended(monkeypatch, shots, tmp_path):
    # Dask stores options of an earlier cluster there.
    monkeypatch.delenv("MALLOC_TRIM_THRESHOLD_", raising=False)
    (file,) = map_shots(memory_setting, shots[:1], tmp_path / "out", workers=1)
    found = np.load(file)
    assert found["setting"] == "not set"  # workers keep memory for reuse
    wait_for(lambda: not psutil.pid_exists(int(found["process"])))


def memory_setting(shot):
    """What a worker was told of memory that it does not use."""
    setting = os.environ.get("MALLOC_TRIM_THRESHOLD_", "not set")
    return {"setting": np.array(setting), "process": np.array(os.getpid())}
