# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operators do, as steps (core/steps.py): read, let the worker solve, check, write.

Between two steps the artist may delete anything, so objects are found again by their uid.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy

from ..core.errors import ScatterError
from ..core.settings import Settings
from ..core.solve import Baker, scatter
from ..core.steps import Steps, Task
from ..core.surface import SurfaceArrays, check_same_topology, check_unchanged
from .meshio import read_surface
from .properties import settings_of
from .store import new_scatter, read_binding, write_keys, write_scattered
from .topology import check_render_topology


class Held:
    """An object across steps, without a reference that an undo would leave dangling."""

    def __init__(self, obj: bpy.types.Object) -> None:
        self.uid, self.name = obj.session_uid, obj.name

    def get(self) -> bpy.types.Object:
        """The object; ScatterError if it is gone."""
        for obj in bpy.data.objects:
            if obj.session_uid == self.uid:
                return obj
        raise ScatterError(f"Object '{self.name}' was removed meanwhile: nothing was written")


def surface_of(obj: bpy.types.Object) -> bpy.types.Object:
    """The surface of a scatter object; ScatterError if none is chosen."""
    if obj.dapple.surface is None:
        raise ScatterError(f"Scatter '{obj.name}' has no surface: choose a mesh object")
    return obj.dapple.surface


def add_steps(context: bpy.types.Context, settings: Settings) -> Steps:
    """Scatter over the active object; returns the new scatter object."""
    surface = Held(context.object)
    arrays = _read_checked(surface.get(), context)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker))
    check_unchanged(arrays, _read(surface.get()))
    obj = new_scatter(surface.get(), _collection_of(surface.get(), bpy.context))
    for name in settings.__dataclass_fields__:
        setattr(obj.dapple, name, getattr(settings, name))
    write_scattered(obj, arrays, solved)
    return obj


def optimise_steps(context: bpy.types.Context) -> Steps:
    """Scatter the active scatter object's points anew."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    settings = settings_of(context.object)
    arrays = _read_checked(surface.get(), context)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker))
    obj = held.get()
    check_unchanged(arrays, _read(surface.get()))
    write_scattered(obj, arrays, solved)
    return obj


def bake_steps(context: bpy.types.Context, first: int, last: int) -> Steps:
    """One re-optimised key for each frame from first to last."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    if last < first:
        raise ScatterError(f"The frame range is empty: {first} to {last}")
    with _frame_kept(context.scene):
        baker = yield from _carry(held, surface, first, last)
    obj = held.get()
    _check_points(obj, baker)
    write_keys(obj, baker.keys, first, baker.report())
    return obj


def _carry(held: Held, surface: Held, first: int, last: int) -> Any:
    count = last - first + 1
    arrays = _at_frame(surface, first)
    check_render_topology(surface.get(), bpy.context)
    baker = _baker(held.get(), arrays)
    for step in range(count):
        if step:
            arrays = _at_frame(surface, first + step)
            check_same_topology(baker.first, arrays, f"frame {first + step}")
        yield _advance(baker, arrays, step / count, (step + 1) / count)
    check_unchanged(baker.first, _at_frame(surface, first))
    return baker


def _advance(baker: Baker, arrays: SurfaceArrays, begin: float, end: float) -> Task:
    return Task(lambda worker: baker.advance(arrays.vertices, worker), begin, end)


def _baker(obj: bpy.types.Object, arrays: SurfaceArrays) -> Baker:
    if obj.dapple.surface_vertices != len(arrays.vertices):
        raise ScatterError(
            f"Scatter '{obj.name}' is stale: bound to {obj.dapple.surface_vertices} vertices, "
            f"surface '{arrays.name}' has {len(arrays.vertices)}: optimise the scatter first"
        )
    binding, columns = read_binding(obj, len(arrays.vertices))
    return Baker(arrays, settings_of(obj), binding, columns["id"], columns["dapple_class"])


def _check_points(obj: bpy.types.Object, baker: Baker) -> None:
    if len(obj.data.vertices) != len(baker.ids):
        raise ScatterError(f"Scatter '{obj.name}' changed while it was baked: nothing was written")


def _at_frame(surface: Held, frame: int) -> SurfaceArrays:
    bpy.context.scene.frame_set(frame)
    return _read(surface.get())


def _read(surface: bpy.types.Object) -> SurfaceArrays:
    return read_surface(surface, bpy.context.evaluated_depsgraph_get())


def _read_checked(surface: bpy.types.Object, context: bpy.types.Context) -> SurfaceArrays:
    check_render_topology(surface, context)
    return _read(surface)


def _collection_of(surface: bpy.types.Object, context: bpy.types.Context) -> bpy.types.Collection:
    """The surface's own collection, so that both are shown and hidden together."""
    inside = set(context.scene.collection.children_recursive) | {context.scene.collection}
    for collection in surface.users_collection:
        if collection in inside and collection.library is None:
            return collection
    return context.scene.collection


@contextmanager
def _frame_kept(scene: bpy.types.Scene) -> Iterator[None]:
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)
