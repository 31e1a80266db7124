# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on a surface of any size, tile by tile."""

import os
from collections.abc import Iterator, Sequence
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _native as native
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

    Tiles are solved one by one; then the band along each border between two of them is solved
    again, between the points on both sides, which stay; then the corners where four meet. So there
    is memory for a tile and for what lies along a row of tiles, however large the surface is. Each
    tile is a file, whole or not at all. What a folder lacks is made; what is there stays, so a run
    that was stopped goes on where it was. A tile depends on its own part of the surface and on the
    tiles around it alone: removed and made again it has the same bytes.

    With `workers` or a `scheduler` the work is done by processes of Dask, on this machine or
    others; all see the folder, and the files of the surface, by the same path. What a lost worker
    was doing is done again. The bytes do not depend on how many there are.

    Args:
        surface: what is read piece by piece, or a file as open_surface() takes it.
        folder: for the tiles; made if it is missing.
        count: how many points in all, exactly.
        tile: about how many points a tile has; memory follows it.
        seed: another one gives other points.
        threads: of each solution; 0 is all there are, or 1 in a worker.
        workers: that many processes on this machine; 0 is one for each processor.
        scheduler: the address of one of Dask, or a client of it.
        progress: whether a line on stderr tells how far it is.
        context: for progress, and to cancel.
        options: those of `dapple3d.sample`, as `tolerance`.

    Raises:
        ValueError: the folder holds tiles of something else, or the surface has a fault: named by
            the tile.
        TypeError: the surface is none of these, an option is unknown, or a number is not whole.
        ImportError: for several processes, Dask distributed is missing.
        Cancelled
    """
    place = Folder(Path(folder).absolute())
    context = context or native.Context()
    _check_surface(surface)
    _check_options(count, tile, options)
    wanted = {"count": count, "tile": tile, "seed": seed, "options": options}
    with chosen_runner(scheduler, workers) as run:
        place.make()
        if isinstance(surface, str | os.PathLike):
            surface = open_surface(surface, place.surface)
        plan = _plan(surface, place, wanted, run, context.part(0.0, PLANNED))
        if scheduler is not None or workers is not None:
            threads = threads or 1
        work = Workplace(surface, plan, place, threads)
        _make_tiles(work, run, progress, context.part(PLANNED, 1.0))
    context.advance(1.0)
    return Tiles(place.path)


def _check_surface(surface: Any) -> None:
    if not isinstance(surface, str | os.PathLike | Tileable):
        raise TypeError(
            f"surface is a {type(surface).__name__}: a HeightField, a file or another Tileable "
            "is needed"
        )


def _check_options(count: int, tile: int, options: dict[str, Any]) -> None:
    known = {option.name for option in native.option_table("sample")} - {"seed", "threads"}
    for name in options:
        if name not in known:
            raise TypeError(f"sample_tiles() takes no option '{name}': {', '.join(sorted(known))}")
    numbers: dict[str, Any] = {"count": count, "tile": tile}
    for name, number in numbers.items():
        if not isinstance(number, Integral):
            raise TypeError(f"{name} is {number!r}: a whole number is needed")
    if count < 1:
        raise ValueError(f"count is {count}: 1 at least is needed")
    if tile < SMALLEST:
        raise ValueError(f"tile is {tile}: {SMALLEST} points at least are needed")


def _plan(
    surface: Tileable, folder: Folder, wanted: dict[str, Any], run: Runner, context: native.Context
) -> Plan:
    """That of the folder, or a new one, which is stored there."""
    if folder.plan.exists():
        plan = read_plan(folder.plan)
        _check_same(folder, plan, wanted | {"surface": surface.describe()})
        return plan
    plan = _new_plan(surface, wanted, run, context)
    plan.write(folder.plan)
    return plan


def _check_same(folder: Folder, plan: Plan, wanted: dict[str, Any]) -> None:
    there = plan.settings()
    for name, value in wanted.items():
        if there[name] != value:
            raise ValueError(
                f"{folder.path}: holds tiles with {name} {there[name]}, not {value}: remove it, or "
                "choose another folder"
            )


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
    counts = allot(np.array([c.mass for c in censuses]).reshape(layout.shape), count)
    layout = layout_for(lines, surface.axes, censuses, count)
    return Plan(layout, counts, wanted["seed"], wanted["options"], surface.describe(), tile)


def _census(shared: tuple[Tileable, Layout], job: Job, context: native.Context) -> Census:
    surface, layout = shared
    return census(patch_in(surface, layout.part(job)), surface.axes)


def _missing_jobs(plan: Plan, folder: Folder) -> list[Job]:
    """The work that is left, each after what it needs, tile by tile."""
    jobs: dict[Job, None] = {}
    for row, column in plan.layout.tiles():
        jobs |= dict.fromkeys(_missing(Job("tile", row, column), plan, folder))
    return list(jobs)


def _missing(job: Job, plan: Plan, folder: Folder) -> Iterator[Job]:
    if folder.has(job):
        return
    for needed in plan.layout.needs(job):
        yield from _missing(needed, plan, folder)
    yield job


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


def _make_tiles(place: Workplace, run: Runner, progress: bool, context: native.Context) -> None:
    plan = place.plan
    jobs = _missing_jobs(plan, place.folder)
    tasks = [Task(j.name, j, tuple(n.name for n in plan.layout.needs(j))) for j in jobs]
    leftovers = Leftovers(jobs, plan, place.folder)
    done = run(_do, place, tasks, context)
    for task, _ in shown(done, len(tasks), "tiles and seams") if progress else done:
        leftovers.done(task.argument)
    lacking = _missing_jobs(plan, place.folder)
    if lacking:
        raise OSError(
            f"{place.folder.file(lacking[-1])}: was written by a worker and is not here: all "
            "workers need to see the folder by the same path"
        )
    place.folder.sweep()


def _do(place: Workplace, job: Job, context: native.Context) -> None:
    place.do(job, context)
