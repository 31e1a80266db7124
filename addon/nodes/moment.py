# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: the current (sub-)frame -> both keys around it, and what their surface has to be.

Integers count frames and keys: floats run out of digits beyond 2^24 of them.
"""

import bpy

from .builder import Builder, Socket, new_group
from .groups import Group


def _build_moment() -> bpy.types.NodeTree:
    """New group; before the first and after the last frame, those hold.

    Fraction is the share of the second key. Where the topology changes between two frames, the
    surface has one of two numbers of vertices at a time between them: then that frame is played
    whose number it is. Bound to the rest position, points are on any surface, and are mixed.
    """
    tree = new_group(
        MOMENT.name,
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


MOMENT = Group("Dapple Moment", _build_moment)


def _frame(b: Builder) -> tuple[Socket, Socket]:
    """Index of the frame that is played, and how far it is to the next, in [0, 1)."""
    time = b.node("GeometryNodeInputSceneTime").outputs["Frame"]
    time = b.number("SUBTRACT", time, b.input("First Frame"))
    time = b.number("MAXIMUM", time, 0.0)
    time = b.number("MINIMUM", time, b.integer("SUBTRACT", b.count(b.input("Frames")), 1))
    whole = b.out("FunctionNodeFloatToInt", time, rounding_mode="FLOOR")
    return whole, b.number("SUBTRACT", time, whole)


def _at(b: Builder, name: str, frame: Socket) -> Socket:
    return b.sample(b.input("Frames"), b.attribute(f"dapple_{name}", "INT"), frame, "INT")
