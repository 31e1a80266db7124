# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a bake: frames without faces, changing faces, masks of each frame."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import bpy

from ...core.bake.baker import Baker
from ...core.base.errors import ScatterError
from ...core.base.steps import Task
from ...core.settings.values import Settings
from ...core.surface.arrays import SurfaceArrays, check_unchanged, is_reordered
from ..base.object_handles import ObjectHandle
from ..scatter.object import is_fluid
from ..surface.reading import at_frame
from ..surface.rest_position import kind_of_binding
from ..surface.surroundings import Known

_SEAM_STEPS = 6
_TRIES = 8
Read = Callable[[], SurfaceArrays]  # evaluates and reads a frame again


@dataclass
class Masks:
    """Reads the frames of a surface with everything that the settings need."""

    settings: Settings
    last: SurfaceArrays  # the frame that was read last
    known: Known = field(init=False)

    def __post_init__(self) -> None:
        self.known = Known(arrays=self.last)

    def at_frame(
        self, surface: ObjectHandle, handle: ObjectHandle, frame: int, kind: str, may_be_empty: bool
    ) -> SurfaceArrays:
        """The surface at a frame. Where an input is missing, the inputs of the previous frame are
        used.
        """
        try:
            arrays = at_frame(
                surface,
                frame,
                settings=self.settings,
                own=handle,
                kind=kind,
                may_be_empty=may_be_empty,
                known=self.known,
            )
        except ScatterError:
            arrays = at_frame(surface, frame, kind=kind, may_be_empty=may_be_empty)
            if arrays.topology == self.last.topology:
                last = self.last
                return replace(
                    arrays, weights=last.weights, digests=last.digests, around=last.around
                )
            raise
        self.last = arrays if len(arrays.faces) else self.last
        return arrays


def may_be_empty(obj: bpy.types.Object, kind: str) -> bool:
    """Whether a bake continues over frames without faces, for this kind of binding."""
    follows = obj.dapple.new_topology == "REATTACH" or kind == "REST"
    return _keeps_density(obj) and follows and not len(obj.dapple.object_types)


def first_frame_with_faces(
    handle: ObjectHandle, surface: ObjectHandle, first: int, last: int
) -> Any:
    """Find the first frame of a bake that can have points, in steps.

    Shows that frame. Returns it with the points' binding there.
    """
    begin = first
    if _keeps_density(handle.get()):
        begin = yield from _first_with_faces(surface, first, last)
    kind = kind_of_binding(surface.get(), bpy.context, handle.get().dapple.attach_to)
    if begin > first and not may_be_empty(handle.get(), kind):
        raise ScatterError(_refused(handle.get(), surface.get().name, first))
    return begin, kind


def _first_with_faces(surface: ObjectHandle, first: int, last: int) -> Any:
    for frame in range(first, last + 1):
        if len(at_frame(surface, frame, may_be_empty=True).faces):
            return frame
        yield Task(lambda _: None, 0.0, 0.0)
    name = surface.get().name
    raise ScatterError(f"Surface '{name}' has no faces from frame {first} to {last}")


def read_frame(
    handle: ObjectHandle, surface: ObjectHandle, frame: int, kind: str, masks: Masks | None = None
) -> SurfaceArrays:
    """The surface at a frame of a bake, with the inputs of its density if masks are given.

    A surface without faces is an error unless the bake may continue over it.
    """
    empty = _keeps_density(handle.get())
    if masks is None:
        arrays = at_frame(surface, frame, kind=kind, may_be_empty=empty)
    else:
        arrays = masks.at_frame(surface, handle, frame, kind, empty)
    if not (len(arrays.faces) or may_be_empty(handle.get(), kind)):
        raise ScatterError(_refused(handle.get(), surface.get().name, frame))
    return arrays


def appeared(
    baker: Baker,
    handle: ObjectHandle,
    surface: ObjectHandle,
    arrays: SurfaceArrays,
    known: Known | None,
) -> SurfaceArrays:
    """Make points appear on faces that have come back; returns the frame."""
    number = baker.first + baker.done
    then = at_frame(surface, number, settings=baker.start.settings, own=handle, known=known)
    baker.appear(replace(then, rest=arrays.rest))
    return replace(then, rest=arrays.rest) if baker.follows else arrays


def _keeps_density(obj: bpy.types.Object) -> bool:
    return bool(obj.dapple.population == "KEEP_DENSITY")


def _refused(obj: bpy.types.Object, name: str, frame: int) -> str:
    text = f"Surface '{name}' has no faces at frame {frame}"
    if len(obj.dapple.object_types):
        return f"{text}: points of object types cannot appear again behind it"
    return f"{text}: set New Topology to Reattach to have no points there"


def crossed(
    baker: Baker,
    handle: ObjectHandle,
    surface: ObjectHandle,
    arrays: SurfaceArrays,
    known: Known | None = None,
) -> SurfaceArrays:
    """Change the baker's topology to that of its next frame; returns that frame, read again."""
    if baker.is_empty:
        return appeared(baker, handle, surface, arrays, known)
    number = baker.first + baker.done
    before, after = baker.now, arrays
    if arrays.rest is None and baker.at_seam:
        before, after = _seam(surface, number, baker.bound.topology)
    then = at_frame(surface, number, settings=baker.start.settings, own=handle, known=known)
    # Values at corners belong to triangles, so quads are cut as when the values were read.
    there = replace(after, faces=then.faces, loops=then.loops, around=then.around)
    baker.cross(before, replace(there, weights=then.weights, digests=then.digests))
    again = then if baker.follows else at_frame(surface, number)
    return replace(again, rest=arrays.rest)


def _seam(surface: ObjectHandle, frame: int, topology: str) -> tuple[SurfaceArrays, SurfaceArrays]:
    """The surface just before and just after its topology changes between two frames.

    The time is bisected, so that the surface hardly moves between both.
    """
    begin, end = 0.0, 1.0
    before, after = at_frame(surface, frame - 1), at_frame(surface, frame)
    for _ in range(_SEAM_STEPS):
        middle = (begin + end) / 2
        arrays = at_frame(surface, frame - 1, middle)
        if arrays.topology == topology:
            begin, before = middle, arrays
        elif arrays.topology == after.topology:
            end, after = middle, arrays
        else:  # a third topology between both
            break
    return before, after


@dataclass
class StableOrder:
    """Reads frames of a bake in one order of faces, even if the surface's own order changes."""

    surface: ObjectHandle

    def first(self, obj: bpy.types.Object, read: Read) -> SurfaceArrays:
        """The first frame, in the order to which the scatter's points are attached."""
        arrays, known = read(), obj.dapple.surface_topology.split()
        if not known or obj.dapple.attached_to != "FACES":
            return arrays
        return self._in_order(arrays, known[0], obj.dapple.surface_vertices, read)

    def next(self, bound: SurfaceArrays, read: Read) -> SurfaceArrays:
        """A frame in the order of a previous one."""
        return self._in_order(read(), bound.topology, len(bound.vertices), read)

    def check(self, before: SurfaceArrays, read: Read) -> None:
        """ChangedError unless a surface, in any order, is still the one that was read."""
        now = self.next(before, read)
        if now.topology == before.topology or not is_reordered(before, now):
            check_unchanged(before, now)

    def _in_order(
        self, first: SurfaceArrays, known: str, vertices: int, read: Read
    ) -> SurfaceArrays:
        arrays = first
        if len(first.vertices) != vertices or is_fluid(self.surface.get()):
            return first
        for _ in range(_TRIES):
            if arrays.topology == known:
                return arrays
            self._evaluate_again()
            arrays, before = read(), arrays
            if arrays.topology == before.topology or not is_reordered(first, arrays):
                break  # the order does not change by itself
        return arrays if arrays.topology == known else first

    def _evaluate_again(self) -> None:
        self.surface.get().update_tag(refresh={"DATA"})
        bpy.context.view_layer.update()
