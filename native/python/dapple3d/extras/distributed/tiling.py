# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on a surface of any size, tile by tile."""

import os
from collections.abc import Sequence
from dataclasses import replace
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import _native as native
from .digests import plain
from .files import open_surface
from .layout import Job, Layout
from .patches import Census, Tileable, census
from .plan import Plan, allot, layout_for, read_plan, shape_for
from .results import Folder, Tiles
from .running import Runner, Task, chosen_runner, shown
from .work import Workplace, patch_in

if TYPE_CHECKING:
    from distributed import Client

FACES = 4  # that a tile may have for each of its points
SMALLEST = 2_000  # points of a tile: fewer, and zones along its borders would meet
PLANNED = 0.02  # of the progress
TRIED = np.eye(3), [[0, 1, 2]]  # a surface on which options are tried


def sample_tiles(
    surface: Tileable | str | os.PathLike[str],
    folder: str | os.PathLike[str],
    count: int,
    *,
    tile: int = 100_000,
    seed: int = 0,
    threads: int = 0,
    workers: int | None = None,
    scheduler: "str | Client | None" = None,
    progress: bool = False,
    context: native.Context | None = None,
    **options: Any,
) -> Tiles:
    """Put `count` points on a surface that is too large to be solved at once.

    Tiles are solved one by one; then the band along each border between two tiles is solved again,
    between the points on both sides, which stay; then the corners where four tiles meet. So memory
    holds one tile and a row of borders, however large the surface is. Each tile is a file, complete
    or not written. Files that the folder has are kept and missing ones are made, so a run that was
    stopped continues. A tile depends only on its own part of the surface and on the tiles around
    it: removed and made again it has the same bytes.

    With `workers` or a `scheduler` the work is done by processes of Dask, on this machine or
    others; all need the folder, and the files of the surface, at the same path. The tasks of a lost
    worker are repeated. The bytes do not depend on the number of workers.

    Args:
        surface: a surface that is read piece by piece, or a file as for open_surface().
        folder: for the tiles; made if it is missing.
        count: exact number of points.
        tile: approximate number of points of a tile; memory is proportional to it.
        seed: each seed gives other points.
        threads: of each solution; 0: all of the machine, or 1 in a worker.
        workers: number of processes on this machine; 0: one for each processor.
        scheduler: the address of a scheduler of Dask, or a client of one.
        progress: whether a line on stderr shows the progress.
        context: for progress, and to cancel.
        options: those of `dapple3d.sample`, as `tolerance`.

    Raises:
        ValueError: the folder holds tiles of another run, its plan is damaged, an option is out of
            range, or the surface has a fault, named with its tile.
        TypeError: the surface has another type, an option is unknown, or a number is not an
            integer.
        ImportError: for several processes, Dask distributed is missing.
        Cancelled
    """
    place = Folder(Path(folder).absolute())
    context = context or native.Context()
    _check_surface(surface)
    wanted = _checked_options(count, tile, seed, options)
    with chosen_runner(scheduler, workers) as run:
        place.make()
        if isinstance(surface, str | os.PathLike):
            surface = open_surface(surface, place.surface)
        plan = _plan(surface, place, wanted, run, context.part(0.0, PLANNED))
        place = replace(place, run=plan.digest)
        place.check_tiles(plan)
        if scheduler is not None or workers is not None:
            threads = threads or 1
        work = Workplace(surface, plan, place, threads)
        made_again = _make_tiles(work, run, progress, context.part(PLANNED, 1.0))
    context.advance(1.0)
    return Tiles(place.path, made_again)


def _check_surface(surface: Any) -> None:
    if not isinstance(surface, str | os.PathLike | Tileable):
        raise TypeError(
            f"surface is a {type(surface).__name__}: a HeightField, a file or another Tileable "
            "is needed"
        )


def _checked_options(count: int, tile: int, seed: int, options: dict[str, Any]) -> dict[str, Any]:
    """All of them, as JSON holds them."""
    table = {option.name: option for option in native.option_table("sample")}
    known = set(table) - {"seed", "threads"}
    for name in options:
        if name not in known:
            raise TypeError(f"sample_tiles() takes no option '{name}': {', '.join(sorted(known))}")
    numbers: dict[str, Any] = {"count": count, "tile": tile, "seed": seed}
    for name, number in numbers.items():
        if not isinstance(number, Integral):
            raise TypeError(f"{name} is {number!r}: a whole number is needed")
    if count < 1:
        raise ValueError(f"count is {count}: 1 at least is needed")
    if tile < SMALLEST:
        raise ValueError(f"tile is {tile}: {SMALLEST} points at least are needed")
    native.sample(native.Surface(*TRIED), 1, seed=seed, **options)  # raises if an option is wrong
    return {name: int(number) for name, number in numbers.items()} | {"options": plain(options)}


def _plan(
    surface: Tileable, folder: Folder, wanted: dict[str, Any], run: Runner, context: native.Context
) -> Plan:
    """That of the folder, or a new one, which is stored there."""
    wanted = wanted | {"surface": plain(surface.describe())}
    if not folder.plan.exists():
        plan = _new_plan(surface, wanted, run, context)
        plan.write(folder.plan)
        return plan
    plan = read_plan(folder.plan)
    differing = _differing(plan.settings(), wanted)
    if differing is None and "content" not in wanted["surface"]:
        differing = _differing_patch(plan, surface, run, context)
    if differing is not None:
        raise ValueError(
            f"{folder.path}: holds tiles with {differing}: remove it, or choose another folder"
        )
    return plan


def _differing(there: dict[str, Any], wanted: dict[str, Any]) -> str | None:
    """In words, what first tells two runs from each other."""
    for name in ("count", "seed", "tile"):
        if there[name] != wanted[name]:
            return f"{name} {there[name]}, not {wanted[name]}"
    defaults = {option.name: option.default for option in native.option_table("sample")}
    before, now = (defaults | options for options in (there["options"], wanted["options"]))
    for name in sorted({*before, *now}):
        if before.get(name) != now.get(name):
            return f"{name} {before.get(name)}, not {now.get(name)}"
    return _differing_surface(there["surface"], wanted["surface"])


def _differing_surface(there: dict[str, Any], wanted: dict[str, Any]) -> str | None:
    """The first entry that differs; the name may, and digests say where the contents do."""
    for name in dict.fromkeys([*there, *wanted]):
        if name in ("name", "content") or there.get(name) == wanted.get(name):
            continue
        return f"surface {name} {there.get(name)}, not {wanted.get(name)}"
    before, now = there.get("content", {}), wanted.get("content", {})
    for name in dict.fromkeys([*before, *now]):
        if before.get(name) != now.get(name):
            return f"surface {name} of other numbers{_rows_of(before.get(name), now.get(name))}"
    return None


def _rows_of(there: Any, wanted: Any) -> str:
    """Which rows of a grid differ first."""
    if not isinstance(there, dict) or not isinstance(wanted, dict):
        return ""
    first = next((rows for rows in wanted if there.get(rows) != wanted[rows]), None)
    return f" in the rows {first}" if first else ""


def _differing_patch(
    plan: Plan, surface: Tileable, run: Runner, context: native.Context
) -> str | None:
    """The first tile whose part of the surface is another one."""
    jobs = [Job("first", row, column) for row, column in plan.layout.tiles()]
    tasks = [Task(f"patch-{job.name}", job) for job in jobs]
    found = {
        task.argument: result
        for task, result in run(_digest, (surface, plan.layout), tasks, context)
    }
    differing = next((job for job in jobs if found[job] != plan.patch_of(job)), None)
    return None if differing is None else f"another surface at {differing.place}"


def _digest(shared: tuple[Tileable, Layout], job: Job, _: native.Context) -> str:
    surface, layout = shared
    return patch_in(surface, layout.part(job)).digest()


def _new_plan(
    surface: Tileable, wanted: dict[str, Any], run: Runner, context: native.Context
) -> Plan:
    count, tile = wanted["count"], wanted["tile"]
    rows, columns = surface.lines(1, 1)
    tiles = max(count / tile, surface.face_count / (FACES * tile))
    lengths = (float(rows[-1] - rows[0]), float(columns[-1] - columns[0]))
    lines = surface.lines(*shape_for(tiles, lengths))
    layout = Layout(*lines, 0.0, surface.axes)
    jobs = [Job("first", row, column) for row, column in layout.tiles()]
    tasks = [Task(f"census-{job.name}", job) for job in jobs]
    found = {
        task.argument: result for task, result in run(_census, (surface, layout), tasks, context)
    }
    censuses = [found[job] for job in jobs]
    counts = allot(np.array([c.capacity for c in censuses]).reshape(layout.shape), count)
    layout = layout_for(lines, surface.axes, censuses, count)
    kept = {name: wanted[name] for name in ("seed", "options", "surface", "tile")}
    return Plan(layout, counts, **kept, patches=[c.digest for c in censuses])


def _census(shared: tuple[Tileable, Layout], job: Job, context: native.Context) -> Census:
    surface, layout = shared
    return census(patch_in(surface, layout.part(job)), surface.axes)


class Missing:
    """The work that is left of a plan, each after what it needs, tile by tile."""

    def __init__(self, plan: Plan, folder: Folder) -> None:
        self._plan, self._folder = plan, folder
        self._there: dict[Job, bool] = {}
        self._jobs: dict[Job, None] = {}
        for row, column in plan.layout.tiles():
            self._visit(Job("tile", row, column))

    @property
    def jobs(self) -> list[Job]:
        """In the order in which they can be done."""
        return list(self._jobs)

    @property
    def damaged(self) -> tuple[Path, ...]:
        """Files that are there, but are not what they should be."""
        files = (self._folder.file(job) for job, there in self._there.items() if not there)
        return tuple(sorted(file for file in files if file.exists()))

    def _visit(self, job: Job) -> None:
        if job not in self._there:
            self._there[job] = self._folder.has(job)
        if self._there[job] or job in self._jobs:
            return
        for needed in self._plan.layout.needs(job):
            self._visit(needed)
        self._jobs[job] = None


class Leftovers:
    """Results that are removed as soon as no work that is left needs them."""

    def __init__(self, jobs: Sequence[Job], plan: Plan, folder: Folder) -> None:
        self._plan, self._folder = plan, folder
        self._users: dict[Job, int] = {}
        for job in jobs:
            for needed in plan.layout.needs(job):
                self._users[needed] = self._users.get(needed, 0) + 1

    def done(self, job: Job) -> None:
        """Say that a job is done."""
        for needed in self._plan.layout.needs(job):
            self._users[needed] -= 1
            if self._users[needed] == 0:
                self._folder.drop(needed)


def _make_tiles(
    place: Workplace, run: Runner, progress: bool, context: native.Context
) -> tuple[Path, ...]:
    """Do the work that is left.

    Returns:
        the files that were damaged.
    """
    plan = place.plan
    missing = Missing(plan, place.folder)
    jobs, damaged = missing.jobs, missing.damaged
    tasks = [Task(j.name, j, tuple(n.name for n in plan.layout.needs(j))) for j in jobs]
    leftovers = Leftovers(jobs, plan, place.folder)
    done = run(_do, place, tasks, context)
    for task, _ in shown(done, len(tasks), "tiles and seams") if progress else done:
        leftovers.done(task.argument)
    files = [place.folder.file(Job("tile", row, column)) for row, column in plan.layout.tiles()]
    lacking = next((file for file in files if not file.exists()), None)
    if lacking:
        raise OSError(
            f"{lacking}: was written by a worker and is not here: all workers need to see the "
            "folder by the same path"
        )
    place.folder.sweep()
    return damaged


def _do(place: Workplace, job: Job, context: native.Context) -> None:
    place.do(job, context)
