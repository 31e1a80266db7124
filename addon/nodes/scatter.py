# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: bound points -> instances on the surface of the current (sub-)frame."""

import bpy

from . import bound_point
from .builder import Builder, Socket, new_group

GROUP_NAME = "Dapple Scatter"
VERSION = 1
VERSION_KEY = "dapple_version"

INPUTS = [
    ("Geometry", "NodeSocketGeometry"),
    ("Surface", "NodeSocketObject"),
    ("Surface Vertices", "NodeSocketInt"),
    ("Keys", "NodeSocketObject"),
    ("Key Points", "NodeSocketInt"),
    ("First Frame", "NodeSocketInt"),
    ("Instance", "NodeSocketObject"),
    ("Spacing", "NodeSocketFloat"),
    ("Scale", "NodeSocketFloat"),
    ("Scale Randomness", "NodeSocketFloat"),
    ("Turn Randomness", "NodeSocketFloat"),
]


def ensure_group() -> bpy.types.NodeTree:
    """The group of this version in the open file, built if there is none."""
    for group in bpy.data.node_groups:
        if group.library is None and group.get(VERSION_KEY) == VERSION:
            return group
    return build()


def build() -> bpy.types.NodeTree:
    """New group, marked with its version."""
    tree = new_group(GROUP_NAME, INPUTS, [("Geometry", "NodeSocketGeometry")])
    tree.is_modifier = True
    tree[VERSION_KEY] = VERSION
    b = Builder(tree)
    info = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="RELATIVE")
    keys, baked = _keys(b)
    points = _placed(b, info, keys)
    fits = _guards(b, info.outputs["Geometry"], baked)
    b.output("Geometry", b.switch("GEOMETRY", fits, None, _instances(b, points)))
    b.arrange()
    return tree


def _keys(b: Builder) -> tuple[Socket, Socket]:
    """Rows to play: those of the key object if it has any, else the points' own."""
    info = b.node("GeometryNodeObjectInfo", b.input("Keys"), transform_space="ORIGINAL")
    rows = info.outputs["Geometry"]
    baked = b.compare("GREATER_THAN", b.count(rows), 0)
    return b.switch("GEOMETRY", baked, b.input("Geometry"), rows), baked


def _guards(b: Builder, surface: Socket, baked: Socket) -> Socket:
    """True when the stored rows fit the surface and the points; else nodes warn."""
    stale = b.compare("NOT_EQUAL", b.count(surface), b.input("Surface Vertices"))
    lost = b.compare("NOT_EQUAL", b.count(b.input("Geometry")), b.input("Key Points"))
    stale = _warning(b, stale, "The surface has another number of vertices: optimise the scatter")
    lost = _warning(
        b,
        b.boolean("AND", baked, lost),
        "Points were added or removed since the bake: bake again",
    )
    return b.boolean("NOR", stale, lost)


def _warning(b: Builder, show: Socket, message: str) -> Socket:
    return b.out("GeometryNodeWarning", show, message, warning_type="WARNING")


def _placed(b: Builder, info: bpy.types.Node, keys: Socket) -> Socket:
    """Points on the surface, with `rotation` and `scale` attributes."""
    first, second, fraction = _rows(b, keys)
    side = b.number("SIGN", b.out("FunctionNodeMatrixDeterminant", info.outputs[0]))
    surface = info.outputs["Geometry"]
    a, c = (_bound(b, surface, keys, row, side) for row in (first, second))
    position = b.mix("VECTOR", fraction, a.outputs[0], c.outputs[0])
    rotation = b.mix("ROTATION", fraction, a.outputs[1], c.outputs[1])
    turn = b.number("MULTIPLY", b.attribute("dapple_turn", "FLOAT"), b.input("Turn Randomness"))
    points = b.input("Geometry")
    points = b.store(points, "rotation", b.turned(rotation, turn), "QUATERNION")
    points = b.store(points, "scale", _size(b), "FLOAT_VECTOR")
    return b.out("GeometryNodeSetPosition", points, True, position)


def _rows(b: Builder, keys: Socket) -> tuple[Socket, Socket, Socket]:
    """Rows of the two keys around the current frame and the fraction between them.

    Integers count the rows: floats run out of digits beyond 2^24 of them.
    """
    time = b.node("GeometryNodeInputSceneTime").outputs["Frame"]
    frame = b.number("FLOOR", time)
    fraction = b.number("SUBTRACT", time, frame)
    whole = b.out("FunctionNodeFloatToInt", frame, rounding_mode="FLOOR")
    key = b.integer("SUBTRACT", whole, b.input("First Frame"))
    points = b.count(b.input("Geometry"))
    last = b.integer("SUBTRACT", b.integer("DIVIDE", b.count(keys), points), 1)
    index = b.out("GeometryNodeInputIndex")
    rows = []
    for step in (0, 1):
        held = b.integer("MINIMUM", b.integer("ADD", key, step), last)
        held = b.integer("MAXIMUM", held, 0)
        rows.append(b.integer("MULTIPLY_ADD", held, points))
        b.tree.links.new(index, rows[-1].node.inputs[2])
    return rows[0], rows[1], fraction


def _bound(b: Builder, surface: Socket, keys: Socket, row: Socket, side: Socket) -> bpy.types.Node:
    node = b.tree.nodes.new("GeometryNodeGroup")
    node.node_tree = _bound_point_group()
    for socket, feed in zip(node.inputs, (surface, keys, row, side), strict=True):
        b.tree.links.new(feed, socket)
    return node


def _bound_point_group() -> bpy.types.NodeTree:
    for group in bpy.data.node_groups:
        if group.library is None and group.get(VERSION_KEY) == -VERSION:
            return group
    group = bound_point.build()
    group[VERSION_KEY] = -VERSION
    return group


def _size(b: Builder) -> Socket:
    """Scale * (1 - randomness * own random number)."""
    own = b.attribute("dapple_scale", "FLOAT")
    less = b.number("MULTIPLY", own, b.input("Scale Randomness"))
    factor = b.number("MULTIPLY", b.input("Scale"), b.number("SUBTRACT", 1.0, less))
    return b.scaled((1.0, 1.0, 1.0), factor)


def _instances(b: Builder, points: Socket) -> Socket:
    """The chosen object on every point; a small cone when none is chosen."""
    node = b.node("GeometryNodeObjectInfo", b.input("Instance"), True)
    chosen = node.outputs["Geometry"]
    some = b.compare("GREATER_THAN", b.count(chosen, "INSTANCES"), 0)
    shape = b.switch("GEOMETRY", some, _cone(b), chosen)
    return b.out(
        "GeometryNodeInstanceOnPoints",
        points,
        True,
        shape,
        False,
        None,
        b.attribute("rotation", "QUATERNION"),
        b.attribute("scale", "FLOAT_VECTOR"),
    )


def _cone(b: Builder) -> Socket:
    node = b.node("GeometryNodeMeshCone")
    node.inputs["Vertices"].default_value = 8
    node.inputs["Radius Top"].default_value = 0.0
    spacing = b.input("Spacing")
    b.tree.links.new(b.number("MULTIPLY", spacing, 0.3), node.inputs["Radius Bottom"])
    b.tree.links.new(b.number("MULTIPLY", spacing, 0.6), node.inputs["Depth"])
    return node.outputs["Mesh"]
