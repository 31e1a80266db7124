# SPDX-License-Identifier: GPL-3.0-or-later
"""An animated object whose faces change, such as a fluid, as a new object with a mesh per frame."""

from functools import partial

import bpy
import numpy as np
from mathutils import Matrix

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.mesh_sequence import MeshSequence
from ...core.remesh import Options
from ...core.surface.arrays import Floats
from ...nodes.builder import ensure
from ...nodes.inputs import set_input
from ...nodes.sequence import SEQUENCE
from ..base.all_or_nothing import all_or_nothing, once_done
from ..base.object_handles import ObjectHandle
from ..base.times import chosen_times
from ..surface.reading import frame_kept
from .shown import Shown, read_first, shown_copy
from .writing import write_new

_ID = "id"  # Blender's own name for what stays the same from frame to frame


def sequence_steps(
    context: bpy.types.Context,
    obj: bpy.types.Object,
    count: int,
    density: str,
    options: Options,
    frames: tuple[int, int],
) -> Steps:
    """Make a new object that shows a new mesh on each of a range of frames; the object is hidden.
    Returns the MeshSequence.
    """
    handle = ObjectHandle(obj)
    first, last = chosen_times(context.scene, *frames)
    if options["adaptive"]:
        raise ScatterError("Adaptive is for one mesh: a sequence keeps its spacing")
    given = {name: value for name, value in options.items() if name != "adaptive"}
    sequence = MeshSequence(obj.name, first, count, given)
    shown = []
    with frame_kept(context.scene):
        for k in range(last - first + 1):
            old, on_frame = read_first(handle, first + k, density)
            shown.append(on_frame)
            share = 1.0 / (last - first + 1)
            yield Task(partial(sequence.advance, old), share * k, share * (k + 1))
        sequence.check()
        with all_or_nothing(bpy.context, [handle.get()]):
            _write(handle.get(), sequence, shown)
    return sequence


def _write(obj: bpy.types.Object, sequence: MeshSequence, shown: list[Shown]) -> None:
    """The meshes in a collection that no scene has, and an object that shows them."""
    frames = bpy.data.collections.new(f"{obj.name} Frames")
    start = np.linalg.inv(shown[0].matrix)
    for k, before in enumerate(shown):
        mesh = _mesh_of_frame(obj, sequence, k, before)
        mesh.transform(_matrix(start @ before.matrix))
        frames.objects.link(bpy.data.objects.new(f"{k:06d} {obj.name}", mesh))
    made = bpy.data.objects.new(f"{obj.name} Remeshed", bpy.data.meshes.new(f"{obj.name} Remeshed"))
    for material in obj.data.materials:
        made.data.materials.append(material)
    made.matrix_world = _matrix(shown[0].matrix)
    for collection in obj.users_collection:
        collection.objects.link(made)
    modifier = made.modifiers.new(SEQUENCE.name, "NODES")
    modifier.node_group = ensure(SEQUENCE)
    set_input(modifier, "Frames", frames)
    set_input(modifier, "Start", sequence.first)
    once_done(partial(_show_instead, ObjectHandle(obj), ObjectHandle(made)))


def _mesh_of_frame(
    obj: bpy.types.Object, sequence: MeshSequence, k: int, before: Shown
) -> bpy.types.Mesh:
    """The new mesh of a frame with the data of the shown one; an empty one without faces."""
    frame = sequence.frames[k]
    if frame is None:
        return bpy.data.meshes.new(obj.name)
    _, now = read_first(ObjectHandle(obj), sequence.first + k, "")
    if not now.is_like(before):
        raise ScatterError(f"'{obj.name}' was edited in the meantime: nothing was written")
    with shown_copy(obj) as old:
        mesh = write_new(old, frame.new)
    mesh.name = obj.name
    if _ID in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[_ID])
    mesh.attributes.new(_ID, "INT", "POINT").data.foreach_set("value", frame.made.ids)
    return mesh


def _matrix(rows: Floats) -> Matrix:
    return Matrix(rows.tolist())


def _show_instead(obj: ObjectHandle, made: ObjectHandle) -> None:
    """Hide the old object and select the new one."""
    old, new = obj.get(), made.get()
    old.hide_render = True
    old.select_set(False)
    old.hide_set(True)
    new.select_set(True)
    bpy.context.view_layer.objects.active = new
