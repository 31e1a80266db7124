# SPDX-License-Identifier: GPL-3.0-or-later
"""What points are bound to, faces or the rest position, and Rest Position of the surface.

Metaballs have no rest position and other faces in every frame: their points are bound to places in
the object's own space, as of the frame for which they were solved.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ...core.errors import ScatterError
from ..base.held import Held
from ..base.translation import english
from ..data.library import read_only
from ..data.scatter import is_fluid
from .surface_mesh import evaluated_mesh
from .topology import check_render_topology, render_mismatch


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
    """Have Rest Position of a surface on inside, and from then on if nothing fails."""
    with rest_position_kept(surface):
        obj = surface.get()
        if kind == "REST" and obj.type == "MESH" and not obj.add_rest_position_attribute:
            obj.add_rest_position_attribute = True
        yield


@contextmanager
def rest_position_kept(surface: Held) -> Iterator[None]:
    """Set Rest Position back where what is done inside fails or is canceled."""
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
