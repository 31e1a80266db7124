# SPDX-License-Identifier: GPL-3.0-or-later
"""The start of a bake: the points of the first frame and a baker for the settings."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import bpy

from ...core.bake.baker import Baker, Start
from ...core.bake.keys import Keyframes
from ...core.bake.masked_surfaces import is_of_the_world, may_move
from ...core.bake.population import PopulationBaker
from ...core.bake.window_bake import WindowBaker
from ...core.base.errors import ScatterError
from ...core.base.steps import Task
from ...core.settings.values import Settings
from ...core.solve.solve import Scattered, nearest_binding, scatter
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.records import Binding, Columns, as_stored, check_ids
from ...core.surface.rest import with_distinct_parts
from ...core.surface.sources import Sources, differing, sources_of
from ..base.object_handles import ObjectHandle
from ..freshness.content_changes import solution_reason
from ..freshness.unfinished_bakes import work_files
from ..scatter.object import follows_masks, settings_of
from ..scatter.points import locked_points, places_of, point_columns_of
from ..surface.current_binding import current_binding, other_faces
from ..surface.reading import at_frame
from .poses import Poses

_SOLVING = 0.1  # share of the progress for optimizing the points first, if needed


@dataclass
class BakeStart:
    """The first frame of a bake."""

    arrays: SurfaceArrays
    sources: Sources
    solved: Scattered | None = None  # newly optimized points; None: the stored ones are used
    reoptimized_reason: str = ""  # reason for optimizing again
    progress: float = 0.0  # share of the bake that is done

    def note_moving(
        self, handle: ObjectHandle, surface: ObjectHandle, settings: Settings, frame: int
    ) -> None:
        """Record which inputs at a frame differ from the first frame, as they are animated.

        They are not reported as changes later.
        """
        try:
            now = sources_of(at_frame(surface, frame, settings=settings, own=handle), settings)
        except ScatterError:  # this frame's inputs do not affect the density
            now = replace(self.sources, exact={}, near={})
        self.note(differing(self.sources, now))

    def note(self, roles: Iterable[str]) -> None:
        """Record these roles as animated."""
        moving = {*self.sources.moving, *roles}
        self.sources = replace(self.sources, moving=tuple(sorted(moving)))


def begin_bake(handle: ObjectHandle, poses: Poses, settings: Settings) -> Any:
    """The points of the first frame, in steps.

    The stored points are used if they fit the settings and the scene; otherwise they are optimized
    again.
    """
    arrays, begin = poses.first, poses.progress
    obj, sources = handle.get(), sources_of(arrays, settings)
    _check_faces(obj, arrays)
    reason = solution_reason(obj, sources)
    if not reason:
        return BakeStart(arrays, sources, progress=begin)
    locked, end = locked_points(obj), begin + _SOLVING

    def solve(worker: Any) -> Scattered:
        return scatter(arrays, settings, worker, locked, poses.masked)

    solved = yield Task(solve, begin, end)
    return BakeStart(arrays, sources, solved, reason, end)


def frozen_in(bake_start: BakeStart, baker: Baker) -> list[str]:
    """Roles of animated inputs that the density reads, but that this bake does not follow."""
    settings = baker.start.settings
    if baker.follows or not may_move(settings):
        return []
    shaped = is_of_the_world(settings.density, baker.first_surface.around)
    rides = {"faces", "scale", "noise", *(() if shaped else ("shape",))}
    return [role for role in bake_start.sources.moving if role not in rides]


def new_baker(
    obj: bpy.types.Object,
    surface: bpy.types.Object,
    poses: Poses,
    frames: range,
    solved: Scattered | None,
) -> Baker:
    """A baker for these frames, starting with newly optimized points if there are any."""
    arrays, first = poses.first, frames.start
    reattach = obj.dapple.new_topology == "REATTACH" or arrays.rest is not None
    if solved is not None:
        binding, columns = as_stored(solved.binding), solved.columns
    else:
        binding, columns = _binding(obj, surface, arrays)
    if arrays.rest is not None:
        arrays = with_distinct_parts(binding, arrays)
    start = Start(binding, columns["id"], columns["dapple_object_type"], settings_of(obj))
    keyframes = Keyframes(len(frames), obj.dapple.keyframe_step)
    smoothing, kept = obj.dapple.smoothing, work_files(obj, first)
    follows = follows_masks(obj) and may_move(start.settings)
    fits = any(one.fit_to_spacing > 0.0 for one in (obj.dapple, *obj.dapple.object_types))
    common = (arrays, start, keyframes, kept, first, reattach)
    known: dict[str, Any] = {"masked": poses.masked, "poses": poses.by_topology, "fits": fits}
    if obj.dapple.population == "KEEP_DENSITY":
        fade = obj.dapple.fade_duration
        return PopulationBaker(*common, follows, fade=fade, **known)
    if smoothing == "FORWARD":
        return Baker(*common, follows, **known)
    return WindowBaker(*common, closed=smoothing == "LOOP", **known)


def _binding(
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays
) -> tuple[Binding, Columns]:
    """The stored binding; for newly optimized points, their nearest places."""
    if obj.dapple.attached_to == "REST" or not other_faces(obj, arrays):
        return current_binding(obj, surface, arrays)
    columns = point_columns_of(obj)
    check_ids(columns["id"], obj.name)
    return nearest_binding(places_of(obj), arrays), columns


def _check_faces(obj: bpy.types.Object, arrays: SurfaceArrays) -> None:
    reason = "" if obj.dapple.attached_to == "REST" else other_faces(obj, arrays)
    if reason and obj.dapple.new_topology != "REATTACH":
        raise ScatterError(
            f"Scatter '{obj.name}' is out of date: {reason}. Optimize the scatter first, or "
            "set New Topology to Reattach"
        )
