# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles as an object: its mesh, attributes, colors and a material that shows them."""

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.tiles import Tiles
from ..base.mesh_arrays import to_local
from ..scatter.library import open_collections, read_only
from ..scatter.object import is_scatter

COLOR = "Color"
_FACE_ATTRIBUTES = {"cell": "cells", "dapple_class": "classes"}


def check_tile_object(obj: bpy.types.Object) -> None:
    """ScatterError if the tiles of a scatter would be written over something else."""
    made, surface = obj.dapple.tiles.object, obj.dapple.surface
    if made is None:
        return
    if made.type != "MESH" or is_scatter(made) or made.data == surface.data:
        raise ScatterError(
            f"'{made.name}' cannot hold the tiles of '{obj.name}', which would replace its "
            "mesh: choose another object, or none to create one"
        )
    if made.mode != "OBJECT":
        raise ScatterError(f"The tiles '{made.name}' are not in Object Mode: leave the mode first")


def write_tiles(obj: bpy.types.Object, tiles: Tiles) -> bpy.types.Object:
    """Make the tile object of a scatter these tiles; its modifiers and materials stay."""
    made = _own_object(obj)
    _lay_on(made, obj.dapple.surface)
    mesh, places = made.data, to_local(made, tiles.vertices)
    mesh.clear_geometry()
    mesh.vertices.add(len(tiles.vertices))
    mesh.loops.add(len(tiles.corners))
    mesh.polygons.add(len(tiles.starts))
    mesh.vertices.foreach_set("co", places.astype(np.float32).ravel())
    mesh.loops.foreach_set("vertex_index", tiles.corners)
    mesh.polygons.foreach_set("loop_start", tiles.starts)
    for name, field in _FACE_ATTRIBUTES.items():
        attribute = mesh.attributes.new(name, "INT", "FACE")
        attribute.data.foreach_set("value", np.ascontiguousarray(getattr(tiles, field)))
    colors = mesh.color_attributes.new(COLOR, "FLOAT_COLOR", "POINT")
    colors.data.foreach_set("color", tiles.colors.astype(np.float32).ravel())
    mesh.update(calc_edges=True)
    if not mesh.materials:
        mesh.materials.append(_material())
    return made


def _own_object(obj: bpy.types.Object) -> bpy.types.Object:
    """The object for a scatter's tiles, in a scene: the one before, or a new one.

    Of one that a copy of the scatter has too, or that lies in another file, a copy is taken.
    """
    made = obj.dapple.tiles.object
    if made is None or not made.users_collection:  # it was deleted, only its user count is left
        name = f"{obj.name} Tiles"
        made = bpy.data.objects.new(name, bpy.data.meshes.new(name))
        _put_beside(obj, made)
    elif read_only(made) or _others(obj, made):
        mesh = made.data.copy()
        made = made.copy()
        made.data = mesh
        _put_beside(obj, made)
    elif made.data.library is not None:
        made.data = made.data.copy()
    return made


def _others(obj: bpy.types.Object, made: bpy.types.Object) -> bool:
    """Whether another scatter has the same object for its tiles."""
    scatters = (one for one in bpy.data.objects if one != obj and is_scatter(one))
    return any(one.dapple.tiles.object == made for one in scatters)


def _put_beside(obj: bpy.types.Object, made: bpy.types.Object) -> None:
    """Have a scatter own an object for its tiles, which moves with the surface."""
    surface = obj.dapple.surface
    for collection in open_collections(obj) or [bpy.context.scene.collection]:
        collection.objects.link(made)
    made.parent = surface
    made.matrix_world = surface.matrix_world
    obj.dapple.tiles.object = made
    bpy.context.view_layer.update()


def _lay_on(made: bpy.types.Object, surface: bpy.types.Object) -> None:
    """Have tiles be in the surface's own space, in which they follow it."""
    if made.matrix_world != surface.matrix_world:
        made.matrix_world = surface.matrix_world
        bpy.context.view_layer.update()


def _material() -> bpy.types.Material:
    """Shows the color attribute."""
    made = bpy.data.materials.new("Dapple Tiles")
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    attribute = nodes.new("ShaderNodeVertexColor")
    attribute.layer_name = COLOR
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
    return made
