# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles that deform with their surface, in every frame: by a node group, as points do."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from ...core.surface.arrays import Floats, SurfaceArrays
from ...core.surface.records import REST_ATTRIBUTES, ROW_ATTRIBUTES, Binding
from ...nodes import set_input, tiles
from ...nodes.groups import ensure
from ..base.mesh_arrays import read_points, write_columns
from ..base.quiet import quiet
from ..surface.bound import rest_of

_OFFSET = {tiles.OFFSET: "FLOAT_VECTOR"}


def have_follow(
    obj: bpy.types.Object, made: bpy.types.Object, arrays: SurfaceArrays, binding: Binding
) -> None:
    """Have the tiles of a scatter follow its surface, on which their vertices are bound.

    They are where the surface is then; moved away, they deform there.
    """
    surface = obj.dapple.surface
    rest = rest_of(surface, arrays, binding, obj.dapple.bound_to)
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
    """The one that moves the tiles; the first, as others bevel or smooth what it has moved."""
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
    """Where vertices of a mesh are put with one offset for all of them."""
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
