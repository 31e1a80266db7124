# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake as steps: read a frame, solve it in the worker, repeat; write all frames at the end."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import bpy

from ...core.bake.baker import Baker
from ...core.bake.population import PopulationBaker
from ...core.base.errors import StoppedError
from ...core.base.steps import Steps, Task
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.rest import at_rest
from ..base.all_or_nothing import all_or_nothing
from ..base.mesh_arrays import to_local
from ..base.object_handles import ObjectHandle
from ..base.times import chosen_times
from ..base.translation import translated_report
from ..freshness.concurrent_edits import ConcurrentEdits
from ..scatter.key_writing import write_baked
from ..scatter.modifier import ensure_modifier, write_surface_inputs
from ..scatter.object import check_all_over, settings_of, surface_of
from ..scatter.store import write_binding, write_scattered
from ..surface.reading import at_frame, frame_kept
from ..surface.rest_position import rest_position
from .frames import Masks, StableOrder, crossed, first_frame_with_faces, read_frame
from .poses import read_poses
from .start import BakeStart, begin_bake, frozen_in, new_baker


def bake_steps(context: bpy.types.Context, first: int, last: int) -> Steps:
    """Optimize each frame from first to last and store keyframes; returns the Baker."""
    check_all_over(context.object)
    handle, surface = ObjectHandle(context.object), ObjectHandle(surface_of(context.object))
    first, last = chosen_times(context.scene, first, last)
    edits = ConcurrentEdits(handle)
    with frame_kept(context.scene, show=first):
        begin, kind = yield from first_frame_with_faces(handle, surface, first, last)
    with rest_position(surface, kind):
        with frame_kept(context.scene):
            frames = _Frames(first, begin, last)
            bake_start, baker = yield from _carry(handle, surface, frames, kind, edits)
        edits.check()
        write_bake(handle.get(), bake_start, baker, kind)
    return baker


@dataclass(frozen=True)
class _Frames:
    """The range of frames of a bake."""

    first: int
    begin: int  # the first frame with faces
    last: int

    @property
    def noted(self) -> tuple[int, int]:
        """Frames at which the inputs are compared with those of the first frame."""
        return self.first + (self.last - self.first + 1) // 2, self.last


def _carry(
    handle: ObjectHandle, surface: ObjectHandle, frames: _Frames, kind: str, edits: ConcurrentEdits
) -> Any:
    first, begin = frames.first, frames.begin
    settings = settings_of(handle.get())

    def read_first() -> SurfaceArrays:
        return at_frame(surface, begin, settings=settings, own=handle, kind=kind)

    steady = StableOrder(surface)
    arrays = steady.first(handle.get(), read_first)
    every = range(first, frames.last + 1)
    poses = yield from read_poses(handle, steady, arrays, settings, every, read_first, kind)
    bake_start = yield from begin_bake(handle, poses, settings)
    baker = new_baker(handle.get(), surface.get(), poses, every, bake_start.solved)
    masks = Masks(settings, arrays) if baker.follows else None
    baker.reoptimized_reason, there = bake_start.reoptimized_reason, begin
    for frame in every:
        edits.check()
        if frame != begin or begin != first:
            read = partial(read_frame, handle, surface, frame, kind, masks)
            arrays = steady.next(baker.bound, read)
        there = frame if len(arrays.faces) else there
        if frame in frames.noted:
            bake_start.note_moving(handle, surface, settings, there)
        yield from _solve(baker, handle, surface, arrays, bake_start.progress, masks)
    yield from _finish(baker, bake_start.progress)
    steady.check(bake_start.arrays, read_first)
    return bake_start, baker


def _solve(
    baker: Baker,
    handle: ObjectHandle,
    surface: ObjectHandle,
    arrays: SurfaceArrays,
    begin: float,
    masks: Masks | None,
) -> Any:
    """Load the next frame from a stopped bake, or solve it."""
    if not len(arrays.faces):
        baker.vanish(arrays)
        return
    if baker.is_empty or baker.changes(arrays):
        yield from _finish(baker, begin)
        arrays = crossed(baker, handle, surface, arrays, masks.known if masks else None)
    baker.enter(arrays)
    shares = [begin + (1.0 - begin) * share for share in baker.share]
    try:
        if (yield Task(lambda _: baker.take(), *shares)):
            return
        yield Task(baker.advance, *shares)
    except StoppedError as error:
        raise StoppedError(_stopped(baker)) from error


def _finish(baker: Baker, begin: float) -> Any:
    """Solve the frames that the baker still holds back."""
    shares = (baker.share[0], baker.done / baker.keyframes.count)
    try:
        yield Task(baker.finish, *(begin + (1.0 - begin) * share for share in shares))
    except StoppedError as error:
        raise StoppedError(_stopped(baker)) from error


def _stopped(baker: Baker) -> str:
    if baker.sidecar is None or not baker.reports:
        return translated_report("Canceled: nothing was written")
    return translated_report(
        "Canceled: the scatter is unchanged; {count} solved frames are kept in '{folder}', "
        "Bake continues from there",
        count=len(baker.reports),
        folder=baker.sidecar.folder,
    )


def write_bake(obj: bpy.types.Object, bake_start: BakeStart, baker: Baker, kind: str) -> None:
    """Store the result of a baker. Errors are found before anything is overwritten."""
    bake_start.note(baker.masked_surfaces.moving)
    rest = at_rest(baker.begin, baker.first_surface) if kind == "REST" else None
    born = baker.born() if isinstance(baker, PopulationBaker) else None
    if born is not None:
        to_local(obj, born.positions)  # raises an error before anything is overwritten
    with all_or_nothing(bpy.context, [obj]):
        if bake_start.solved is not None:
            write_scattered(obj, baker.first_surface, bake_start.solved, rest)
        elif "REST" in (kind, obj.dapple.attached_to):
            write_binding(obj, baker.first_surface, baker.begin, rest)
        write_baked(obj, baker.baked(), baker.first, baker.report(), born, bake_start.sources)
        write_known(obj, bake_start, baker)


def write_known(obj: bpy.types.Object, bake_start: BakeStart, baker: Baker) -> None:
    """Store the inputs of a bake, and all topologies that occurred."""
    obj.dapple.bake_fingerprint = baker.fingerprint
    obj.dapple.baked_frozen = " ".join(frozen_in(bake_start, baker))
    known = dict.fromkeys([*obj.dapple.surface_topology.split(), *baker.topologies])
    obj.dapple.surface_topology = " ".join(known)
    write_surface_inputs(obj, ensure_modifier(obj))
