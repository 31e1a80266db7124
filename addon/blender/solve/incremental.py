# SPDX-License-Identifier: GPL-3.0-or-later
"""Solving a surface that was read, as steps: anew, or from the points that are there."""

from dataclasses import dataclass, replace
from typing import Any

from ...core.base.steps import Steps, Task
from ...core.settings.values import Settings
from ...core.solve import incremental
from ...core.solve.locked import Locked
from ...core.solve.solve import Scattered, scatter
from ...core.solve.stale import changed_settings
from ...core.surface.arrays import SurfaceArrays
from ..base.object_handles import Held
from ..scatter.store import write_figures
from ..surface.bound import rest_of
from ..surface.rest_position import rest_position
from .session_solutions import before_of, write_solved

_RELAXED, _EVEN = 0.4, 0.9  # of the progress


@dataclass(frozen=True)
class Update:
    """A scatter that is to be solved, and from what."""

    scatter: Held
    surface: Held
    arrays: SurfaceArrays
    settings: Settings
    kind: str  # of the binding
    locked: Locked | None

    def write(self, solved: Scattered) -> None:
        """Store a result."""
        with rest_position(self.surface, self.kind):
            rest = rest_of(self.surface.get(), self.arrays, solved.binding, self.kind)
            write_solved(self.scatter.get(), self.arrays, solved, rest)


def anew_steps(update: Update) -> Steps:
    """From the seed, as Optimize does."""
    update.write((yield from solved_anew(update)))


def solved_anew(update: Update) -> Any:
    """The same, without writing it."""
    arrays, settings, locked = update.arrays, update.settings, update.locked
    return (yield Task(lambda worker: scatter(arrays, settings, worker, locked)))


def keep_steps(update: Update) -> Steps:
    """From the points that are there: first where something has changed, then as many as there have
    to be, and at last the figures.
    """
    arrays, settings, locked = update.arrays, update.settings, update.locked
    before = before_of(update.scatter.get())
    found: Scattered = yield Task(
        lambda worker: incremental.kept(before, arrays, settings, worker, locked), 0.0, _RELAXED
    )
    if not incremental.is_whole(found, before):
        count = found.report.count
        update.write(replace(found, settings=replace(settings, count=count)))  # and so out of date
        local = found
        found = yield Task(
            lambda worker: incremental.evened(local, worker, locked), _RELAXED, _EVEN
        )
    update.write(found)
    written = found
    measured = yield Task(lambda worker: incremental.measured(written, worker), _EVEN)
    write_figures(update.scatter.get(), measured)


def keeps(update: Update) -> bool:
    """Whether the points of a scatter are to be kept, and can be."""
    obj = update.scatter.get()
    changed = changed_settings(obj.dapple.solved_settings, update.settings)
    same_faces = obj.dapple.surface_topology.split() == [update.arrays.topology]
    there = "dapple_rank" in obj.data.attributes and obj.dapple.keep_points
    return bool(there and incremental.keeps(update.settings, changed, same_faces))
