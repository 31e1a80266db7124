# SPDX-License-Identifier: GPL-3.0-or-later
"""Which keys the current (sub-)frame plays, and the bindings that they hold.

Integers count frames, keys and rows: floats run out of digits beyond 2^24 of them.
"""

from dataclasses import dataclass

from .builder import Builder, Socket


@dataclass(frozen=True)
class Moment:
    """Both keys around the current frame, and what their surface has to be."""

    first: Socket
    second: Socket
    fraction: Socket  # share of the second
    vertices: Socket  # of the surface that the keys are bound to


@dataclass(frozen=True)
class Bound:
    """Fields of one binding: three vertices, their weights, the angle carried; is it there."""

    corners: list[Socket]
    weights: list[Socket]
    carry: Socket
    gone: Socket  # 1 - fade

    def sockets(self) -> list[Socket]:
        return [*self.corners, *self.weights, self.carry, self.gone]


def moment(b: Builder, frames: Socket, vertices: Socket) -> Moment:
    """Keys of the current time: before the first and after the last frame, those hold.

    Where the topology changes between two frames, the surface has one of two numbers of
    vertices at a time between them: then that frame is played whose number it is.
    """
    frame, part = _frame(b, frames)
    late = b.compare("NOT_EQUAL", _at(b, frames, "vertices", frame), vertices)
    late = b.boolean("AND", late, b.compare("GREATER_THAN", part, 0.0, "FLOAT"))
    frame = b.integer("ADD", frame, late)
    part = b.switch("FLOAT", late, part, 0.0)
    key, since, span = (_at(b, frames, name, frame) for name in ("key", "since", "span"))
    fraction = b.number("DIVIDE", b.number("ADD", since, part), b.integer("MAXIMUM", span, 1))
    fraction = b.number("MULTIPLY", fraction, b.integer("MINIMUM", span, 1))
    following = b.integer("ADD", key, b.integer("MINIMUM", span, 1))
    return Moment(key, following, fraction, _at(b, frames, "vertices", frame))


def _frame(b: Builder, frames: Socket) -> tuple[Socket, Socket]:
    """Index of the frame that is played, and how far it is to the next, in [0, 1)."""
    time = b.node("GeometryNodeInputSceneTime").outputs["Frame"]
    time = b.number("SUBTRACT", time, b.input("First Frame"))
    time = b.number("MAXIMUM", time, 0.0)
    time = b.number("MINIMUM", time, b.integer("SUBTRACT", b.count(frames), 1))
    whole = b.out("FunctionNodeFloatToInt", time, rounding_mode="FLOOR")
    return whole, b.number("SUBTRACT", time, whole)


def _at(b: Builder, frames: Socket, name: str, frame: Socket) -> Socket:
    return b.sample(frames, b.attribute(f"dapple_{name}", "INT"), frame, "INT")


def own(b: Builder) -> Bound:
    """The binding of the points themselves."""
    return Bound(
        [b.attribute(f"dapple_v{k}", "INT") for k in range(3)],
        b.parts(b.attribute("dapple_barycentric", "FLOAT_VECTOR")),
        b.attribute("dapple_carry", "FLOAT"),
        b.attribute("dapple_gone", "FLOAT"),
    )


def previewed(b: Builder, rows: Socket) -> Bound:
    """The binding of a live preview: a row for each point."""
    index = b.out("GeometryNodeInputIndex")

    def row(field: Socket, kind: str) -> Socket:
        return b.sample(rows, field, index, kind)

    bound = own(b)
    return Bound(
        [row(corner, "INT") for corner in bound.corners],
        b.parts(row(b.attribute("dapple_barycentric", "FLOAT_VECTOR"), "FLOAT_VECTOR")),
        row(bound.carry, "FLOAT"),
        row(bound.gone, "FLOAT"),
    )


def of_key(b: Builder, rows: Socket, triangles: Socket, key: Socket) -> Bound:
    """The binding that a key holds."""
    row = b.integer("MULTIPLY_ADD", key, b.count(b.input("Geometry")))
    b.tree.links.new(b.out("GeometryNodeInputIndex"), row.node.inputs[2])
    face = b.sample(rows, b.attribute("dapple_face", "INT"), row, "INT")
    place = b.sample(rows, b.out("GeometryNodeInputPosition"), row, "FLOAT_VECTOR")
    second, third, carry = b.parts(place)
    first = b.number("SUBTRACT", b.number("SUBTRACT", 1.0, second), third)
    return Bound(
        [b.sample(triangles, b.attribute(f"dapple_v{k}", "INT"), face, "INT") for k in range(3)],
        [first, second, third],
        carry,
        _gone(b, rows, row),
    )


def _gone(b: Builder, rows: Socket, row: Socket) -> Socket:
    """What a key holds, one 0 in a bake without births: no point has to look then."""
    gone = b.attribute("dapple_gone", "FLOAT")
    stored = b.sample(rows, gone.node.outputs["Exists"], 0, "BOOLEAN")
    return b.switch("FLOAT", stored, 0.0, b.sample(rows, gone, row, "FLOAT"))


def chosen(b: Builder, condition: Socket, false: Bound, true: Bound) -> Bound:
    """One of two bindings."""
    kinds = (*("INT",) * 3, *("FLOAT",) * 5)
    pairs = zip(kinds, false.sockets(), true.sockets(), strict=True)
    either = [b.switch(kind, condition, x, y) for kind, x, y in pairs]
    return Bound(either[:3], either[3:6], *either[6:])
