# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: bound points -> instances on the surface of the current (sub-)frame."""

from typing import Any

import bpy

from . import bound_point, playback, rest_point, things
from .builder import Builder, Socket, new_group

GROUP_NAME = "Dapple Scatter"
VERSION = 5
VERSION_KEY = "dapple_version"
_KINDS_KEY = "dapple_classes"  # that a group has inputs for; 0: one kind, inputs without a number
_PART_KEY = "dapple_part"  # of groups inside

INPUTS = [
    ("Geometry", "NodeSocketGeometry"),
    ("Surface", "NodeSocketObject"),
    ("Surface Vertices", "NodeSocketInt"),
    ("Rest Binding", "NodeSocketBool"),
    ("Keys", "NodeSocketObject"),
    ("Triangles", "NodeSocketObject"),
    ("Frames", "NodeSocketObject"),
    ("Key Points", "NodeSocketInt"),
    ("First Frame", "NodeSocketInt"),
    ("Stale", "NodeSocketString"),
    ("Preview", "NodeSocketObject"),
    ("Spacing", "NodeSocketFloat"),
]
INSTANCE_INPUTS = [
    ("Instance", "NodeSocketObject"),
    ("Collection", "NodeSocketCollection"),
    ("Scale", "NodeSocketFloat"),
    ("Scale Randomness", "NodeSocketFloat"),
    ("Turn Randomness", "NodeSocketFloat"),
    ("Align", "NodeSocketFloat"),
    ("Tilt", "NodeSocketFloat"),
    ("Density Scale", "NodeSocketFloat"),
]


def ensure_group(classes: int = 0) -> bpy.types.NodeTree:
    """The group of this version for so many classes in the open file, built if there is none."""
    for group in bpy.data.node_groups:
        known = group.get(VERSION_KEY) == VERSION and group.get(_KINDS_KEY, 0) == classes
        if known and group.library is None:
            return group
    return build(classes)


def input_name(name: str, kind: int | None) -> str:
    """What one of INSTANCE_INPUTS is called for a class; None: where there is one kind only."""
    return name if kind is None else f"{name} {kind + 1}"


def build(classes: int = 0) -> bpy.types.NodeTree:
    """New group, marked with its version."""
    kinds: list[int | None] = list(range(classes)) or [None]
    inputs = [(input_name(name, k), socket) for k in kinds for name, socket in INSTANCE_INPUTS]
    name = f"{GROUP_NAME} {classes} Classes" if classes else GROUP_NAME
    tree = new_group(name, INPUTS + inputs, [("Geometry", "NodeSocketGeometry")])
    tree.is_modifier = True
    tree[VERSION_KEY], tree[_KINDS_KEY] = VERSION, classes
    b = Builder(tree)
    info = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="RELATIVE")
    rows, triangles, frames = (_stored(b, name) for name in ("Keys", "Triangles", "Frames"))
    baked = b.compare("GREATER_THAN", b.count(rows), 0)
    vertices = b.count(info.outputs["Geometry"])
    moment = playback.moment(b, frames, vertices)
    own = playback.own(b)
    keys = [playback.of_key(b, rows, triangles, key) for key in (moment.first, moment.second)]
    bindings = [playback.chosen(b, baked, own, key) for key in keys]
    preview, live = _preview(b)
    bindings = [playback.chosen(b, live, stored, preview) for stored in bindings]
    points = _placed(b, info, bindings, moment.fraction, kinds)
    played = b.boolean("AND", baked, b.boolean("NOT", live))
    bound = b.switch("INT", played, b.input("Surface Vertices"), moment.vertices)
    other = b.compare("NOT_EQUAL", vertices, bound)
    other = b.boolean("AND", other, b.boolean("NOT", b.input("Rest Binding")))
    fits = _guards(b, other, played)
    b.output("Geometry", b.switch("GEOMETRY", fits, None, _instances(b, points, kinds)))
    b.arrange()
    return tree


def _preview(b: Builder) -> tuple[playback.Bound, Socket]:
    """The binding of a live preview, and whether to show it: in no render."""
    rows = _stored(b, "Preview")
    fits = b.compare("EQUAL", b.count(rows), b.count(b.input("Geometry")))
    some = b.compare("GREATER_THAN", b.count(rows), 0)
    live = b.boolean("AND", b.boolean("AND", fits, some), b.out("GeometryNodeIsViewport"))
    return playback.previewed(b, rows), live


def _stored(b: Builder, name: str) -> Socket:
    info = b.node("GeometryNodeObjectInfo", b.input(name), transform_space="ORIGINAL")
    return info.outputs["Geometry"]


def _guards(b: Builder, stale: Socket, baked: Socket) -> Socket:
    """True when the stored rows fit the surface and the points; else nodes warn."""
    lost = b.compare("NOT_EQUAL", b.count(b.input("Geometry")), b.input("Key Points"))
    stale = _warning(b, stale, "The surface has another number of vertices: optimise the scatter")
    lost = _warning(
        b,
        b.boolean("AND", baked, lost),
        "Points were added or removed since the bake: bake again",
    )
    said = b.compare("GREATER_THAN", b.out("FunctionNodeStringLength", b.input("Stale")), 0)
    said = _warning(b, said, b.input("Stale"))
    # Settings that changed are told and hide nothing; only a node that is used is evaluated.
    hidden = b.boolean("OR", stale, lost)
    return b.boolean("NOR", hidden, b.boolean("AND", said, hidden))


def _warning(b: Builder, show: Socket, message: Any) -> Socket:
    return b.out("GeometryNodeWarning", show, message, warning_type="WARNING")


def _placed(
    b: Builder,
    info: bpy.types.Node,
    bindings: list[playback.Bound],
    fraction: Socket,
    kinds: list[int | None],
) -> Socket:
    """Points on the surface, with `rotation`, `fade` and `scale` attributes."""
    side = b.number("SIGN", b.out("FunctionNodeMatrixDeterminant", info.outputs[0]))
    surface = info.outputs["Geometry"]
    turn = b.number(
        "MULTIPLY", b.attribute("dapple_turn", "FLOAT"), _of_class(b, "Turn Randomness", kinds)
    )
    # Things that stand on the surface are turned once, by their own angle and the key's together.
    aligned = _all_are(b, "Align", 1.0, kinds)
    early = b.switch("FLOAT", aligned, 0.0, turn)
    a, c = (_bound(b, surface, binding, early, side) for binding in bindings)
    # On whole frames of keys, and without any, the second key is not looked at.
    between = b.compare("GREATER_THAN", fraction, 0.0, "FLOAT")
    position, rotation, gone = (
        b.switch(kind, between, one, b.mix(kind, fraction, one, other))
        for kind, one, other in (
            ("VECTOR", a.outputs[0], c.outputs[0]),
            ("ROTATION", a.outputs[1], c.outputs[1]),
            ("FLOAT", *(binding.gone for binding in bindings)),
        )
    )
    by_rest, rest = b.input("Rest Binding"), _rest(b, surface, early, side)
    position = b.switch("VECTOR", by_rest, position, rest.outputs[0])
    rotation = b.switch("ROTATION", by_rest, rotation, rest.outputs[1])
    upright = b.switch("ROTATION", aligned, _upright(b, rotation, turn, kinds), rotation)
    rotation = _tilted(b, upright, kinds)
    placed = b.captured(
        b.input("Geometry"), Position=("VECTOR", position), Rotation=("ROTATION", rotation)
    )
    points = b.store(placed.outputs[0], "rotation", placed.outputs["Rotation"], "QUATERNION")
    points = b.store(points, "fade", b.number("SUBTRACT", 1.0, gone), "FLOAT")
    points = b.store(points, "scale", _size(b, kinds), "FLOAT_VECTOR")
    return b.out("GeometryNodeSetPosition", points, True, placed.outputs["Position"])


def _upright(b: Builder, rotation: Socket, turn: Socket, kinds: list[int | None]) -> Socket:
    """From upright to the normal as Align says, then turned about itself."""
    less = b.number("SUBTRACT", 1.0, _of_class(b, "Align", kinds))
    up = (0.0, 0.0, 1.0)
    return b.turned(b.out("FunctionNodeAlignRotationToVector", rotation, less, up, axis="Z"), turn)


def _tilted(b: Builder, rotation: Socket, kinds: list[int | None]) -> Socket:
    """Leaning any way, which digits choose that the turn hides."""
    way = b.number("MULTIPLY", b.attribute("dapple_turn", "FLOAT"), 1000.0)
    axis = b.out("ShaderNodeCombineXYZ", b.number("COSINE", way), b.number("SINE", way))
    chance = b.number("FRACT", b.number("MULTIPLY", b.attribute("dapple_scale", "FLOAT"), 37.0))
    angle = b.number("MULTIPLY", chance, _of_class(b, "Tilt", kinds))
    tilt = b.out("FunctionNodeAxisAngleToRotation", axis, angle)
    tilted = b.out("FunctionNodeRotateRotation", rotation, tilt, rotation_space="LOCAL")
    return b.switch("ROTATION", _all_are(b, "Tilt", 0.0, kinds), tilted, rotation)


def _bound(
    b: Builder, surface: Socket, binding: playback.Bound, turn: Socket, side: Socket
) -> bpy.types.Node:
    turn = b.number("ADD", binding.carry, turn)
    return _inner(b, bound_point, (surface, *binding.corners, *binding.weights, turn, side))


def _rest(b: Builder, surface: Socket, turn: Socket, side: Socket) -> bpy.types.Node:
    places = (b.attribute(name, "FLOAT_VECTOR") for name in ("dapple_rest", "dapple_ahead"))
    return _inner(b, rest_point, (surface, *places, turn, side))


def _inner(b: Builder, part: Any, feeds: tuple[Socket, ...]) -> bpy.types.Node:
    """A node with the group that a module builds."""
    node = b.tree.nodes.new("GeometryNodeGroup")
    node.node_tree = _inner_group(part)
    for socket, feed in zip(node.inputs, feeds, strict=True):
        b.tree.links.new(feed, socket)
    return node


def _inner_group(part: Any) -> bpy.types.NodeTree:
    for group in bpy.data.node_groups:
        known = group.get(VERSION_KEY) == -VERSION and group.get(_PART_KEY) == part.NAME
        if known and group.library is None:
            return group
    group = part.build()
    group[VERSION_KEY], group[_PART_KEY] = -VERSION, part.NAME
    return group


def _of_class(b: Builder, name: str, kinds: list[int | None]) -> Socket:
    """The number among INSTANCE_INPUTS that belongs to a point's class."""
    value = b.input(input_name(name, kinds[0]))
    for kind in kinds[1:]:
        value = b.switch("FLOAT", _is_of(b, kind), value, b.input(input_name(name, kind)))
    return value


def _all_are(b: Builder, name: str, value: float, kinds: list[int | None]) -> Socket:
    """Whether no class changes anything: one value, so that a switch leaves the other side out."""
    plain = None
    for kind in kinds:
        same = b.compare("EQUAL", b.input(input_name(name, kind)), value, "FLOAT")
        plain = same if plain is None else b.boolean("AND", plain, same)
    return plain


def _is_of(b: Builder, kind: int | None) -> Socket:
    return b.compare("EQUAL", b.attribute("dapple_class", "INT"), kind)


def _size(b: Builder, kinds: list[int | None]) -> Socket:
    """Scale * fade * (1 - randomness * own random number), less where the density is less."""
    own = b.attribute("dapple_scale", "FLOAT")
    less = b.number("MULTIPLY", own, _of_class(b, "Scale Randomness", kinds))
    scale = _of_class(b, "Scale", kinds)
    factor = b.number("MULTIPLY", scale, b.number("SUBTRACT", 1.0, less))
    factor = b.number("MULTIPLY", factor, b.attribute("fade", "FLOAT"))
    sparse = b.number("SUBTRACT", 1.0, b.attribute("dapple_density", "FLOAT"))
    smaller = b.number("MULTIPLY", sparse, _of_class(b, "Density Scale", kinds))
    other = b.number("MULTIPLY", factor, b.number("SUBTRACT", 1.0, smaller))
    factor = b.switch("FLOAT", _all_are(b, "Density Scale", 0.0, kinds), other, factor)
    return b.scaled((1.0, 1.0, 1.0), factor)


def _instances(b: Builder, points: Socket, kinds: list[int | None]) -> Socket:
    """What is chosen for each class on its points."""
    there = b.compare("GREATER_THAN", b.attribute("fade", "FLOAT"), 0.0, "FLOAT")
    if kinds == [None]:
        return _placed_things(b, points, there, None)
    joined = b.node("GeometryNodeJoinGeometry")
    for kind in reversed(kinds):  # the last that is linked comes first
        chosen = b.boolean("AND", there, _is_of(b, kind))
        b.tree.links.new(_placed_things(b, points, chosen, kind), joined.inputs[0])
    return joined.outputs[0]


def _placed_things(b: Builder, points: Socket, where: Socket, kind: int | None) -> Socket:
    chosen = (b.input(input_name(name, kind)) for name in ("Instance", "Collection"))
    return _inner(b, things, (points, where, *chosen, b.input("Spacing"))).outputs[0]
