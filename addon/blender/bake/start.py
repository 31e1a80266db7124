# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake starts with: the points of the first frame, and what they were solved from."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from ...core.bake.baker import Baker
from ...core.bake.over_time import is_of_the_world, may_move
from ...core.base.errors import ScatterError
from ...core.base.steps import Task
from ...core.settings.values import Settings
from ...core.solve.solve import Scattered, scatter
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.sources import Sources, differing, sources_of
from ..base.object_handles import Held
from ..freshness.contents import solution_reason
from ..scatter.points import locked_points
from ..surface.reading import at_frame
from .bakers import _check_faces

_SOLVING = 0.1  # of the progress of a bake whose points are optimized anew first


@dataclass
class Begun:
    """What a bake begins with, in its first frame."""

    arrays: SurfaceArrays
    sources: Sources
    solved: Scattered | None = None  # the points anew; None: those that are stored
    anew: str = ""  # why
    progress: float = 0.0  # of the bake, so far

    def note_moving(self, held: Held, surface: Held, settings: Settings, frame: int) -> None:
        """Note what is on a frame not as in the first one: later that is no sign of a change."""
        try:
            now = sources_of(at_frame(surface, frame, settings=settings, own=held), settings)
        except ScatterError:  # a density of the first frame only
            now = replace(self.sources, exact={}, near={})
        self.note(differing(self.sources, now))

    def note(self, roles: Iterable[str]) -> None:
        """Note that these move."""
        moving = {*self.sources.moving, *roles}
        self.sources = replace(self.sources, moving=tuple(sorted(moving)))


def begin_bake(held: Held, arrays: SurfaceArrays, settings: Settings) -> Any:
    """The points of the first frame: those that are stored, where they are of these settings and
    of what is there; else they are optimized anew.
    """
    obj, sources = held.get(), sources_of(arrays, settings)
    _check_faces(obj, arrays)
    reason = solution_reason(obj, sources)
    if not reason:
        return Begun(arrays, sources)
    locked = locked_points(obj)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker, locked), 0.0, _SOLVING)
    return Begun(arrays, sources, solved, reason, _SOLVING)


def frozen_in(begun: Begun, baker: Baker) -> list[str]:
    """Roles of what moves and was not followed, though the density reads it."""
    settings = baker.start.settings
    if baker.follows or not may_move(settings):
        return []
    shaped = is_of_the_world(settings.density, baker.first_surface.around)
    rides = {"faces", "scale", "noise", *(() if shaped else ("shape",))}
    return [role for role in begun.sources.moving if role not in rides]
