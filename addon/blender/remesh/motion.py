# SPDX-License-Identifier: GPL-3.0-or-later
"""An animated object as one new mesh with a shape key for each frame."""

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
from ..base.times import chosen_times, show_time
from ..surface.reading import frame_kept
from .density import Chosen, Images
from .frame_meshes import UnusedMeshes, check_same, mesh_of_frame
from .new_object import Remeshed, deform_by_no_parent, show_mesh
from .shown import check_faces, read_first, read_next

_REMESHING = 0.2  # share of the progress


def motion_steps(
    context: bpy.types.Context,
    obj: bpy.types.Object,
    count: int,
    chosen: Chosen,
    options: Options,
    frames: tuple[int, int],
) -> Steps:
    """Replace an object's mesh by one with shape keys for a range of frames; a curve, text or
    metaball is hidden, and a new object shows the mesh. Returns Remeshed with the MovingMesh.

    The key of a frame is written before the next frame is read, so that no step takes long and
    none of them is in memory twice.
    """
    handle, mesh = ObjectHandle(obj), obj.data.session_uid
    first, last = chosen_times(context.scene, *frames)
    made = UnusedMeshes()
    with frame_kept(context.scene), made.removed_if_unused():
        old, start = read_first(handle, first, chosen, Images(chosen))
        check_faces(handle.get(), old)
        new = yield Task(lambda worker: remeshed(old, count, options, worker), 0.0, _REMESHING)
        made.add(mesh_of_frame(handle, first, new, start))
        begun = partial(MovingMesh.begun, old.name, first, new)
        moving = yield Task(begun, _REMESHING, _REMESHING)
        share = (1.0 - _REMESHING) / max(last - first, 1)
        for k in range(last - first):
            shown = read_next(handle, first + k + 1, start, first)
            advance = partial(moving.advance, shown.vertices)
            places = yield Task(advance, _REMESHING + share * k, _REMESHING + share * (k + 1))
            _add_key(made.all(old.name)[0], first + k + 1, in_space(shown.matrix, places, old.name))
        show_time(bpy.context.scene, first)
        check_same(handle.get(), start)
        with all_or_nothing(bpy.context, [handle.get()]):
            new_obj = _write(handle.get(), mesh, made, (first, last))
    return Remeshed(ObjectHandle(new_obj), moving)


def _add_key(mesh: bpy.types.Mesh, frame: int, vertices: Floats) -> None:
    """A shape key for a frame, after the basis."""
    obj = bpy.data.objects.new(mesh.name, mesh)  # only objects can add keys
    try:
        _add_basis(obj)
        key = obj.shape_key_add(name=f"Frame {frame}", from_mix=False)
        key.data.foreach_set("co", vertices.astype(np.float32).ravel())
    finally:
        bpy.data.objects.remove(obj)


def _add_basis(obj: bpy.types.Object) -> None:
    """The shape key of the first frame, if there are no keys yet."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis", from_mix=False)


def _write(
    obj: bpy.types.Object, data: int, made: UnusedMeshes, frames: tuple[int, int]
) -> bpy.types.Object:
    """Show the new mesh, and animate its keys; returns the object that shows it."""
    if obj.data.session_uid != data or obj.mode != "OBJECT":
        raise ScatterError(f"'{obj.name}' was edited in the meantime: nothing was written")
    shown = show_mesh(obj, made.all(obj.name)[0])
    _add_basis(shown)
    _write_motion(shown.data.shape_keys, *frames)
    if shown.data.shape_keys.animation_data is not None:  # none for one frame
        shown.data.shape_keys.animation_data.action.name = f"{obj.name} Keys"
    if shown == obj:
        once_done(lambda: _deform_no_more(obj))  # what is removed cannot be restored
    return shown


def _write_motion(keys: bpy.types.Key, first: int, last: int) -> None:
    """Each key after the first is 1 on its frame and 0 on the others."""
    for frame, key in enumerate(keys.key_blocks[1:], first + 1):
        for at in range(frame - 1, min(frame + 1, last) + 1):
            key.value = float(at == frame)
            key.keyframe_insert("value", frame=at)
    for curve in _curves(keys):
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
    deform_by_no_parent(obj)
