# SPDX-License-Identifier: GPL-3.0-or-later
"""An animated object as one new mesh with a shape key for each frame."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.moving_mesh import MovingMesh
from ...core.remesh import Options, remeshed
from ...core.surface.arrays import Floats
from ..base.all_or_nothing import all_or_nothing, once_done
from ..base.mesh_arrays import in_space
from ..base.object_handles import ObjectHandle
from ..base.times import chosen_times
from ..surface.reading import frame_kept
from .density import Chosen, Images
from .shown import Shown, read_first, read_next, read_shown, shown_copy
from .writing import replace_mesh, write_new

_REMESHING = 0.2  # share of the progress
_DEFORMING_PARENTS = {"ARMATURE", "LATTICE", "CURVE"}


@dataclass
class _Bake:
    """What is read and solved before anything is written."""

    handle: ObjectHandle
    mesh: int  # session_uid of the object's mesh
    start: Shown
    moving: MovingMesh
    matrices: list[Floats] = field(default_factory=list)  # of the object, for each frame


def motion_steps(
    context: bpy.types.Context,
    obj: bpy.types.Object,
    count: int,
    chosen: Chosen,
    options: Options,
    frames: tuple[int, int],
) -> Steps:
    """Replace an object's mesh by one with shape keys for a range of frames; returns the
    MovingMesh.
    """
    handle, mesh = ObjectHandle(obj), obj.data.session_uid
    first, last = chosen_times(context.scene, *frames)
    with frame_kept(context.scene):
        old, start = read_first(handle, first, chosen, Images(chosen))
        new = yield Task(lambda worker: remeshed(old, count, options, worker), 0.0, _REMESHING)
        begun = partial(MovingMesh.begun, old.name, first, new)
        bake = _Bake(handle, mesh, start, (yield Task(begun, _REMESHING, _REMESHING)))
        yield from _follow(bake, first, last)
        with all_or_nothing(bpy.context, [handle.get()]):
            _write(bake)
    return bake.moving


def _follow(bake: _Bake, first: int, last: int) -> Any:
    """Read and solve all frames."""
    bake.matrices.append(bake.start.matrix)
    share = (1.0 - _REMESHING) / max(last - first, 1)
    for k in range(last - first):
        shown = read_next(bake.handle, first + k + 1, bake.start, first)
        bake.matrices.append(shown.matrix)
        advance = partial(bake.moving.advance, shown.vertices)
        yield Task(advance, _REMESHING + share * k, _REMESHING + share * (k + 1))


def _write(bake: _Bake) -> None:
    """The new mesh with the data of the shown one, and its keys."""
    obj, moving = bake.handle.get(), bake.moving
    now = read_shown(bake.handle, moving.first)
    if not now.is_like(bake.start) or obj.data.session_uid != bake.mesh or obj.mode != "OBJECT":
        raise ScatterError(f"'{obj.name}' was edited in the meantime: nothing was written")
    places = [
        in_space(matrix, frame.vertices, obj.name)
        for matrix, frame in zip(bake.matrices, moving.frames, strict=True)
    ]
    with shown_copy(obj) as mesh:
        made = write_new(mesh, moving.new)
    replace_mesh(obj, made)
    _write_keys(obj, places, moving.first)
    once_done(lambda: _deform_no_more(obj))  # what is removed cannot be restored


def _write_keys(obj: bpy.types.Object, places: Sequence[Floats], first: int) -> None:
    """A shape key for each frame, which is 1 there and 0 on the others; the first is the basis."""
    obj.shape_key_add(name="Basis", from_mix=False)
    last = first + len(places) - 1
    for frame, vertices in enumerate(places[1:], first + 1):
        key = obj.shape_key_add(name=f"Frame {frame}", from_mix=False)
        key.data.foreach_set("co", vertices.astype(np.float32).ravel())
        for at in range(frame - 1, min(frame + 1, last) + 1):
            key.value = float(at == frame)
            key.keyframe_insert("value", frame=at)
    for curve in _curves(obj.data.shape_keys):
        for keyframe in curve.keyframe_points:
            keyframe.interpolation = "LINEAR"


def _curves(keys: bpy.types.Key) -> list[Any]:
    """The F-curves of shape keys."""
    if keys.animation_data is None or keys.animation_data.action is None:
        return []
    action = keys.animation_data.action
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
    return [curve for bag in bags for curve in bag.fcurves]


def _deform_no_more(obj: bpy.types.Object) -> None:
    """Remove what the keys contain: modifiers that are shown, and the deformation by a parent."""
    for modifier in [one for one in obj.modifiers if one.show_viewport]:
        obj.modifiers.remove(modifier)
    if obj.parent_type in _DEFORMING_PARENTS:
        obj.parent_type = "OBJECT"
