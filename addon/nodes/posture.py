# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: the surface's rotation -> that of an instance, more upright and leaning."""

import bpy

from .builder import Builder, Socket, new_group
from .groups import Group


def _build_posture() -> bpy.types.NodeTree:
    """New group; where Align is 1, Rotation is turned already."""
    tree = new_group(
        POSTURE.name,
        [
            ("Rotation", "NodeSocketRotation"),
            ("Turn", "NodeSocketFloat"),
            ("Aligned", "NodeSocketBool"),
            ("Align", "NodeSocketFloat"),
            ("Tilt", "NodeSocketFloat"),
        ],
        [("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    rotation = b.input("Rotation")
    rotation = b.switch("ROTATION", b.input("Aligned"), _upright(b, rotation), rotation)
    straight = b.compare("EQUAL", b.input("Tilt"), 0.0, "FLOAT")
    b.output("Rotation", b.switch("ROTATION", straight, _tilted(b, rotation), rotation))
    b.arrange()
    return tree


POSTURE = Group("Dapple Posture", _build_posture)


def _upright(b: Builder, rotation: Socket) -> Socket:
    """From upright to the normal as Align says, then turned about itself."""
    less = b.number("SUBTRACT", 1.0, b.input("Align"))
    up = (0.0, 0.0, 1.0)
    rotation = b.out("FunctionNodeAlignRotationToVector", rotation, less, up, axis="Z")
    return b.turned(rotation, b.input("Turn"))


def _tilted(b: Builder, rotation: Socket) -> Socket:
    """Leaning in a random direction, chosen by digits that the turn does not use."""
    angle = b.number("MULTIPLY", b.attribute("dapple_turn", "FLOAT"), 1000.0)
    axis = b.out("ShaderNodeCombineXYZ", b.number("COSINE", angle), b.number("SINE", angle))
    chance = b.number("FRACT", b.number("MULTIPLY", b.attribute("dapple_scale", "FLOAT"), 37.0))
    angle = b.number("MULTIPLY", chance, b.input("Tilt"))
    tilt = b.out("FunctionNodeAxisAngleToRotation", axis, angle)
    return b.out("FunctionNodeRotateRotation", rotation, tilt, rotation_space="LOCAL")
