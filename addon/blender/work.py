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
from ..core.presets import settings_with
from ..core.records import Binding, Columns, check_ids
from ..core.rest import rest_columns
from ..core.settings import Settings
from ..core.solve import named, scatter
from ..core.steps import Steps, Task
from ..core.surface import Floats, SurfaceArrays, check_unchanged
from ..core.tiles import tiled
from ..core.together import TogetherBaker
from . import presets
from .held import Held
from .library import open_collections, read_only
from .meshio import read_rest, read_surface
from .scatter import settings_of, surface_of, tile_settings_of
from .staleness import check_bound_to_faces, other_faces
from .store import (
    columns_with_own_ids,
    locked_points,
    new_scatter,
    own_points,
    places_of,
    point_columns_of,
    read_binding,
    write_baked,
    write_binding,
    write_own_ids,
    write_scattered,
)
from .surroundings import read_with
from .tiles import check_tile_object, write_tiles
from .topology import check_render_topology
from .translation import english, reported
from .workfiles import new_key, work_files

_SEAM_STEPS = 6
_READING = 0.2  # of the progress of a bake that solves all frames together


def add_steps(context: bpy.types.Context, **chosen: Any) -> Steps:
    """Scatter over the active object; returns the new scatter object.

    What is not chosen (count, seed, bind_to) is as in the preset that new scatters begin with.
    """
    surface, values = Held(context.object), presets.first_values()
    own = values.setdefault("", {})
    own.update(chosen)
    if "count" in chosen:
        own["amount"] = "COUNT"
    settings, bind_to = settings_with(values), own.setdefault("bind_to", "FACES")
    arrays = _read_checked(surface.get(), context, bind_to, settings)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker))
    check_unchanged(arrays, _read(surface.get(), settings))
    rest = _rest(surface.get(), arrays, solved.binding, bind_to)
    obj = new_scatter(surface.get(), _collection_of(surface.get(), bpy.context))
    obj.dapple.bake_key = new_key()
    presets.apply(obj, values)
    write_scattered(obj, arrays, solved, rest)
    return obj


def optimise_steps(context: bpy.types.Context) -> Steps:
    """Scatter the active scatter object's points anew."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    settings, bind_to = settings_of(context.object), context.object.dapple.bind_to
    arrays = _read_checked(surface.get(), context, bind_to, settings, context.object)
    locked = locked_points(context.object)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker, locked))
    obj = held.get()
    check_unchanged(arrays, _read(surface.get(), settings, obj))
    rest = _rest(surface.get(), arrays, solved.binding, bind_to)
    write_scattered(obj, arrays, solved, rest)
    return obj


def bake_steps(context: bpy.types.Context, first: int, last: int) -> Steps:
    """Keys of the frames from first to last, each re-optimised; returns the Baker."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    check_bound_to_faces(context.object, "bake")
    if last < first:
        raise ScatterError(f"The frame range is empty: {first} to {last}")
    with _frame_kept(context.scene):
        baker = yield from _carry(held, surface, first, last)
    obj = held.get()
    _check_points(obj, baker)
    born = baker.born() if isinstance(baker, PopulationBaker) else None
    write_baked(obj, baker.baked(), first, baker.report(), born)
    obj.dapple.bake_fingerprint = baker.fingerprint
    known = dict.fromkeys([*obj.dapple.surface_topology.split(), *baker.topologies])
    obj.dapple.surface_topology = " ".join(known)
    return baker


def _carry(held: Held, surface: Held, first: int, last: int) -> Any:
    count = last - first + 1
    settings = settings_of(held.get())
    begin = arrays = _at_frame(surface, first, settings=settings, own=held)
    check_render_topology(surface.get(), bpy.context)
    baker = _baker(held.get(), arrays, first, count)
    end = _READING if isinstance(baker, TogetherBaker) else 1.0
    for step in range(count):
        if step:
            arrays = _at_frame(surface, first + step)
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
        before, after = _seam(surface, number, baker.bound.topology)
        settings = baker.start.settings
        then = _at_frame(surface, number, settings=settings, own=held)
        baker.cross(before, replace(after, weights=then.weights, around=then.around))
        arrays = _at_frame(surface, number)
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


def _baker(obj: bpy.types.Object, arrays: SurfaceArrays, first: int, count: int) -> Baker:
    rebind = obj.dapple.on_topology_change == "REBIND"
    binding, columns = _binding(obj, arrays, rebind)
    start = Start(binding, columns["id"], columns["dapple_class"], settings_of(obj))
    keyframes = Keyframes(count, obj.dapple.key_every)
    smoothing = obj.dapple.bake_smoothing
    if obj.dapple.count_over_time == "KEEP_DENSITY":
        return PopulationBaker(arrays, start, keyframes, first=first, fade=obj.dapple.fade_frames)
    if smoothing != "FORWARDS":
        return TogetherBaker(arrays, start, keyframes, first=first, closed=smoothing == "LOOP")
    return Baker(arrays, start, keyframes, work_files(obj, first), first, rebind)


def _binding(obj: bpy.types.Object, arrays: SurfaceArrays, rebind: bool) -> tuple[Binding, Columns]:
    """The stored binding, or one to the places nearest to the points as they were optimised."""
    reason = other_faces(obj, arrays)
    if not reason:
        return read_binding(obj, len(arrays.vertices))
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
    arrays = _read(surface.get())
    binding, columns = read_binding(context.object, len(arrays.vertices))
    settings, seed = tile_settings_of(context.object), context.object.dapple.seed
    tiles = yield Task(lambda worker: tiled(arrays, binding, columns, settings, seed, worker))
    obj = held.get()
    check_unchanged(arrays, _read(surface.get()))
    return write_tiles(obj, tiles), tiles


def rebind_steps(context: bpy.types.Context) -> Steps:
    """Bind the active scatter to the places of its surface that are nearest to its points."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    bind_to = context.object.dapple.bind_to
    arrays = _read_checked(surface.get(), context, bind_to)
    points, columns = places_of(context.object), columns_with_own_ids(context.object)
    binding = yield Task(lambda _: _nearest(points, arrays))
    obj = held.get()
    check_unchanged(arrays, _read(surface.get()))
    write_binding(obj, arrays, binding, _rest(surface.get(), arrays, binding, bind_to))
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
) -> SurfaceArrays:
    bpy.context.scene.frame_set(frame, subframe=part)
    return _read(surface.get(), settings, own.get() if own else None)


def _read(
    surface: bpy.types.Object,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
) -> SurfaceArrays:
    """The surface; with settings, also what they take from it and from beside their scatter."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if settings is None:
        return read_surface(surface, depsgraph)
    return read_with(settings, surface, depsgraph, own)


def _read_checked(
    surface: bpy.types.Object,
    context: bpy.types.Context,
    bind_to: str,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
) -> SurfaceArrays:
    if bind_to == "FACES":
        check_render_topology(surface, context)
    elif surface.type != "MESH":
        raise ScatterError(
            f"Surface '{surface.name}' is no mesh and has no rest position: set Bind To to Faces"
        )
    elif read_only(surface) and not surface.add_rest_position_attribute:
        raise ScatterError(
            f"Rest Position of the surface is off, and {read_only(surface, english)}"
        )
    return _read(surface, settings, own)


def _rest(
    surface: bpy.types.Object, arrays: SurfaceArrays, binding: Binding, bind_to: str
) -> Columns | None:
    """Places on the rest shape, if the points are to be bound to it."""
    if bind_to == "FACES":
        return None
    if not surface.add_rest_position_attribute:
        surface.add_rest_position_attribute = True
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return rest_columns(binding, read_rest(surface, depsgraph), arrays)


def _collection_of(surface: bpy.types.Object, context: bpy.types.Context) -> bpy.types.Collection:
    """The surface's own collection, so that both are shown and hidden together."""
    inside = set(context.scene.collection.children_recursive) | {context.scene.collection}
    for collection in open_collections(surface):
        if collection in inside:
            return collection
    return context.scene.collection


@contextmanager
def _frame_kept(scene: bpy.types.Scene) -> Iterator[None]:
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)
