# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles as an object: its mesh, attributes, colours and a material that shows them."""

import bpy
import numpy as np

from ..core.tiles import Tiles
from .meshio import to_local

COLOUR = "Colour"
_FACE_ATTRIBUTES = {"cell": "cells", "dapple_class": "classes"}


def write_tiles(obj: bpy.types.Object, tiles: Tiles) -> bpy.types.Object:
    """Make the tile object of a scatter these tiles; its modifiers and materials stay."""
    made = obj.dapple.tiles.object or _new_object(obj)
    mesh = made.data
    mesh.clear_geometry()
    mesh.vertices.add(len(tiles.vertices))
    mesh.loops.add(len(tiles.corners))
    mesh.polygons.add(len(tiles.starts))
    places = to_local(made, tiles.vertices)
    mesh.vertices.foreach_set("co", places.astype(np.float32).ravel())
    mesh.loops.foreach_set("vertex_index", tiles.corners)
    mesh.polygons.foreach_set("loop_start", tiles.starts)
    for name, field in _FACE_ATTRIBUTES.items():
        attribute = mesh.attributes.new(name, "INT", "FACE")
        attribute.data.foreach_set("value", np.ascontiguousarray(getattr(tiles, field)))
    colours = mesh.color_attributes.new(COLOUR, "FLOAT_COLOR", "POINT")
    colours.data.foreach_set("color", tiles.colours.astype(np.float32).ravel())
    mesh.update(calc_edges=True)
    if not mesh.materials:
        mesh.materials.append(_material())
    return made


def _new_object(obj: bpy.types.Object) -> bpy.types.Object:
    """An empty one beside the scatter, that moves with its surface."""
    surface, name = obj.dapple.surface, f"{obj.name} Tiles"
    made = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    for collection in obj.users_collection:
        collection.objects.link(made)
    made.parent = surface
    made.matrix_world = surface.matrix_world
    obj.dapple.tiles.object = made
    bpy.context.view_layer.update()
    return made


def _material() -> bpy.types.Material:
    """Shows the colour attribute."""
    made = bpy.data.materials.new("Dapple Tiles")
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    attribute = nodes.new("ShaderNodeVertexColor")
    attribute.layer_name = COLOUR
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
    return made
