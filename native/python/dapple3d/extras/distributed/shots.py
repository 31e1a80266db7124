# SPDX-License-Identifier: GPL-3.0-or-later
"""The same work for many shots, each into a file of its own."""

import inspect
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import _native as native
from ...reading import read_npz
from .digests import is_foreign, is_there, of_file, of_text, write_checked
from .running import Task, connected, runner_on, shown

if TYPE_CHECKING:
    from distributed import Client

TIMES = ("seconds", "profile")  # entries of a report that differ from run to run
Shot = str | os.PathLike[str]
Work = Callable[[Path], Mapping[str, ArrayLike]]


def map_shots(
    work: Work,
    shots: Iterable[Shot],
    folder: str | os.PathLike[str],
    *,
    workers: int = 0,
    scheduler: "str | Client | None" = None,
    progress: bool = False,
    context: native.Context | None = None,
) -> list[Path]:
    """Have processes of Dask do the same work for many shots, one file for each.

    The tasks of a lost worker are repeated. A shot is skipped if its file is complete and from the
    same shot and work, so a run that was stopped continues. Shots are compared by all of their
    bytes, work by its name, source and arguments, without the functions that it calls.

    Args:
        work: called with the path of a shot; the arrays that it returns, by name, are written as
            npz. It is sent to the workers by pickle: a function of a module, or a
            `functools.partial` of one, as of track_shot().
        shots: files; no two of the same name.
        folder: for the results, `NAME.npz` for the shot `NAME.*`; made if it is missing.
        workers: number of processes on this machine; 0: one for each processor.
        scheduler: the address of one of Dask, or a client of it: its workers see the shots and the
            folder by the same paths.
        progress: whether a line on stderr shows the progress.
        context: for progress, and to cancel.

    Returns:
        the file of each shot.

    Raises:
        ValueError: two shots of the same name, a result that would replace a shot or a file that is
            no result, or an error of the work; the file is named.
        ImportError: Dask distributed is missing.
        Cancelled
    """
    place = Path(folder).absolute()
    paths = [Path(shot).absolute() for shot in shots]
    files = _result_files(paths, place)
    place.mkdir(parents=True, exist_ok=True)
    context = context or native.Context()
    with connected(scheduler, workers) as client:
        key = work_digest(work)
        pairs = zip(paths, files, strict=True)
        tasks = [Task(path.stem, (path, file)) for path, file in pairs if not _has(path, file, key)]
        done = runner_on(client)(_do, (work, key), tasks, context)
        for _ in shown(done, len(tasks), "shots") if progress else done:
            pass
    context.advance(1.0)
    return files


def _result_files(shots: Sequence[Path], folder: Path) -> list[Path]:
    named: dict[str, Path] = {}
    for shot in shots:
        if shot.stem in named:
            raise ValueError(
                f"{shot}: has the name of {named[shot.stem]}, so both would be written to "
                f"{shot.stem}.npz"
            )
        named[shot.stem] = shot
    files = [folder / f"{name}.npz" for name in named]
    for file in files:
        if file in shots:
            raise ValueError(f"{file}: is a shot, and its result would replace it")
    return files


def work_digest(work: Any) -> str:
    """Digest of the name, the source and the arguments of a function."""
    from distributed.protocol.pickle import dumps  # as it is sent to the workers

    if isinstance(work, partial):
        arguments = [*map(work_digest, work.args), *(map(work_digest, work.keywords.items()))]
        return of_text(work_digest(work.func), *arguments)
    try:
        source = inspect.getsource(work)
    except (OSError, TypeError):
        source = ""
    return of_text(source, bytes(dumps(work)).hex())


def _has(shot: Path, file: Path, work: str) -> bool:
    """Whether the result of a shot is there.

    Raises:
        ValueError: there is an npz of somebody else in its place.
    """
    if not file.exists():
        return False
    if is_foreign(file):
        raise ValueError(f"{file}: is no result of map_shots(), and one would replace it")
    return is_there(file, of_text(work, of_file(shot)))


def _do(shared: tuple[Work, str], shot: tuple[Path, Path], context: native.Context) -> None:
    work, key = shared
    path, out = shot
    if _has(path, out, key):  # written by a worker that was believed lost
        return
    shot_key = of_text(key, of_file(path))
    try:
        arrays = work(path)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    write_checked(out, arrays, shot_key)


def track_shot(
    path: Path, count: int, *, seed: int = 0, threads: int = 1, **options: Any
) -> dict[str, NDArray]:
    """Points that stay put on a motion, as `dapple track` makes them.

    >>> map_shots(partial(track_shot, count=2000), sorted(Path("shots").glob("*.npz")), "baked")

    Args:
        path: an npz of 'vertices' (frames, v, 3) and 'faces' (m, 3).
        count: how many points.
        seed: of those on the first frame.
        threads: of each solution.
        options: those of `dapple3d.Tracker`.
    """
    motion = read_npz(path)
    frames, faces = motion["vertices"], motion["faces"]
    if frames.ndim != 3:
        raise ValueError(f"'vertices' has the shape {frames.shape}: (frames, v, 3) is needed")
    surface = native.Surface(frames[0], faces)
    results = [native.sample(surface, count, seed=seed, threads=threads)]
    tracker = native.Tracker(surface, results[0], threads=threads, **options)
    results += [tracker.advance(frame) for frame in frames[1:]]
    return motion_arrays(results)


def motion_arrays(results: Sequence[native.Samples]) -> dict[str, NDArray]:
    """The samples of all frames; without the time they took, the same bytes each time."""
    stacked = {
        name: np.stack([getattr(samples, name) for samples in results])
        for name in ("positions", "normals", "faces", "barycentric")
    }
    last = {"ids": results[0].ids, "classes": results[0].classes}
    return stacked | last | {"reports": _reports(results)}


def changing_arrays(results: Sequence[native.Samples]) -> dict[str, NDArray]:
    """The same where samples appear and vanish: arrays of all frames, joined.

    Those of frame k are the rows starts[k] to starts[k + 1].
    """
    names = ("positions", "normals", "faces", "barycentric", "ids", "classes", "fade")
    joined = {
        name: np.concatenate([getattr(samples, name) for samples in results]) for name in names
    }
    starts = np.cumsum([0, *(len(samples) for samples in results)])
    return {"starts": starts} | joined | {"reports": _reports(results)}


def _reports(results: Sequence[native.Samples]) -> NDArray:
    reports = [samples.report.to_dict() for samples in results]
    texts = [json.dumps({k: v for k, v in report.items() if k not in TIMES}) for report in reports]
    return np.array(texts)
