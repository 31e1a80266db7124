# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group of one joined surface: the meshes of several objects as one, in a fixed order.

Objects are listed one by one, not as a collection. So the scatter on them can be in the same
collection, and their order does not depend on names.
"""

from dataclasses import dataclass

import bpy

from .builder import Builder, Group, Socket, inner, new_group

KEY = "dapple_joined"  # custom property of such a node group
Offset = tuple[float, float, float]
REST_INPUTS = [("Rest Scale", "NodeSocketFloat"), ("Rest Shift", "NodeSocketVector")]


@dataclass(frozen=True)
class Joined:
    """An object whose mesh is joined, or an object that instances a collection of others."""

    object: bpy.types.Object | None  # None if it was deleted
    inside: int  # index of the instancing object; -1 for an object of the scene
    instances: bool  # whether it instances the objects of a collection
    rest_scale: float = 1.0
    rest_shift: Offset = (0.0, 0.0, 0.0)


def build(name: str, joined: list[Joined]) -> bpy.types.NodeTree:
    """New group; an instancing object comes before the objects that it instances."""
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
        return inner(b, PART, one.object, *rest).outputs["Geometry"]
    return inner(b, INSTANCED_PART, one.object, frame, *rest).outputs["Geometry"]


def _frame(b: Builder, one: Joined, around: Socket | None) -> Socket:
    """Transform from the space of an instanced collection to that of the joined surface."""
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
    """All meshes as one; Join Geometry uses the last link first."""
    node = b.node("GeometryNodeJoinGeometry")
    for mesh in reversed(meshes):
        b.tree.links.new(mesh, node.inputs[0])
    return node.outputs[0]


def _build_instanced_part() -> bpy.types.NodeTree:
    """New group; Frame is from the space of the collection to that of the joined surface."""
    tree = new_group(
        INSTANCED_PART.name,
        [("Object", "NodeSocketObject"), ("Frame", "NodeSocketMatrix"), *REST_INPUTS],
        [("Geometry", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    own = b.node("GeometryNodeObjectInfo", b.input("Object"), transform_space="ORIGINAL")
    place = b.out("FunctionNodeMatrixMultiply", b.input("Frame"), own.outputs["Transform"])
    rest = [b.input(name) for name, _ in REST_INPUTS]
    placed = inner(b, PLACED_PART, own.outputs["Geometry"], place, *rest)
    b.output("Geometry", placed.outputs["Geometry"])
    b.arrange()
    return tree


INSTANCED_PART = Group("Dapple Instanced Part", _build_instanced_part)


def _build_part() -> bpy.types.NodeTree:
    """New group."""
    tree = new_group(
        PART.name,
        [("Object", "NodeSocketObject"), *REST_INPUTS],
        [("Geometry", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    here = b.node("GeometryNodeObjectInfo", b.input("Object"), transform_space="RELATIVE")
    own = b.node("GeometryNodeObjectInfo", b.input("Object"), transform_space="ORIGINAL")
    rest = [b.input(name) for name, _ in REST_INPUTS]
    feeds = (own.outputs["Geometry"], here.outputs["Transform"], *rest)
    b.output("Geometry", inner(b, PLACED_PART, *feeds).outputs["Geometry"])
    b.arrange()
    return tree


PART = Group("Dapple Part", _build_part)


def _build_placed_part() -> bpy.types.NodeTree:
    """New group; Matrix is from the part's own space to that of the joined surface."""
    tree = new_group(
        PLACED_PART.name,
        [("Geometry", "NodeSocketGeometry"), ("Matrix", "NodeSocketMatrix"), *REST_INPUTS],
        [("Geometry", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    position = b.out("GeometryNodeInputPosition")
    mesh = b.out("GeometryNodeSeparateComponents", b.input("Geometry"))
    mesh = b.store(mesh, "rest_position", _rest(b, position), "FLOAT_VECTOR")
    place = b.out("FunctionNodeTransformPoint", position, b.input("Matrix"))
    mesh = b.out("GeometryNodeSetPosition", mesh, True, place)
    side = b.out("FunctionNodeMatrixDeterminant", b.input("Matrix"))
    mirrored = b.compare("LESS_THAN", side, 0.0, "FLOAT")
    b.output("Geometry", b.out("GeometryNodeFlipFaces", mesh, mirrored))
    b.arrange()
    return tree


PLACED_PART = Group("Dapple Placed Part", _build_placed_part)


def _rest(b: Builder, position: Socket) -> Socket:
    """Rest position of a vertex; its position if there is none."""
    own = b.attribute_or("rest_position", "FLOAT_VECTOR", "VECTOR", position)
    return b.vector("ADD", b.scaled(own, b.input("Rest Scale")), b.input("Rest Shift"))
