# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators do, as steps (core/steps.py): read, let the worker solve, check, write.

Between two steps the artist may delete anything, so objects are found again by their uid.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import bpy

from ..core.bake import Baker, Start
from ..core.binding import bound_nearest
from ..core.errors import ScatterError, StoppedError
from ..core.keys import Keyframes
from ..core.population import PopulationBaker
from ..core.records import Binding, Columns, as_stored, check_ids
from ..core.rest import at_rest, told_apart
from ..core.settings import Settings
from ..core.solve import Scattered, named, scatter
from ..core.sources import Sources, differing, sources_of
from ..core.steps import Steps, Task
from ..core.surface import Floats, SurfaceArrays, check_unchanged
from ..core.tiles import tiled
from ..core.together import TogetherBaker
from .held import Held
from .meshio import read_surface, to_local
from .resting import current_binding, kind_of_binding, rest_of, rest_position, with_rest
from .scatter import settings_of, surface_of, tile_settings_of
from .staleness import other_faces, solution_reason
from .store import (
    columns_with_own_ids,
    ensure_modifier,
    locked_points,
    own_points,
    places_of,
    point_columns_of,
    write_baked,
    write_binding,
    write_own_ids,
    write_scattered,
    write_surface_inputs,
)
from .surroundings import read_with
from .tiles import check_tile_object, write_tiles
from .times import show_time, times_of
from .translation import reported
from .workfiles import work_files

_SEAM_STEPS = 6
_SOLVING = 0.1  # of the progress of a bake whose points are optimized anew first
_READING = 0.2  # of the progress of a bake that solves all frames together


def optimize_steps(context: bpy.types.Context) -> Steps:
    """Scatter the active scatter object's points anew."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    settings, bind_to = settings_of(context.object), context.object.dapple.bind_to
    kind = kind_of_binding(surface.get(), context, bind_to)
    arrays = read(surface.get(), settings, context.object)
    locked = locked_points(context.object)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker, locked))
    obj = held.get()
    check_unchanged(arrays, read(surface.get(), settings, obj))
    with rest_position(surface, kind):
        rest = rest_of(surface.get(), arrays, solved.binding, kind)
        write_scattered(obj, arrays, solved, rest)
    return obj


def bake_steps(context: bpy.types.Context, first: int, last: int) -> Steps:
    """Keys of the frames from first to last, each re-optimized; returns the Baker."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    first, last = times_of(context.scene, first, last)
    if last < first:
        raise ScatterError(f"The frame range is empty: {first} to {last}")
    count = own_points(context.object).sum()
    with _frame_kept(context.scene):
        show_time(context.scene, first)
        kind = kind_of_binding(surface.get(), bpy.context, context.object.dapple.bind_to)
    with rest_position(surface, kind):
        with _frame_kept(context.scene):
            begun, baker = yield from _carry(held, surface, first, last, kind)
        _check_points(held.get(), count)
        _write_bake(held.get(), begun, baker, kind)
    return baker


@dataclass
class _Begun:
    """What a bake begins with, in its first frame."""

    arrays: SurfaceArrays
    sources: Sources
    solved: Scattered | None = None  # the points anew; None: those that are stored
    anew: str = ""  # why


def _write_bake(obj: bpy.types.Object, begun: _Begun, baker: Baker, kind: str) -> None:
    rest = at_rest(baker.begin, baker.first_surface) if kind == "REST" else None
    born = baker.born() if isinstance(baker, PopulationBaker) else None
    if born is not None:
        to_local(obj, born.positions)  # where that cannot be, nothing is lost yet
    if begun.solved is not None:
        write_scattered(obj, baker.first_surface, begun.solved, rest)
    elif "REST" in (kind, obj.dapple.bound_to):
        write_binding(obj, baker.first_surface, baker.begin, rest)
    write_baked(obj, baker.baked(), baker.first, baker.report(), born, begun.sources)
    obj.dapple.bake_fingerprint = baker.fingerprint
    known = dict.fromkeys([*obj.dapple.surface_topology.split(), *baker.topologies])
    obj.dapple.surface_topology = " ".join(known)
    write_surface_inputs(obj, ensure_modifier(obj))


def _carry(held: Held, surface: Held, first: int, last: int, kind: str) -> Any:
    count = last - first + 1
    settings = settings_of(held.get())
    arrays = _at_frame(surface, first, settings=settings, own=held, kind=kind)
    begun = yield from _begin(held, arrays, settings)
    baker = _baker(held.get(), surface.get(), arrays, first, count, begun.solved)
    baker.anew = begun.anew
    begin = _SOLVING if begun.solved else 0.0
    end = _READING if isinstance(baker, TogetherBaker) else 1.0
    for step in range(count):
        if step:
            arrays = _at_frame(surface, first + step, kind=kind)
        if step in (count // 2, count - 1):
            _note_moving(begun, held, surface, settings)
        at = begin + (end - begin) * step / count
        yield from _solve(baker, held, surface, arrays, (at, at + (end - begin) / count))
    if isinstance(baker, TogetherBaker):
        yield Task(baker.solve, end, 1.0)
    check_unchanged(begun.arrays, _at_frame(surface, first, settings=settings, own=held))
    return begun, baker


def _begin(held: Held, arrays: SurfaceArrays, settings: Settings) -> Any:
    """The points of the first frame: those that are stored, where they are of these settings and
    of what is there; else they are optimized anew.
    """
    obj, sources = held.get(), sources_of(arrays, settings)
    _check_faces(obj, arrays)
    reason = solution_reason(obj, sources)
    if not reason:
        return _Begun(arrays, sources)
    locked = locked_points(obj)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker, locked), 0.0, _SOLVING)
    return _Begun(arrays, sources, solved, reason)


def _note_moving(begun: _Begun, held: Held, surface: Held, settings: Settings) -> None:
    """Note what is not as in the first frame: later that is no sign of a change."""
    try:
        now = sources_of(read(surface.get(), settings, held.get()), settings)
    except ScatterError:  # a density of the first frame only
        now = replace(begun.sources, exact={}, near={})
    moving = {*begun.sources.moving, *differing(begun.sources, now)}
    begun.sources = replace(begun.sources, moving=tuple(sorted(moving)))


def _solve(
    baker: Baker, held: Held, surface: Held, arrays: SurfaceArrays, share: tuple[float, float]
) -> Any:
    """The next frame: what a stopped bake left, or solved now."""
    if baker.changes(arrays):
        number = baker.first + baker.done
        before, after = baker.now, arrays
        if arrays.rest is None:
            before, after = _seam(surface, number, baker.bound.topology)
        settings = baker.start.settings
        then = _at_frame(surface, number, settings=settings, own=held)
        baker.cross(before, replace(after, weights=then.weights, around=then.around))
        arrays = replace(_at_frame(surface, number), rest=arrays.rest)
    baker.enter(arrays)
    try:
        if (yield Task(lambda _: baker.take(), *share)):
            return
        yield Task(baker.advance, *share)
    except StoppedError as error:
        raise StoppedError(_stopped(baker)) from error


def _seam(surface: Held, frame: int, topology: str) -> tuple[SurfaceArrays, SurfaceArrays]:
    """The surface just before and just after it loses its topology, on the way to a frame.

    Bisected, so that it hardly moves between both, however far it moves in a frame.
    """
    begin, end = 0.0, 1.0
    before, after = _at_frame(surface, frame - 1), _at_frame(surface, frame)
    for _ in range(_SEAM_STEPS):
        middle = (begin + end) / 2
        arrays = _at_frame(surface, frame - 1, middle)
        if arrays.topology == topology:
            begin, before = middle, arrays
        elif arrays.topology == after.topology:
            end, after = middle, arrays
        else:  # yet another one on the way
            break
    return before, after


def _stopped(baker: Baker) -> str:
    if baker.sidecar is None or not baker.done:
        return reported("Canceled: nothing was written")
    return reported(
        "Canceled: the scatter is unchanged; {count} solved frames are kept in '{folder}', "
        "Bake continues from there",
        count=baker.done,
        folder=baker.sidecar.folder,
    )


def _baker(
    obj: bpy.types.Object,
    surface: bpy.types.Object,
    arrays: SurfaceArrays,
    first: int,
    count: int,
    solved: Scattered | None,
) -> Baker:
    rebind = obj.dapple.on_topology_change == "REBIND" or arrays.rest is not None
    if solved is not None:
        binding, columns = as_stored(solved.binding), solved.columns
    else:
        binding, columns = _binding(obj, surface, arrays)
    if arrays.rest is not None:
        arrays = told_apart(binding, arrays)
    start = Start(binding, columns["id"], columns["dapple_class"], settings_of(obj))
    keyframes = Keyframes(count, obj.dapple.key_every)
    smoothing = obj.dapple.bake_smoothing
    if obj.dapple.count_over_time == "KEEP_DENSITY":
        return PopulationBaker(arrays, start, keyframes, first=first, fade=obj.dapple.fade_frames)
    if smoothing != "FORWARDS":
        return TogetherBaker(arrays, start, keyframes, first=first, closed=smoothing == "LOOP")
    return Baker(arrays, start, keyframes, work_files(obj, first), first, rebind)


def _binding(
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays
) -> tuple[Binding, Columns]:
    """The stored binding, or one to the places nearest to the points as they were optimized."""
    if obj.dapple.bound_to == "REST" or not other_faces(obj, arrays):
        return current_binding(obj, surface, arrays)
    columns = point_columns_of(obj)
    check_ids(columns["id"], obj.name)
    return _nearest(places_of(obj), arrays), columns


def _check_faces(obj: bpy.types.Object, arrays: SurfaceArrays) -> None:
    reason = "" if obj.dapple.bound_to == "REST" else other_faces(obj, arrays)
    if reason and obj.dapple.on_topology_change != "REBIND":
        raise ScatterError(
            f"Scatter '{obj.name}' is out of date: {reason}. Optimize the scatter first, or "
            "set On Topology Change to Reattach"
        )


def tile_steps(context: bpy.types.Context) -> Steps:
    """The active scatter's cells on the surface of this frame; returns the object and the Tiles."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    check_tile_object(context.object)
    arrays = read(surface.get())
    binding, columns = current_binding(context.object, surface.get(), arrays)
    settings, seed = tile_settings_of(context.object), context.object.dapple.seed
    tiles = yield Task(lambda worker: tiled(arrays, binding, columns, settings, seed, worker))
    obj = held.get()
    check_unchanged(arrays, read(surface.get()))
    return write_tiles(obj, tiles), tiles


def rebind_steps(context: bpy.types.Context) -> Steps:
    """Bind the active scatter to the places of its surface that are nearest to its points."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    kind = kind_of_binding(surface.get(), context, context.object.dapple.bind_to)
    arrays = read(surface.get())
    points, columns = places_of(context.object), columns_with_own_ids(context.object)
    binding = yield Task(lambda _: _nearest(points, arrays))
    obj = held.get()
    check_unchanged(arrays, read(surface.get()))
    with rest_position(surface, kind):
        write_binding(obj, arrays, binding, rest_of(surface.get(), arrays, binding, kind))
        write_own_ids(obj, columns)
    return obj


def _nearest(points: Floats, arrays: SurfaceArrays) -> Binding:
    with named(arrays.name):
        return bound_nearest(points, arrays)


def _check_points(obj: bpy.types.Object, count: int) -> None:
    if own_points(obj).sum() != count:
        raise ScatterError(f"Scatter '{obj.name}' changed while it was baked: nothing was written")


def _at_frame(
    surface: Held,
    frame: int,
    part: float = 0.0,
    settings: Settings | None = None,
    own: Held | None = None,
    kind: str = "FACES",
) -> SurfaceArrays:
    show_time(bpy.context.scene, frame + part)
    arrays = read(surface.get(), settings, own.get() if own else None)
    return with_rest(arrays, surface.get()) if kind == "REST" else arrays


def read(
    surface: bpy.types.Object,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
) -> SurfaceArrays:
    """The surface; with settings, also what they take from it and from beside their scatter."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if settings is None:
        return read_surface(surface, depsgraph)
    return read_with(settings, surface, depsgraph, own)


@contextmanager
def _frame_kept(scene: bpy.types.Scene) -> Iterator[None]:
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)
