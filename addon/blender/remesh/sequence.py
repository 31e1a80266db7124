# SPDX-License-Identifier: GPL-3.0-or-later
"""An animated object whose faces change, such as a fluid, as a new object with a mesh per frame."""

from collections.abc import Sequence
from functools import partial

import bpy
import numpy as np
from mathutils import Matrix

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.mesh_sequence import MeshSequence, SequenceFrame
from ...core.remesh import Options
from ...core.surface.arrays import Floats
from ...nodes.builder import ensure
from ...nodes.inputs import set_input
from ...nodes.sequence import SEQUENCE
from ..base.all_or_nothing import all_or_nothing
from ..base.object_handles import ObjectHandle
from ..base.times import chosen_times
from ..surface.reading import frame_kept
from .density import Chosen, Images
from .frame_meshes import UnusedMeshes, mesh_of_frame
from .new_object import Remeshed, object_instead
from .shown import Shown, read_first

_ID = "id"  # Blender's own name for what stays the same from frame to frame


def sequence_steps(
    context: bpy.types.Context,
    obj: bpy.types.Object,
    count: int,
    chosen: Chosen,
    options: Options,
    frames: tuple[int, int],
) -> Steps:
    """Make a new object that shows a new mesh on each of a range of frames; the object is hidden.
    Returns Remeshed with the MeshSequence.

    The mesh of a frame is written before the next frame is read, so that no step takes long and
    only one of them is in memory twice.
    """
    handle = ObjectHandle(obj)
    first, last = chosen_times(context.scene, *frames)
    if options["adaptive"]:
        raise ScatterError("Adaptive is for one mesh: a sequence keeps its spacing")
    given = {name: value for name, value in options.items() if name != "adaptive"}
    sequence, made = MeshSequence(obj.name, first, count, given), UnusedMeshes()
    share, images = 1.0 / (last - first + 1), Images(chosen)
    matrices: list[Floats] = []  # of the object
    with frame_kept(context.scene), made.removed_if_unused():
        for k in range(last - first + 1):
            old, shown = read_first(handle, first + k, chosen, images)
            advance = partial(sequence.advance, old)
            frame = yield Task(advance, share * k, share * (k + 1))
            made.add(_mesh_of_frame(handle, first + k, frame, shown))
            matrices.append(shown.matrix)
        sequence.check()
        with all_or_nothing(bpy.context, [handle.get()]):
            new = _show(handle.get(), made, matrices, first)
    return Remeshed(ObjectHandle(new), sequence)


def _mesh_of_frame(
    handle: ObjectHandle, number: int, frame: SequenceFrame | None, before: Shown
) -> bpy.types.Mesh:
    """The new mesh of a frame and the numbers of its vertices; an empty one without faces."""
    name = handle.get().name
    if frame is None:
        return bpy.data.meshes.new(name)
    mesh = mesh_of_frame(handle, number, frame.new, before)
    mesh.name = name
    if _ID in mesh.attributes:
        mesh.attributes.remove(mesh.attributes[_ID])
    mesh.attributes.new(_ID, "INT", "POINT").data.foreach_set("value", frame.ids)
    return mesh


def _show(
    obj: bpy.types.Object, made: UnusedMeshes, matrices: Sequence[Floats], first: int
) -> bpy.types.Object:
    """The meshes in a collection that no scene has, and an object that shows them."""
    frames = bpy.data.collections.new(f"{obj.name} Frames")
    start = np.linalg.inv(matrices[0])
    for k, (mesh, matrix) in enumerate(zip(made.all(obj.name), matrices, strict=True)):
        mesh.transform(_matrix(start @ matrix))
        frames.objects.link(bpy.data.objects.new(f"{k:06d} {obj.name}", mesh))
    new = object_instead(obj, bpy.data.meshes.new(f"{obj.name} Remeshed"))
    for material in obj.data.materials:
        new.data.materials.append(material)
    new.matrix_world = _matrix(matrices[0])
    modifier = new.modifiers.new(SEQUENCE.name, "NODES")
    modifier.node_group = ensure(SEQUENCE)
    set_input(modifier, "Frames", frames)
    set_input(modifier, "Start", first)
    return new


def _matrix(rows: Floats) -> Matrix:
    return Matrix(rows.tolist())
