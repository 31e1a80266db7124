# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: one row of a binding -> position and rotation on the surface as it is now."""

import bpy

from .builder import Builder, Socket, new_group

NAME = "Dapple Bound Point"


def build() -> bpy.types.NodeTree:
    """New group; Row indexes the binding rows stored on the points of Keys."""
    tree = new_group(
        NAME,
        [
            ("Surface", "NodeSocketGeometry"),
            ("Keys", "NodeSocketGeometry"),
            ("Row", "NodeSocketInt"),
            ("Side", "NodeSocketFloat"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    corners = [_row(b, f"dapple_v{k}", "INT") for k in range(3)]
    weights = _weights(b)
    positions = _at_corners(b, b.out("GeometryNodeInputPosition"), corners)
    normals = _at_corners(b, b.out("GeometryNodeInputNormal"), corners)
    b.output("Position", _weighted(b, positions, weights))
    b.output("Rotation", _rotation(b, positions, _weighted(b, normals, weights)))
    b.arrange()
    return tree


def _row(b: Builder, name: str, data_type: str) -> Socket:
    field = b.attribute(name, data_type)
    return b.sample(b.input("Keys"), field, b.input("Row"), data_type)


def _weights(b: Builder) -> list[Socket]:
    row = _row(b, "dapple_barycentric", "FLOAT_VECTOR")
    return list(b.node("ShaderNodeSeparateXYZ", row).outputs)


def _at_corners(b: Builder, field: Socket, corners: list[Socket]) -> list[Socket]:
    surface = b.input("Surface")
    return [b.sample(surface, field, corner, "FLOAT_VECTOR") for corner in corners]


def _weighted(b: Builder, values: list[Socket], weights: list[Socket]) -> Socket:
    parts = [b.scaled(v, w) for v, w in zip(values, weights, strict=True)]
    return b.vector("ADD", b.vector("ADD", parts[0], parts[1]), parts[2])


def _rotation(b: Builder, positions: list[Socket], normal: Socket) -> Socket:
    """Z along the interpolated normal, X along the first edge, turned by the key's angle."""
    edge = b.vector("SUBTRACT", positions[1], positions[0])
    outward = b.scaled(normal, b.input("Side"))
    frame = b.out(
        "FunctionNodeAxesToRotation",
        outward,
        edge,
        primary_axis="Z",
        secondary_axis="X",
    )
    return b.turned(frame, _row(b, "dapple_carry", "FLOAT"))
