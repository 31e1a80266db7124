# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on a surface of any size, tile by tile."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .. import _native as native
from .layout import Job, Layout
from .patches import Tileable, census
from .plan import Plan, allot, layout_for, read_plan, shape_for
from .results import Folder, Tiles
from .work import Workplace, patch_in

FACES = 4  # that a tile may have for each of its points
SMALLEST = 2_000  # points of a tile: fewer, and zones along its borders would meet
PLANNED = 0.02  # of the progress


def sample_tiles(
    surface: Tileable,
    folder: str | os.PathLike[str],
    count: int,
    *,
    tile: int = 100_000,
    seed: int = 0,
    threads: int = 0,
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

    Args:
        surface: what is read piece by piece.
        folder: for the tiles; made if it is missing.
        count: how many points in all, exactly.
        tile: about how many points a tile has; memory follows it.
        seed: another one gives other points.
        threads: of each solution; 0 is all there are.
        context: for progress, and to cancel.
        options: those of `dapple3d.sample`, as `tolerance`.

    Raises:
        ValueError: the folder holds tiles of something else, or the surface has a fault: named by
            the tile.
        Cancelled
    """
    place = Folder(Path(folder))
    context = context or native.Context()
    _check_options(count, tile, options)
    place.make()
    plan = _plan(surface, place, {"count": count, "tile": tile, "seed": seed, "options": options},
                 context.part(0.0, PLANNED))  # fmt: skip
    _run_here(Workplace(surface, plan, place, threads), context.part(PLANNED, 1.0))
    context.advance(1.0)
    return Tiles(place.path)


def _check_options(count: int, tile: int, options: dict[str, Any]) -> None:
    known = {option.name for option in native.option_table("sample")} - {"seed", "threads"}
    for name in options:
        if name not in known:
            raise TypeError(f"sample_tiles() takes no option '{name}': {', '.join(sorted(known))}")
    if count < 1:
        raise ValueError(f"count is {count}: 1 at least is needed")
    if tile < SMALLEST:
        raise ValueError(f"tile is {tile}: {SMALLEST} points at least are needed")


def _plan(
    surface: Tileable, folder: Folder, wanted: dict[str, Any], context: native.Context
) -> Plan:
    """That of the folder, or a new one, which is stored there."""
    if folder.plan.exists():
        plan = read_plan(folder.plan)
        _check_same(folder, plan, wanted | {"surface": surface.describe()})
        return plan
    plan = _new_plan(surface, wanted, context)
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


def _new_plan(surface: Tileable, wanted: dict[str, Any], context: native.Context) -> Plan:
    count, tile = wanted["count"], wanted["tile"]
    rows, columns = surface.lines(1, 1)
    tiles = max(count / tile, surface.face_count / (FACES * tile))
    lengths = (float(rows[-1] - rows[0]), float(columns[-1] - columns[0]))
    lines = surface.lines(*shape_for(tiles, lengths))
    layout = Layout(*lines, 0.0, surface.axes)
    found = []
    for k, (row, column) in enumerate(layout.tiles()):
        context.check()
        patch = patch_in(surface, layout.part(Job("first", row, column)))
        found.append(census(patch, surface.axes))
        context.advance((k + 1) / (layout.shape[0] * layout.shape[1]))
    counts = allot(np.array([c.mass for c in found]).reshape(layout.shape), count)
    return Plan(layout_for(lines, surface.axes, found, count), counts,
                wanted["seed"], wanted["options"], surface.describe(), tile)  # fmt: skip


def missing_jobs(plan: Plan, folder: Folder) -> Iterator[Job]:
    """The work that is left, each after what it needs, tile by tile."""
    seen: set[Job] = set()
    for row, column in plan.layout.tiles():
        yield from _missing(Job("tile", row, column), plan, folder, seen)


def _missing(job: Job, plan: Plan, folder: Folder, seen: set[Job]) -> Iterator[Job]:
    if job in seen or folder.has(job):
        return
    seen.add(job)
    for needed in plan.layout.needs(job):
        yield from _missing(needed, plan, folder, seen)
    yield job


class Leftovers:
    """Results that are removed as soon as no missing work needs them."""

    def __init__(self, jobs: list[Job], plan: Plan, folder: Folder) -> None:
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


def _run_here(place: Workplace, context: native.Context) -> None:
    jobs = list(missing_jobs(place.plan, place.folder))
    leftovers = Leftovers(jobs, place.plan, place.folder)
    for k, job in enumerate(jobs):
        context.check()
        place.do(job, context.part(k / len(jobs), (k + 1) / len(jobs)))
        leftovers.done(job)
