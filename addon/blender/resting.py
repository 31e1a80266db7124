# SPDX-License-Identifier: GPL-3.0-or-later
"""What points are bound to, faces or the rest position, and Rest Position of the surface.

Metaballs have no rest position and other faces in every frame: their points are bound to places in
the object's own space, as of the frame for which they were solved.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import bpy

from ..core.errors import ScatterError
from ..core.records import Binding, Columns
from ..core.rest import AtRest, at_rest, bound_at_rest
from ..core.steps import Steps, Task, run_now
from ..core.surface import SurfaceArrays
from .held import Held
from .library import read_only
from .meshio import evaluated_mesh, read_rest, to_local
from .scatter import is_fluid
from .staleness import other_faces
from .store import point_columns_of, read_at_rest, read_binding
from .topology import check_render_topology, render_mismatch
from .translation import english


def kind_of_binding(obj: bpy.types.Object, context: bpy.types.Context, bind_to: str) -> str:
    """FACES or REST, as bind_to says for a surface; ScatterError where that cannot be."""
    if is_fluid(obj):
        return _kind_of_fluid(obj, bind_to)
    if bind_to == "AUTO":
        other = obj.type == "MESH" and render_mismatch(obj, context)
        bind_to = "REST" if other else "FACES"
    if bind_to == "FACES":
        check_render_topology(obj, context)
    elif obj.type != "MESH":
        raise ScatterError(
            f"Surface '{obj.name}' is not a mesh and has no rest position: set Attach To to Faces"
        )
    elif read_only(obj) and not obj.add_rest_position_attribute:
        raise ScatterError(f"Rest Position of the surface is off, and {read_only(obj, english)}")
    return bind_to


def _kind_of_fluid(obj: bpy.types.Object, bind_to: str) -> str:
    if bind_to == "FACES":
        raise ScatterError(
            f"Surface '{obj.name}' is a metaball, whose faces change when it moves and in "
            "renders: set Attach To to Automatic"
        )
    with evaluated_mesh(obj, bpy.context.evaluated_depsgraph_get()) as mesh:
        if not len(mesh.polygons):
            raise ScatterError(
                f"Metaball '{obj.name}' has no surface of its own: scatter over the first one of "
                "its family, the name without a number"
            )
    return "REST"


@contextmanager
def rest_position(surface: Held, kind: str) -> Iterator[None]:
    """Have a surface tell its rest position inside, and from then on if all goes well."""
    with rest_position_kept(surface):
        obj = surface.get()
        if kind == "REST" and obj.type == "MESH" and not obj.add_rest_position_attribute:
            obj.add_rest_position_attribute = True
        yield


@contextmanager
def rest_position_kept(surface: Held) -> Iterator[None]:
    """Where what is done inside fails or is given up, Rest Position is as it was."""
    before = surface.get().add_rest_position_attribute
    try:
        yield
    except BaseException:
        _put_back(surface, before)
        raise


def _put_back(surface: Held, before: bool) -> None:
    try:
        obj = surface.get()
    except ScatterError:  # it was removed
        return
    if obj.add_rest_position_attribute != before:
        obj.add_rest_position_attribute = before


def with_rest(arrays: SurfaceArrays, obj: bpy.types.Object) -> SurfaceArrays:
    """A surface that was just read, with its rest shape."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if not is_fluid(obj):
        return replace(arrays, rest=read_rest(obj, depsgraph))
    return replace(arrays, rest=to_local(obj.evaluated_get(depsgraph), arrays.vertices))


def rest_of(
    surface: bpy.types.Object, arrays: SurfaceArrays, binding: Binding, kind: str
) -> AtRest | None:
    """Places on the rest shape, if the points are to be bound to it."""
    return at_rest(binding, with_rest(arrays, surface)) if kind == "REST" else None


def current_binding(
    obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays
) -> tuple[Binding, Columns]:
    """Where a scatter's points are on its surface as it is now, and their columns.

    Those bound to the rest position are found again on other faces.
    """
    found: tuple[Binding, Columns] = run_now(current_steps(obj, surface, arrays))
    return found


def current_steps(obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays) -> Steps:
    """The same in steps."""
    if obj.dapple.bound_to != "REST" or not other_faces(obj, arrays):
        return read_binding(obj, len(arrays.vertices))
    stored, columns = read_at_rest(obj), point_columns_of(obj)
    if arrays.rest is None:
        arrays = with_rest(arrays, surface)
    at_rest_now = replace(arrays, rest_parts=stored.parts)
    found = yield Task(lambda _: bound_at_rest(stored.columns, at_rest_now))
    return found, columns
