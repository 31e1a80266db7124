# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of a live preview: read the surface, compute the places of the points, show them."""

from collections.abc import Container
from dataclasses import dataclass

import bpy
import numpy as np

from ...core.bake.baker import Start
from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.preview import Follower
from ...core.surface.mesh_snapshot import RawMesh, surface_of_raw
from ...core.surface.records import ROW_ATTRIBUTES, Binding
from ...nodes import get_input, has_input, set_input
from ..base.jobs import Job
from ..base.mesh_arrays import write_columns, write_points
from ..base.object_handles import ObjectHandle
from ..scatter.modifier import ensure_modifier, scatter_modifier
from ..scatter.object import check_all_over, is_scatter, settings_of
from ..surface.current_binding import current_steps, other_faces
from ..surface.mesh import mesh_parts
from ..surface.reading import read_parts

_INPUT = "Preview"


@dataclass
class Preview:
    """A scatter with a preview, and the state of its worker."""

    scatter: ObjectHandle
    surface: ObjectHandle
    follower: Follower | None = None  # None until the worker has made it
    mesh: RawMesh | None = None  # the last one that the follower received
    job: Job | None = None  # the running one


def begin_steps(preview: Preview) -> Steps:
    """Read the surface with the inputs of the density, prepare the follower, show its points."""
    obj, surface = preview.scatter.get(), preview.surface.get()
    check_all_over(obj)
    settings = settings_of(obj)
    read = yield from read_parts(preview.surface, settings, preview.scatter)
    arrays = yield Task(lambda _: read.arrays())
    obj, surface = preview.scatter.get(), preview.surface.get()
    if obj.dapple.attached_to == "FACES" and other_faces(obj, arrays):
        raise ScatterError(f"Scatter '{obj.name}' is out of date: {other_faces(obj, arrays)}")
    binding, columns = yield from current_steps(obj, surface, arrays)
    begin = Start(binding, columns["id"], columns["dapple_object_type"], settings)
    follower = yield Task(lambda context: Follower(arrays, begin, context))
    preview.follower, preview.mesh = follower, read.mesh
    show_binding(preview.scatter.get(), follower.binding)


def follow_steps(preview: Preview) -> Steps:
    """Read the surface, compute the places of the points on it in a worker, show them."""
    obj, surface = preview.scatter.get(), preview.surface.get()
    if bpy.context.view_layer.objects.get(surface.name) is None:
        raise ScatterError(f"Surface '{surface.name}' is not in the view layer")
    if preview.follower is None or preview.mesh is None:
        return (yield from begin_steps(preview))
    mesh, follower = (yield from mesh_parts(preview.surface, preview.mesh)), preview.follower
    if not mesh.same_faces(preview.mesh):
        if obj.dapple.attached_to == "REST":
            return (yield from begin_steps(preview))
        follower.check((yield Task(lambda _: surface_of_raw(mesh))))
    if mesh.same_place(preview.mesh) and is_shown(obj):
        return None
    budget = obj.dapple.preview_budget / 1000.0
    binding = yield Task(
        lambda context: follower.follow(mesh.vertices, budget, context, mesh.world_normals())
    )
    obj, preview.mesh = preview.scatter.get(), mesh
    if binding is not None or not is_shown(obj):
        show_binding(obj, follower.binding)


def show_binding(obj: bpy.types.Object, binding: Binding) -> None:
    """Show a scatter's points with this binding in the viewport."""
    modifier = ensure_modifier(obj)
    store = get_input(modifier, _INPUT)
    if store is not None and (store.type != "MESH" or _INPUT not in store):  # in a damaged file
        set_input(modifier, _INPUT, None)
        store = None
    if store is None:
        label = f"{obj.name} {_INPUT}"
        store = bpy.data.objects.new(label, bpy.data.meshes.new(label))
        store[_INPUT] = True
        store.is_runtime_data = store.data.is_runtime_data = True
    if len(store.data.vertices) != len(binding.angle):
        write_points(store.data, np.zeros((len(binding.angle), 3)))
    write_columns(store.data, binding.rows(), ROW_ATTRIBUTES)
    store.data.update_tag()
    if get_input(modifier, _INPUT) is None:
        set_input(modifier, _INPUT, store)
    if get_input(modifier, "Surface") != obj.dapple.surface:
        set_input(modifier, "Surface", obj.dapple.surface)
    obj.update_tag()


def is_shown(obj: bpy.types.Object) -> bool:
    """Whether the node group of a scatter plays a preview."""
    return get_input(ensure_modifier(obj), _INPUT) is not None


def clear_bindings(keep: Container[int] = ()) -> None:
    """Remove the bindings of previews from the file, except those of some scatters."""
    for obj in bpy.data.objects:
        if is_scatter(obj) and obj.session_uid not in keep:
            _unlink(obj)
    _remove_unused()


def _unlink(obj: bpy.types.Object) -> None:
    modifier = scatter_modifier(obj)
    if modifier is None or not has_input(modifier, _INPUT):
        return
    if get_input(modifier, _INPUT) is not None:
        set_input(modifier, _INPUT, None)
        obj.update_tag()


def _remove_unused() -> None:
    for store in [item for item in bpy.data.objects if _INPUT in item and item.users == 0]:
        mesh = store.data
        bpy.data.objects.remove(store)
        bpy.data.meshes.remove(mesh)
