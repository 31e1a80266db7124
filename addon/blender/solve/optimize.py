# SPDX-License-Identifier: GPL-3.0-or-later
"""Optimize as steps: read in parts, solve in a worker, check, write.

Scripts and the command line run all steps at once. auto_update.py runs them in a timer and discards
the work if something changes meanwhile.
"""

from dataclasses import dataclass, replace

import bpy

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.settings.values import Settings
from ...core.solve import incremental
from ...core.solve.locked import Locked
from ...core.solve.solve import Scattered, scatter
from ...core.solve.stale import changed_settings
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.sources import Sources, sources_of
from ..base.object_handles import ObjectHandle
from ..base.quiet import quiet
from ..freshness.concurrent_edits import check_points_kept, check_writable, points_now
from ..freshness.staleness import is_edited, needs_solving
from ..scatter.object import is_fluid, settings_of
from ..scatter.points import locked_points
from ..scatter.store import write_figures
from ..surface.current_binding import rest_of
from ..surface.joined_surface import surface_for
from ..surface.reading import check_faces, read_steps
from ..surface.rest_position import kind_of_binding, rest_position
from .session_solutions import previous_result, solved_arrays, write_solved

_RELAXED, _EVEN = 0.4, 0.9  # progress at the end of the first and the second task


def optimize_steps(
    handle: ObjectHandle, *, requested: bool = True, deletes_keyframes: bool = True
) -> Steps:
    """Solve a scatter; returns whether it was solved.

    A requested solution starts from the seed. It fails if the artist moves, locks or bakes the
    points meanwhile, or if the scatter has a bake that must not be deleted. An automatic solution
    runs only if the result is out of date and not edited by hand, and starts from the existing
    points if possible.
    """
    guard = _Guard(handle, deletes_keyframes) if requested else None
    settings = settings_of(handle.get())
    with surface_for(handle.get()) as surface:
        before = solved_arrays(handle.get())
        arrays = yield from read_steps(surface, settings, handle, before=before)
        sources = None
        if not requested:
            sources = yield Task(lambda _: sources_of(arrays, settings))
            if not _is_outdated(handle.get(), sources):
                return False
        check_faces(surface.get(), arrays)
        kind = _kind(handle.get(), surface.get(), arrays, requested)
        locked = locked_points(handle.get())
        update = Update(handle, surface, arrays, settings, kind, locked, sources)
        if not requested and _keeps(update):
            yield from _keep_steps(update)
        else:
            yield from _from_seed_steps(update, guard)
    return True


class _Guard:
    """Protects changes that the artist makes to the points during a requested solution."""

    def __init__(self, handle: ObjectHandle, deletes_keyframes: bool) -> None:
        self._scatter, self._deletes_keyframes = handle, deletes_keyframes
        self._before = points_now(handle.get())
        self._check_free()

    def check(self) -> None:
        """ScatterError if the points have changed."""
        self._check_free()
        check_points_kept(self._scatter.get(), self._before)

    def _check_free(self) -> None:
        obj = self._scatter.get()
        check_writable(obj)
        if obj.dapple.baked_keys and not self._deletes_keyframes:
            raise ScatterError(f"Scatter '{obj.name}' was baked meanwhile: nothing was written")


def _is_outdated(obj: bpy.types.Object, now: Sources) -> bool:
    """Whether the result of a scatter is out of date and not edited by hand.

    So is one whose figures were not measured, because an undo or a render came between.
    """
    return not is_edited(obj) and (not obj.dapple.report.measured or needs_solving(obj, now))


def _kind(
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays, requested: bool
) -> str:
    """Kind of binding, FACES or REST. The faces of the render are compared only if the faces have
    changed or the solution was requested.
    """
    known = obj.dapple.surface_topology.split()
    automatic = obj.dapple.attach_to == "AUTO" and not is_fluid(surface)
    if automatic and not requested and known == [arrays.topology]:
        return str(obj.dapple.attached_to)
    with quiet():  # a copy is evaluated in a temporary scene
        return kind_of_binding(surface, bpy.context, obj.dapple.attach_to)


@dataclass(frozen=True)
class Update:
    """A scatter that is to be solved, with its inputs."""

    scatter: ObjectHandle
    surface: ObjectHandle
    arrays: SurfaceArrays
    settings: Settings
    kind: str  # of the binding
    locked: Locked | None
    sources: Sources | None = None  # if they are known

    def write(self, solved: Scattered) -> None:
        """Store a result."""
        with rest_position(self.surface, self.kind):
            rest = rest_of(self.surface.get(), self.arrays, solved.binding, self.kind)
            write_solved(self.scatter.get(), self.arrays, solved, rest, self.sources)


def _from_seed_steps(update: Update, guard: _Guard | None) -> Steps:
    """Solve from the seed."""
    arrays, settings, locked = update.arrays, update.settings, update.locked
    solved = yield Task(lambda worker: scatter(arrays, settings, worker, locked))
    if guard is not None:
        guard.check()
    update.write(solved)


def _keep_steps(update: Update) -> Steps:
    """Solve from the existing points: first near changes, then with the right count, then the
    figures.
    """
    arrays, settings, locked = update.arrays, update.settings, update.locked
    before = previous_result(update.scatter.get())
    found: Scattered = yield Task(
        lambda worker: incremental.kept(before, arrays, settings, worker, locked), 0.0, _RELAXED
    )
    if not incremental.is_whole(found, before):
        count = found.report.count
        # Written with its actual count, so that it counts as out of date if this work is discarded.
        update.write(replace(found, settings=replace(settings, count=count)))
        local = found
        found = yield Task(
            lambda worker: incremental.evened(local, worker, locked), _RELAXED, _EVEN
        )
    update.write(found)
    written = found
    measured = yield Task(lambda worker: incremental.measured(written, worker), _EVEN)
    write_figures(update.scatter.get(), measured)


def _keeps(update: Update) -> bool:
    """Whether the points of a scatter should and can be kept."""
    obj = update.scatter.get()
    changed = changed_settings(obj.dapple.solved_settings, update.settings)
    same_faces = obj.dapple.surface_topology.split() == [update.arrays.topology]
    may_keep = "dapple_rank" in obj.data.attributes and obj.dapple.keep_points
    return bool(may_keep and incremental.keeps(update.settings, changed, same_faces))
