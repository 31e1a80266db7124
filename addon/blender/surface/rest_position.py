# SPDX-License-Identifier: GPL-3.0-or-later
"""The kind of a binding, faces or rest position, and the surface's switch Rest Position.

Metaballs have no rest position, and their faces change in every frame: their points are bound to
places in the object's own space at the frame that was solved.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ...core.base.errors import ScatterError
from ..base.object_handles import ObjectHandle
from ..base.translation import english
from ..scatter.linked_data import read_only
from ..scatter.object import is_fluid
from .joined_parts import parts_of
from .mesh import evaluated_mesh
from .subdivision import check_render_topology, render_mismatch


def kind_of_binding(obj: bpy.types.Object, context: bpy.types.Context, attach_to: str) -> str:
    """FACES or REST, according to attach_to; ScatterError if the surface does not support it."""
    if is_fluid(obj):
        return _kind_of_fluid(obj, attach_to)
    if attach_to == "AUTO":
        other = obj.type == "MESH" and render_mismatch(obj, context)
        attach_to = "REST" if other else "FACES"
    if attach_to == "FACES":
        check_render_topology(obj, context)
    elif obj.type != "MESH":
        raise ScatterError(
            f"Surface '{obj.name}' is not a mesh and has no rest position: set Attach To to Faces"
        )
    else:
        _check_rest_can_be_on(obj)
    return attach_to


def _check_rest_can_be_on(obj: bpy.types.Object) -> None:
    for part in _with_rest_position(obj):
        if read_only(part) and not part.add_rest_position_attribute:
            reason = read_only(part, english)
            raise ScatterError(f"Rest Position of the surface is off, and {reason}")


def _with_rest_position(surface: bpy.types.Object) -> list[bpy.types.Object]:
    """The objects of a surface that have an effective Rest Position switch."""
    return [part for part in parts_of(surface) if part.type == "MESH"]


def _kind_of_fluid(obj: bpy.types.Object, attach_to: str) -> str:
    if attach_to == "FACES":
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
def rest_position(surface: ObjectHandle, kind: str) -> Iterator[None]:
    """Enable Rest Position of a surface inside; it stays enabled unless the code inside fails."""
    with rest_position_kept(surface):
        for part in _with_rest_position(surface.get()) if kind == "REST" else ():
            if not part.add_rest_position_attribute:
                part.add_rest_position_attribute = True
        yield


@contextmanager
def rest_position_kept(surface: ObjectHandle) -> Iterator[None]:
    """Restore Rest Position if the code inside fails or is canceled."""
    before = [
        (ObjectHandle(part), part.add_rest_position_attribute)
        for part in _with_rest_position(surface.get())
    ]
    try:
        yield
    except BaseException:
        for part, on in before:
            _restore(part, on)
        raise


def _restore(surface: ObjectHandle, before: bool) -> None:
    try:
        obj = surface.get()
    except ScatterError:  # it was removed
        return
    if obj.add_rest_position_attribute != before:
        obj.add_rest_position_attribute = before
