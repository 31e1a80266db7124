# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a normal, a direction and an angle -> the rotation of an instance.

Blender's own nodes (Axes to Rotation, Axis Angle to Rotation, Rotate Rotation) take twice the time:
they normalize axes, write a matrix and convert it to a rotation again. Here plain arithmetic gives
a quaternion of any length, which the last node normalizes. There are no branches, because a Switch
on a field suffers from mispredictions.
"""

import bpy

from .builder import Builder, Group, Socket, new_group


def _build_orientation() -> bpy.types.NodeTree:
    """New group; Z is along the normal, X as near to Ahead as possible, both turned by Turn about
    Z.

    Normal is a unit vector. The quaternion (1, 0, 0, t), t = tan(Turn / 2), is a turn about Z and
    comes first. If the normal points down, a half turn about X follows, so that the shortest
    rotation to the normal, which comes last, never exceeds a right angle.
    """
    tree = new_group(
        ORIENTATION.name,
        [
            ("Normal", "NodeSocketVector"),
            ("Ahead", "NodeSocketVector"),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
        ],
        [("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    normal = _outward(b)
    x, y, z = b.parts(normal)
    down = b.number("LESS_THAN", z, 0.0)
    sign = b.number("MULTIPLY_ADD", down, -2.0, 1.0)
    height = b.number("ADD", b.number("ABSOLUTE", z), 1.0)
    ahead = _flat(b, normal, (x, y), sign, height)
    turn = b.number("TANGENT", b.number("MULTIPLY", b.input("Turn"), 0.5))
    turned = _product(b, _half(b, *ahead), (1.0, b.number("MULTIPLY", turn, sign)))
    b.output("Rotation", _raised(b, turned, (x, y, height), down))
    b.arrange()
    return tree


ORIENTATION = Group("Dapple Orientation", _build_orientation)


def _outward(b: Builder) -> Socket:
    """The unit normal on the side that faces outward."""
    normal = b.input("Normal")
    inside_out = b.compare("LESS_THAN", b.input("Side"), 0.0, "FLOAT")
    return b.switch("VECTOR", inside_out, normal, b.scaled(normal, -1.0))


def _flat(
    b: Builder, normal: Socket, across: tuple[Socket, Socket], sign: Socket, height: Socket
) -> list[Socket]:
    """X and Y of Ahead before the shortest rotation from (0, 0, sign) to the normal."""
    ahead = b.input("Ahead")
    *flat, up = b.parts(ahead)
    dot = b.node("ShaderNodeVectorMath", normal, ahead, operation="DOT_PRODUCT").outputs["Value"]
    share = b.number("DIVIDE", b.number("MULTIPLY_ADD", up, sign, dot), height)
    less = b.number("MULTIPLY", share, -1.0)
    return [b.number("MULTIPLY_ADD", n, less, at) for n, at in zip(across, flat, strict=True)]


def _half(b: Builder, x: Socket, y: Socket) -> tuple[Socket, Socket]:
    """A complex number of half the angle of x + iy, (|x| + length, y) or (y, |x| + length).

    Without an angle the first is small but not 0, so that the rotation is that of the normal.
    """
    length = b.number("SQRT", b.number("MULTIPLY_ADD", x, x, b.number("MULTIPLY", y, y)))
    long = b.number("MAXIMUM", b.number("ADD", b.number("ABSOLUTE", x), length), 1e-18)
    return _swapped(b, b.number("LESS_THAN", x, 0.0), long, y)


def _product(
    b: Builder, a: tuple[Socket, Socket], c: tuple[float, Socket]
) -> tuple[Socket, Socket]:
    """Product of two complex numbers, the second being 1 + it."""
    real = b.number("SUBTRACT", a[0], b.number("MULTIPLY", a[1], c[1]))
    return real, b.number("MULTIPLY_ADD", a[0], c[1], a[1])


def _raised(
    b: Builder, turn: tuple[Socket, Socket], normal: tuple[Socket, Socket, Socket], down: Socket
) -> Socket:
    """The shortest rotation (height, -y, x, 0) after a turn about Z and the half turn."""
    (real, other), (x, y, height) = turn, normal
    w, k = b.number("MULTIPLY", height, real), b.number("MULTIPLY", height, other)
    i = b.number("SUBTRACT", b.number("MULTIPLY", x, other), b.number("MULTIPLY", y, real))
    j = b.number("MULTIPLY_ADD", x, real, b.number("MULTIPLY", y, other))
    w, i = _swapped(b, down, w, i)
    j, k = _swapped(b, down, j, k)
    return b.out("FunctionNodeQuaternionToRotation", w, i, j, k)


def _swapped(b: Builder, swap: Socket, a: Socket, c: Socket) -> tuple[Socket, Socket]:
    """Two numbers, exchanged where swap is 1."""
    change = b.number("MULTIPLY", swap, b.number("SUBTRACT", c, a))
    return b.number("ADD", a, change), b.number("SUBTRACT", c, change)
