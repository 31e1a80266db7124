# SPDX-License-Identifier: GPL-3.0-or-later
"""One piece of work on tiles: from files and a part of the surface to a file."""

from dataclasses import dataclass

from ... import _native as native
from .layout import TOUCH, Job, Zone
from .patches import Patch, Tileable
from .plan import Plan
from .results import NO_POINTS, Bound, Folder, TilePoints, merged
from .solving import Solver


@dataclass(frozen=True)
class Workplace:
    """All that work needs to know. Workers get a copy by pickle."""

    surface: Tileable
    plan: Plan
    folder: Folder
    threads: int = 0

    def do(self, job: Job, context: native.Context) -> None:
        """Have the result of a job in the folder; what it needs is there.

        Raises:
            Cancelled, or ValueError that names the tile.
        """
        if self.folder.has(job):
            return
        try:
            self.folder.write(job, self._result(job, context))
        except ValueError as error:
            raise ValueError(f"{job.place}: {error}") from error

    def _result(self, job: Job, context: native.Context) -> Bound | TilePoints:
        layout = self.plan.layout
        patch = patch_in(self.surface, layout.part(job))
        if job.kind == "first" and patch.digest() != self.plan.patch_of(job):
            raise ValueError("the surface has changed since the run began")
        there = merged([self.folder.read(needed) for needed in layout.needs(job)])
        there = there.only(patch.find(there.faces) >= 0)
        if job.kind == "tile":
            return finished(patch, there)
        solver = Solver(self.plan.options, self.plan.seed_of(job), self.threads, context)
        if job.kind == "first":
            ids = self.plan.ids(job)
            return solver.alone(patch, ids) if len(ids) else NO_POINTS
        return self._between(job, patch, there, solver)

    def _between(self, job: Job, patch: Patch, there: Bound, solver: Solver) -> Bound:
        """New points along a seam or around a corner."""
        layout = self.plan.layout
        fresh, free = layout.fresh(job), layout.free(job)
        faces = patch.find(there.faces)
        new, moving = (zone.holds(patch, layout.axes)[faces] for zone in (fresh, free))
        start = there
        if new.any():
            rim = patch.only(fresh.grown(TOUCH * layout.unit).holds(patch, layout.axes))
            dark = ~fresh.holds(rim, layout.axes)
            thrown = solver.thrown(rim, dark, there.only(~new), there.ids[new])
            start = merged([there, thrown])
        return solver.evened(patch, start, moving) if moving.any() else NO_POINTS


def patch_in(surface: Tileable, zone: Zone) -> Patch:
    """The faces whose middle is in a zone."""
    patch = surface.read(zone.rows, zone.columns)
    return patch.only(zone.holds(patch, surface.axes))


def finished(patch: Patch, points: Bound) -> TilePoints:
    """The points of a tile with their places."""
    positions = patch.points(patch.find(points.faces), points.barycentric)
    return TilePoints(positions, points.normals, points.faces, points.barycentric, points.ids)
