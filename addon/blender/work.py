# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators do, as steps (core/steps.py): read, let the worker solve, check, write.

Between two steps the artist may delete anything, so objects are found again by their uid.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import bpy

from ..core.bake import Baker, Start
from ..core.binding import bound_nearest
from ..core.errors import ScatterError, StoppedError
from ..core.keys import Keyframes
from ..core.population import PopulationBaker
from ..core.records import Binding, Columns, check_ids
from ..core.rest import at_rest, told_apart
from ..core.settings import Settings
from ..core.solve import named, scatter
from ..core.steps import Steps, Task
from ..core.surface import Floats, SurfaceArrays, check_unchanged
from ..core.tiles import tiled
from ..core.together import TogetherBaker
from .held import Held
from .meshio import read_surface
from .resting import current_binding, kind_of_binding, rest_of, rest_position, with_rest
from .scatter import settings_of, surface_of, tile_settings_of
from .staleness import other_faces
from .store import (
    columns_with_own_ids,
    locked_points,
    own_points,
    places_of,
    point_columns_of,
    write_baked,
    write_binding,
    write_own_ids,
    write_scattered,
)
from .surroundings import read_with
from .tiles import check_tile_object, write_tiles
from .translation import reported
from .workfiles import work_files

_SEAM_STEPS = 6
_READING = 0.2  # of the progress of a bake that solves all frames together


def optimise_steps(context: bpy.types.Context) -> Steps:
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
    """Keys of the frames from first to last, each re-optimised; returns the Baker."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    if last < first:
        raise ScatterError(f"The frame range is empty: {first} to {last}")
    with _frame_kept(context.scene):
        context.scene.frame_set(first)
        kind = kind_of_binding(surface.get(), bpy.context, context.object.dapple.bind_to)
    with rest_position(surface, kind):
        with _frame_kept(context.scene):
            baker = yield from _carry(held, surface, first, last, kind)
        _write_bake(held.get(), baker, kind)
    return baker


def _write_bake(obj: bpy.types.Object, baker: Baker, kind: str) -> None:
    _check_points(obj, baker)
    if "REST" in (kind, obj.dapple.bound_to):
        rest = at_rest(baker.begin, baker.first_surface) if kind == "REST" else None
        write_binding(obj, baker.first_surface, baker.begin, rest)
    born = baker.born() if isinstance(baker, PopulationBaker) else None
    write_baked(obj, baker.baked(), baker.first, baker.report(), born)
    obj.dapple.bake_fingerprint = baker.fingerprint
    known = dict.fromkeys([*obj.dapple.surface_topology.split(), *baker.topologies])
    obj.dapple.surface_topology = " ".join(known)


def _carry(held: Held, surface: Held, first: int, last: int, kind: str) -> Any:
    count = last - first + 1
    settings = settings_of(held.get())
    begin = arrays = _at_frame(surface, first, settings=settings, own=held, kind=kind)
    baker = _baker(held.get(), surface.get(), arrays, first, count)
    end = _READING if isinstance(baker, TogetherBaker) else 1.0
    for step in range(count):
        if step:
            arrays = _at_frame(surface, first + step, kind=kind)
        share = (end * step / count, end * (step + 1) / count)
        yield from _solve(baker, held, surface, arrays, share)
    if isinstance(baker, TogetherBaker):
        yield Task(baker.solve, end, 1.0)
    check_unchanged(begin, _at_frame(surface, first, settings=settings, own=held))
    return baker


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
        return reported("Cancelled: nothing was written")
    return reported(
        "Cancelled: the scatter is as it was; {count} solved frames are kept in '{folder}', Bake "
        "goes on from there",
        count=baker.done,
        folder=baker.sidecar.folder,
    )


def _baker(
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays, first: int, count: int
) -> Baker:
    rebind = obj.dapple.on_topology_change == "REBIND"
    binding, columns = _binding(obj, surface, arrays, rebind)
    rebind = rebind or arrays.rest is not None
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
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays, rebind: bool
) -> tuple[Binding, Columns]:
    """The stored binding, or one to the places nearest to the points as they were optimised."""
    reason = other_faces(obj, arrays)
    if not reason or obj.dapple.bound_to == "REST":
        return current_binding(obj, surface, arrays)
    if not rebind:
        raise ScatterError(
            f"Scatter '{obj.name}' is stale: {reason}. Optimise the scatter first, or set On "
            "Topology Change to Re-bind"
        )
    columns = point_columns_of(obj)
    check_ids(columns["id"], obj.name)
    return _nearest(places_of(obj), arrays), columns


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


def _check_points(obj: bpy.types.Object, baker: Baker) -> None:
    if own_points(obj).sum() != len(baker.start.ids):
        raise ScatterError(f"Scatter '{obj.name}' changed while it was baked: nothing was written")


def _at_frame(
    surface: Held,
    frame: int,
    part: float = 0.0,
    settings: Settings | None = None,
    own: Held | None = None,
    kind: str = "FACES",
) -> SurfaceArrays:
    bpy.context.scene.frame_set(frame, subframe=part)
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
