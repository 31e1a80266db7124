# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a bake without faces: there are no points then, and others once faces come back."""

from dataclasses import replace
from typing import Any

import bpy

from ...core.bake.baker import Baker
from ...core.base.errors import ScatterError
from ...core.base.steps import Task
from ...core.surface.arrays import SurfaceArrays
from ..base.object_handles import Held
from ..surface.reading import at_frame
from ..surface.rest_position import kind_of_binding
from ..surface.surroundings import Known
from .frame_masks import Masks


def may_be_bare(obj: bpy.types.Object, kind: str) -> bool:
    """Whether a bake of a scatter that is bound so goes on over frames without faces."""
    follows = obj.dapple.on_topology_change == "REBIND" or kind == "REST"
    return _keeps_density(obj) and follows and not len(obj.dapple.classes)


def begin_of(held: Held, surface: Held, first: int, last: int) -> Any:
    """The first frame of a bake on which there can be points, and what they are bound to there;
    in steps. That frame is shown then.
    """
    begin = first
    if _keeps_density(held.get()):
        begin = yield from _first_with_faces(surface, first, last)
    kind = kind_of_binding(surface.get(), bpy.context, held.get().dapple.bind_to)
    if begin > first and not may_be_bare(held.get(), kind):
        raise ScatterError(_refused(held.get(), surface.get().name, first))
    return begin, kind


def _first_with_faces(surface: Held, first: int, last: int) -> Any:
    for frame in range(first, last + 1):
        if len(at_frame(surface, frame, may_be_bare=True).faces):
            return frame
        yield Task(lambda _: None, 0.0, 0.0)
    name = surface.get().name
    raise ScatterError(f"Surface '{name}' has no faces from frame {first} to {last}")


def read_frame(
    held: Held, surface: Held, frame: int, kind: str, masks: Masks | None = None
) -> SurfaceArrays:
    """The surface on a frame of a bake, without faces only where that may be; with what its density
    takes there, if masks are given.
    """
    bare = _keeps_density(held.get())
    if masks is None:
        arrays = at_frame(surface, frame, kind=kind, may_be_bare=bare)
    else:
        arrays = masks.at_frame(surface, held, frame, kind, bare)
    if not (len(arrays.faces) or may_be_bare(held.get(), kind)):
        raise ScatterError(_refused(held.get(), surface.get().name, frame))
    return arrays


def appeared(
    baker: Baker, held: Held, surface: Held, arrays: SurfaceArrays, known: Known | None
) -> SurfaceArrays:
    """Have points appear on faces that have come back; the frame."""
    number = baker.first + baker.done
    then = at_frame(surface, number, settings=baker.start.settings, own=held, known=known)
    baker.appear(replace(then, rest=arrays.rest))
    return replace(then, rest=arrays.rest) if baker.follows else arrays


def _keeps_density(obj: bpy.types.Object) -> bool:
    return bool(obj.dapple.count_over_time == "KEEP_DENSITY")


def _refused(obj: bpy.types.Object, name: str, frame: int) -> str:
    said = f"Surface '{name}' has no faces at frame {frame}"
    if len(obj.dapple.classes):
        return f"{said}: points of object types cannot appear again behind it"
    return f"{said}: set New Topology to Reattach to have no points there"
