# SPDX-License-Identifier: GPL-3.0-or-later
"""The tile object: mesh, colors, material, node group."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats, SurfaceArrays
from ...core.surface.records import REST_ATTRIBUTES, ROW_ATTRIBUTES, Binding
from ...core.tiles import Tiles
from ...nodes import set_input, tiles
from ...nodes.builder import ensure
from ..base.mesh_arrays import read_points, to_local, write_columns
from ..base.quiet import quiet
from ..scatter.linked_data import open_collections, read_only
from ..scatter.object import is_scatter
from ..surface.current_binding import rest_of

COLOR = "Color"
_FACE_ATTRIBUTES = {"cell": "cells", "dapple_object_type": "classes"}
_OFFSET = {tiles.OFFSET: "FLOAT_VECTOR"}


def check_tile_object(obj: bpy.types.Object) -> None:
    """ScatterError if the tiles of a scatter would overwrite another mesh."""
    made, surface = obj.dapple.tiles.object, obj.dapple.surface
    if made is None:
        return
    if made.type != "MESH" or is_scatter(made) or made.data == surface.data:
        raise ScatterError(
            f"'{made.name}' cannot hold the tiles of '{obj.name}', which would replace its "
            "mesh: choose another object, or none to create one"
        )
    if made.mode != "OBJECT":
        raise ScatterError(f"The tiles '{made.name}' are not in Object Mode: switch to it first")


def write_tiles(obj: bpy.types.Object, tiles: Tiles) -> bpy.types.Object:
    """Write tiles into the tile object of a scatter; its modifiers and materials stay."""
    made = _own_object(obj)
    _align(made, obj.dapple.surface)
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
    """The object for a scatter's tiles in a scene: the existing one, or a new one.

    An object that a copy of the scatter has too, or that is linked from another file, is copied.
    """
    made = obj.dapple.tiles.object
    if made is None or not made.users_collection:  # it was deleted, only its user count is left
        name = f"{obj.name} Tiles"
        made = bpy.data.objects.new(name, bpy.data.meshes.new(name))
        _assign_tiles(obj, made)
    elif read_only(made) or _others(obj, made):
        mesh = made.data.copy()
        made = made.copy()
        made.data = mesh
        _assign_tiles(obj, made)
    elif made.data.library is not None:
        made.data = made.data.copy()
    return made


def _others(obj: bpy.types.Object, made: bpy.types.Object) -> bool:
    """Whether another scatter has the same object for its tiles."""
    scatters = (one for one in bpy.data.objects if one != obj and is_scatter(one))
    return any(one.dapple.tiles.object == made for one in scatters)


def _assign_tiles(obj: bpy.types.Object, made: bpy.types.Object) -> None:
    """Assign a tile object to a scatter, and parent it to the surface."""
    surface = obj.dapple.surface
    for collection in open_collections(obj) or [bpy.context.scene.collection]:
        collection.objects.link(made)
    made.parent = surface
    made.matrix_world = surface.matrix_world
    obj.dapple.tiles.object = made
    bpy.context.view_layer.update()


def _align(made: bpy.types.Object, surface: bpy.types.Object) -> None:
    """Give tiles the space of the surface, in which they follow it."""
    if made.matrix_world != surface.matrix_world:
        made.matrix_world = surface.matrix_world
        bpy.context.view_layer.update()


def _material() -> bpy.types.Material:
    """A new material that shows the color attribute."""
    made = bpy.data.materials.new("Dapple Tiles")
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    attribute = nodes.new("ShaderNodeVertexColor")
    attribute.layer_name = COLOR
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    links.new(attribute.outputs["Color"], shader.inputs["Base Color"])
    return made


def attach_tiles(
    obj: bpy.types.Object, made: bpy.types.Object, arrays: SurfaceArrays, binding: Binding
) -> None:
    """Bind the vertices of a scatter's tiles to its surface, so that they follow it.

    The tiles are at the surface. If the artist moves them away, they deform there.
    """
    surface = obj.dapple.surface
    rest = rest_of(surface, arrays, binding, obj.dapple.attached_to)
    write_columns(made.data, binding.rows(), ROW_ATTRIBUTES)
    if rest is not None:
        write_columns(made.data, rest.columns, REST_ATTRIBUTES)
    inputs = {
        "Surface": surface,
        "Surface Vertices": len(arrays.vertices),
        "Rest Binding": rest is not None,
        "Rest Parts": 1 if rest is None else rest.parts,
    }
    _write_offsets(made.data, inputs)
    modifier = _modifier(made)
    for name, value in inputs.items():
        set_input(modifier, name, value)


def _modifier(made: bpy.types.Object) -> bpy.types.NodesModifier:
    """The modifier that moves the tiles; it is the first one, before a bevel, for example."""
    group = ensure(tiles.TILES)
    own = (one for one in made.modifiers if one.type == "NODES" and _moves(one.node_group))
    modifier = next(own, None)
    if modifier is None:
        modifier = made.modifiers.new(tiles.TILES.name, "NODES")
        made.modifiers.move(len(made.modifiers) - 1, 0)
    if modifier.node_group != group:
        modifier.node_group = group
    return modifier


def _moves(group: bpy.types.NodeTree | None) -> bool:
    return group is not None and group.name.startswith(tiles.TILES.name)


def _write_offsets(mesh: bpy.types.Mesh, inputs: dict[str, object]) -> None:
    """The offsets with which the node group leaves vertices where they are in this frame."""
    before = read_points(mesh)
    with quiet(), _probe(mesh, inputs) as placed:
        start = placed(np.zeros(3))
        axes = np.stack([placed(axis) - start for axis in np.eye(3)], axis=1)
    offsets = np.einsum("nkd,nd->nk", axes, before - start)
    _write(mesh, offsets)


@contextmanager
def _probe(mesh: bpy.types.Mesh, inputs: dict[str, object]) -> Iterator[Callable[[Floats], Floats]]:
    """A function that returns the places of a mesh's vertices if all have the same offset."""
    probe = bpy.data.objects.new("Probe", mesh)
    bpy.context.scene.collection.objects.link(probe)
    modifier = probe.modifiers.new(tiles.TILES.name, "NODES")
    modifier.node_group = ensure(tiles.TILES)
    for name, value in inputs.items():
        set_input(modifier, name, value)

    def placed(offset: Floats) -> Floats:
        _write(mesh, np.tile(offset, (len(mesh.vertices), 1)))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return read_points(probe.evaluated_get(depsgraph).data)

    try:
        yield placed
    finally:
        bpy.data.objects.remove(probe)


def _write(mesh: bpy.types.Mesh, offsets: Floats) -> None:
    write_columns(mesh, {tiles.OFFSET: offsets.astype(np.float32)}, _OFFSET)
    mesh.update()
