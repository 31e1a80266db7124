# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a keyframe, or the binding used instead -> position and rotation on the surface.

Without a bake the points' own binding is used, and a live preview overrides both. Keyframes and
rows are counted by integers, since floats are only exact up to 2^24.
"""

from dataclasses import dataclass
from typing import Any

import bpy

from .bound_place import BOUND_PLACE, SHADING_INPUTS
from .builder import Builder, Group, Socket, inner, new_group
from .rest_place import REST_PLACE

_CORNERS = [f"dapple_{kind}{k}" for kind in "vc" for k in range(3)]


@dataclass(frozen=True)
class _Bound:
    """Fields of one binding: three vertices and their face corners, weights, angle, fade,
    clearance.
    """

    corners: list[Socket]  # six fields
    weights: list[Socket]
    carry: Socket
    faded: Socket  # 1 - fade
    clearance: Socket
    face: Socket | None = None  # index of the triangle, for keyframes

    def sockets(self) -> list[Socket]:
        return [*self.corners, *self.weights, self.carry, self.faded, self.clearance]


def _build_key_point() -> bpy.types.NodeTree:
    """New group; Points is their number, Turn an angle added to the stored one."""
    tree = new_group(
        KEY_POINT.name,
        [
            ("Surface", "NodeSocketGeometry"),
            *SHADING_INPUTS,
            *((name, "NodeSocketGeometry") for name in ("Keys", "Triangles", "Preview")),
            *((name, "NodeSocketInt") for name in ("Points", "Key")),
            *((name, "NodeSocketBool") for name in ("Baked", "Live", "Resting")),
            ("Shape", "NodeSocketGeometry"),
            ("Parts", "NodeSocketInt"),
            ("Turn", "NodeSocketFloat"),
        ],
        [
            ("Position", "NodeSocketVector"),
            ("Rotation", "NodeSocketRotation"),
            ("Faded", "NodeSocketFloat"),
            ("Clearance", "NodeSocketFloat"),
        ],
    )
    b = Builder(tree)
    of_key = _of_key(b)
    bound = _chosen(b, b.input("Baked"), _own(b), of_key)
    bound = _chosen(b, b.input("Live"), bound, _previewed(b))
    turn = b.number("ADD", bound.carry, b.input("Turn"))
    shading = (b.input(name) for name, _ in SHADING_INPUTS)
    feeds = (b.input("Surface"), *shading, *bound.corners, *bound.weights, turn, 1.0)
    on_faces, at_rest = inner(b, BOUND_PLACE, *feeds), _at_rest(b, of_key)
    position, rotation = (
        b.switch(kind, b.input("Resting"), on_faces.outputs[name], at_rest.outputs[name])
        for kind, name in (("VECTOR", "Position"), ("ROTATION", "Rotation"))
    )
    b.output("Position", position)
    b.output("Rotation", _with_tilt(b, rotation))
    b.output("Faded", bound.faded)
    b.output("Clearance", bound.clearance)
    b.arrange()
    return tree


KEY_POINT = Group("Dapple Key Point", _build_key_point)


def _own(b: Builder) -> _Bound:
    """The binding of the points themselves."""
    return _Bound(
        [b.attribute(name, "INT") for name in _CORNERS],
        b.parts(b.attribute("dapple_barycentric", "FLOAT_VECTOR")),
        b.attribute("dapple_angle", "FLOAT"),
        b.attribute("dapple_faded", "FLOAT"),
        b.attribute("dapple_clearance", "FLOAT"),
    )


def _previewed(b: Builder) -> _Bound:
    """The binding of a live preview: a row for each point."""
    rows, index = b.input("Preview"), b.out("GeometryNodeInputIndex")

    def row(name: str, kind: str) -> Socket:
        return b.sample(rows, b.attribute(name, kind), index, kind)

    return _Bound(
        [row(name, "INT") for name in _CORNERS],
        b.parts(row("dapple_barycentric", "FLOAT_VECTOR")),
        row("dapple_angle", "FLOAT"),
        row("dapple_faded", "FLOAT"),
        b.attribute("dapple_clearance", "FLOAT"),
    )


def _of_key(b: Builder) -> _Bound:
    """The binding that the key holds."""
    rows, triangles, row = b.input("Keys"), b.input("Triangles"), _row(b)
    face = b.sample(rows, b.attribute("dapple_face", "INT"), row, "INT")
    place = b.sample(rows, b.out("GeometryNodeInputPosition"), row, "FLOAT_VECTOR")
    second, third, carry = b.parts(place)
    first = b.number("SUBTRACT", b.number("SUBTRACT", 1.0, second), third)
    return _Bound(
        [b.sample(triangles, b.attribute(name, "INT"), face, "INT") for name in _CORNERS],
        [first, second, third],
        carry,
        _stored(b, rows, row, "dapple_faded", 0.0),
        _stored(b, rows, row, "dapple_clearance", b.attribute("dapple_clearance", "FLOAT")),
        face,
    )


def _at_rest(b: Builder, key: _Bound) -> bpy.types.Node:
    """The same by places on the rest shape, the points' own or those of the triangles."""
    triangles, baked = b.input("Triangles"), b.input("Baked")

    def of_face(name: str, kind: str) -> Socket:
        return b.sample(triangles, b.attribute(name, kind), key.face, kind)

    corners = [of_face(f"dapple_r{k}", "FLOAT_VECTOR") for k in range(3)]
    parts = [b.scaled(at, weight) for at, weight in zip(corners, key.weights, strict=True)]
    place = b.vector("ADD", b.vector("ADD", parts[0], parts[1]), parts[2])
    rest, ahead = (b.attribute(name, "FLOAT_VECTOR") for name in ("dapple_rest", "dapple_ahead"))
    pairs = ((rest, place), (rest, corners[0]), (ahead, corners[1]))
    places = [b.switch("VECTOR", baked, own, other) for own, other in pairs]
    part = b.switch("INT", baked, b.attribute("dapple_part", "INT"), of_face("dapple_part", "INT"))
    # The place ahead of a point already includes the angle.
    turn = b.number("ADD", b.switch("FLOAT", baked, 0.0, key.carry), b.input("Turn"))
    feeds = (*places, part, b.input("Parts"), turn, 1.0)
    return inner(b, REST_PLACE, b.input("Shape"), b.input("Normals"), *feeds)


def _row(b: Builder) -> Socket:
    """Row of each point in the keyframe."""
    row = b.integer("MULTIPLY_ADD", b.input("Key"), b.input("Points"))
    b.tree.links.new(b.out("GeometryNodeInputIndex"), row.node.inputs[2])
    return row


def _with_tilt(b: Builder, rotation: Socket) -> Socket:
    """The rotation, tilted as stored, before its turn; only in bakes with tilts."""
    rows, tilt = b.input("Keys"), b.attribute("dapple_tilt", "FLOAT_VECTOR")
    stored = b.sample(rows, tilt.node.outputs["Exists"], 0, "BOOLEAN")
    played = b.boolean("AND", b.input("Baked"), b.boolean("NOT", b.input("Live")))
    vector = b.node("ShaderNodeVectorRotate", rotation_type="Z_AXIS")
    b.tree.links.new(b.sample(rows, tilt, _row(b), "FLOAT_VECTOR"), vector.inputs["Vector"])
    b.tree.links.new(b.number("MULTIPLY", b.input("Turn"), -1.0), vector.inputs["Angle"])
    length = b.node("ShaderNodeVectorMath", vector.outputs[0], operation="LENGTH").outputs["Value"]
    by = b.out("FunctionNodeAxisAngleToRotation", vector.outputs[0], length)
    tilted = b.out("FunctionNodeRotateRotation", rotation, by, rotation_space="LOCAL")
    return b.switch("ROTATION", b.boolean("AND", played, stored), rotation, tilted)


def _stored(b: Builder, rows: Socket, row: Socket, name: str, other: Any) -> Socket:
    """Values of a keyframe, or the default in a bake that does not store them."""
    value = b.attribute(name, "FLOAT")
    stored = b.sample(rows, value.node.outputs["Exists"], 0, "BOOLEAN")
    return b.switch("FLOAT", stored, other, b.sample(rows, value, row, "FLOAT"))


def _chosen(b: Builder, condition: Socket, false: _Bound, true: _Bound) -> _Bound:
    """One of two bindings."""
    kinds = (*("INT",) * 6, *("FLOAT",) * 6)
    pairs = zip(kinds, false.sockets(), true.sockets(), strict=True)
    either = [b.switch(kind, condition, x, y) for kind, x, y in pairs]
    return _Bound(either[:6], either[6:9], *either[9:])


def _build_frame_keys() -> bpy.types.NodeTree:
    """New group. Before the first and after the last frame, these frames are used.

    Fraction is the weight of the second keyframe. If the topology changes between two frames, the
    surface has one of two numbers of vertices in between, and the frame with this number is used.
    Points bound to the rest position work on any surface and are interpolated.
    """
    tree = new_group(
        FRAME_KEYS.name,
        [
            ("Frames", "NodeSocketGeometry"),
            ("First Frame", "NodeSocketInt"),
            ("Vertices", "NodeSocketInt"),
            ("Rest Binding", "NodeSocketBool"),
        ],
        [
            ("First", "NodeSocketInt"),
            ("Second", "NodeSocketInt"),
            ("Fraction", "NodeSocketFloat"),
            ("Vertices", "NodeSocketInt"),
        ],
    )
    b = Builder(tree)
    frame, part = _frame(b)
    late = b.compare("NOT_EQUAL", _at(b, "vertices", frame), b.input("Vertices"))
    late = b.boolean("AND", late, b.compare("GREATER_THAN", part, 0.0, "FLOAT"))
    late = b.boolean("AND", late, b.boolean("NOT", b.input("Rest Binding")))
    frame = b.integer("ADD", frame, late)
    part = b.switch("FLOAT", late, part, 0.0)
    key, since, span = (_at(b, name, frame) for name in ("key", "since", "span"))
    fraction = b.number("DIVIDE", b.number("ADD", since, part), b.integer("MAXIMUM", span, 1))
    some = b.integer("MINIMUM", span, 1)
    b.output("First", key)
    b.output("Second", b.integer("ADD", key, some))
    b.output("Fraction", b.number("MULTIPLY", fraction, some))
    b.output("Vertices", _at(b, "vertices", frame))
    b.arrange()
    return tree


FRAME_KEYS = Group("Dapple Frame Keys", _build_frame_keys)


def _frame(b: Builder) -> tuple[Socket, Socket]:
    """Index of the current frame, and the fraction toward the next in [0, 1)."""
    time = b.node("GeometryNodeInputSceneTime").outputs["Frame"]
    time = b.number("SUBTRACT", time, b.input("First Frame"))
    time = b.number("MAXIMUM", time, 0.0)
    time = b.number("MINIMUM", time, b.integer("SUBTRACT", b.count(b.input("Frames")), 1))
    whole = b.out("FunctionNodeFloatToInt", time, rounding_mode="FLOOR")
    return whole, b.number("SUBTRACT", time, whole)


def _at(b: Builder, name: str, frame: Socket) -> Socket:
    return b.sample(b.input("Frames"), b.attribute(f"dapple_{name}", "INT"), frame, "INT")
