# SPDX-License-Identifier: GPL-3.0-or-later
"""What a preview does, as steps: read the surface, find the places of the points, show them."""

from dataclasses import dataclass

import bpy

from ...core.bake.baker import Start
from ...core.base.errors import ScatterError
from ...core.base.steps import Stepper, Steps, Task
from ...core.preview import Follower
from ...core.surface.mesh_snapshot import RawMesh, surface_of_raw
from ..base.object_handles import Held
from ..scatter.object import settings_of
from ..surface.bound import current_steps, other_faces
from ..surface.mesh_parts import mesh_parts
from ..surface.parts import read_parts
from .preview_binding import is_shown, show_binding


@dataclass
class Preview:
    """A scatter that is previewed, and what its worker knows."""

    scatter: Held
    surface: Held
    follower: Follower | None = None  # once the worker has made it
    mesh: RawMesh | None = None  # that the follower began with or has seen last
    job: Stepper | None = None  # what goes on


def begin_steps(preview: Preview) -> Steps:
    """Read all that the density asks for, have a worker prepare, show what is stored."""
    obj, surface = preview.scatter.get(), preview.surface.get()
    settings = settings_of(obj)
    read = yield from read_parts(settings, preview.surface, preview.scatter)
    arrays = yield Task(lambda _: read.arrays())
    obj, surface = preview.scatter.get(), preview.surface.get()
    if obj.dapple.bound_to == "FACES" and other_faces(obj, arrays):
        raise ScatterError(f"Scatter '{obj.name}' is out of date: {other_faces(obj, arrays)}")
    binding, columns = yield from current_steps(obj, surface, arrays)
    begin = Start(binding, columns["id"], columns["dapple_class"], settings)
    follower = yield Task(lambda context: Follower(arrays, begin, context))
    preview.follower, preview.mesh = follower, read.mesh
    show_binding(preview.scatter.get(), follower.binding)


def follow_steps(preview: Preview) -> Steps:
    """Read the surface, have a worker find the places for its shape, show them."""
    obj, surface = preview.scatter.get(), preview.surface.get()
    if bpy.context.view_layer.objects.get(surface.name) is None:
        raise ScatterError(f"Surface '{surface.name}' is not in the view layer")
    if preview.follower is None or preview.mesh is None:
        return (yield from begin_steps(preview))
    mesh, follower = (yield from mesh_parts(preview.surface, preview.mesh)), preview.follower
    if not mesh.same_faces(preview.mesh):
        if obj.dapple.bound_to == "REST":
            return (yield from begin_steps(preview))
        follower.check((yield Task(lambda _: surface_of_raw(mesh))))
    if mesh.same_place(preview.mesh) and is_shown(obj):
        return None
    budget = obj.dapple.preview_budget / 1000.0
    binding = yield Task(
        lambda context: follower.follow(mesh.vertices(), budget, context, mesh.world_normals())
    )
    obj, preview.mesh = preview.scatter.get(), mesh
    if binding is not None or not is_shown(obj):
        show_binding(obj, follower.binding)
