# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a place of the rest shape -> position and rotation on the surface as it is now.

The attribute rest_position goes with the surface through its modifiers. So the faces that they make
may be others in every frame, or in the render: a point is where its rest position is found.
"""

import bpy

from .builder import Builder, Socket, new_group

NAME = "Dapple Rest Point"
_PLACE, _NORMAL = "dapple_place", "dapple_normal"


def build() -> bpy.types.NodeTree:
    """New group; Rest and Ahead are two near places of the rest shape (core/rest.py)."""
    tree = new_group(
        NAME,
        [
            ("Surface", "NodeSocketGeometry"),
            ("Rest", "NodeSocketVector"),
            ("Ahead", "NodeSocketVector"),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    surface = b.store(
        b.input("Surface"), _PLACE, b.out("GeometryNodeInputPosition"), "FLOAT_VECTOR"
    )
    surface = b.store(surface, _NORMAL, b.out("GeometryNodeInputNormal"), "FLOAT_VECTOR")
    rest = b.attribute("rest_position", "FLOAT_VECTOR")
    shape = b.out("GeometryNodeSetPosition", surface, True, rest)
    position = _found(b, shape, _PLACE, "Rest")
    edge = b.vector("SUBTRACT", _found(b, shape, _PLACE, "Ahead"), position)
    outward = b.scaled(_found(b, shape, _NORMAL, "Rest"), b.input("Side"))
    b.output("Position", position)
    axes = {"primary_axis": "Z", "secondary_axis": "X"}
    frame = b.out("FunctionNodeAxesToRotation", outward, edge, **axes)
    b.output("Rotation", b.turned(frame, b.input("Turn")))
    b.arrange()
    return tree


def _found(b: Builder, shape: Socket, name: str, where: str) -> Socket:
    field = b.attribute(name, "FLOAT_VECTOR")
    kind = "GeometryNodeSampleNearestSurface"
    return b.out(kind, shape, field, None, b.input(where), data_type="FLOAT_VECTOR")
