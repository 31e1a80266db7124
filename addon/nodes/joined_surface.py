# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group of one joined surface: the meshes of several objects as one, in a fixed order.

Objects are named one by one, not as a collection: what is scattered on them may then lie in that
collection too, and their order does not change with names.
"""

from dataclasses import dataclass

import bpy

from . import instanced_part, part
from .builder import Builder, Socket, new_group
from .groups import inner

KEY = "dapple_joined"  # of a node group that joins
Offset = tuple[float, float, float]


@dataclass(frozen=True)
class Joined:
    """An object whose mesh is joined, or one that instances a collection of others."""

    object: bpy.types.Object | None  # None: it was deleted
    inside: int  # index of what instances it; -1: it is in the scene
    instances: bool  # whether it stands for the objects of a collection
    rest_scale: float = 1.0
    rest_shift: Offset = (0.0, 0.0, 0.0)


def build(name: str, joined: list[Joined]) -> bpy.types.NodeTree:
    """New group; what instances an object comes before that."""
    tree = new_group(name, [], [("Geometry", "NodeSocketGeometry")])
    tree[KEY] = 1
    b = Builder(tree)
    frames: dict[int, Socket] = {}
    meshes: list[Socket] = []
    for index, one in enumerate(joined):
        if one.instances:
            frames[index] = _frame(b, one, frames.get(one.inside))
        else:
            meshes.append(_mesh(b, one, frames.get(one.inside)))
    b.output("Geometry", _in_order(b, meshes))
    b.arrange()
    return tree


def _mesh(b: Builder, one: Joined, frame: Socket | None) -> Socket:
    rest = (one.rest_scale, one.rest_shift)
    if frame is None:
        return inner(b, part.PART, one.object, *rest).outputs["Geometry"]
    return inner(b, instanced_part.INSTANCED_PART, one.object, frame, *rest).outputs["Geometry"]


def _frame(b: Builder, one: Joined, around: Socket | None) -> Socket:
    """From the space of an instanced collection to that of the joined surface."""
    space = "RELATIVE" if around is None else "ORIGINAL"
    info = b.node("GeometryNodeObjectInfo", one.object, transform_space=space)
    place = info.outputs["Transform"]
    collection = one.object.instance_collection if one.object else None
    offset = collection.instance_offset if collection else (0.0, 0.0, 0.0)
    if around is not None:
        place = b.out("FunctionNodeMatrixMultiply", around, place)
    back = b.out("FunctionNodeCombineTransform", tuple(-value for value in offset))
    return b.out("FunctionNodeMatrixMultiply", place, back)


def _in_order(b: Builder, meshes: list[Socket]) -> Socket:
    """All of them as one; a socket that takes many joins the last link first."""
    node = b.node("GeometryNodeJoinGeometry")
    for mesh in reversed(meshes):
        b.tree.links.new(mesh, node.inputs[0])
    return node.outputs[0]
