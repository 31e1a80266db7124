# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a binding -> position and rotation on the surface as it is now."""

import bpy

from . import standing
from .builder import Builder, Socket, new_group
from .groups import inner

NAME = "Dapple Bound Point"


def build() -> bpy.types.NodeTree:
    """New group; V0 to V2, their weights W0 to W2 and Turn are fields (core/records.py)."""
    tree = new_group(
        NAME,
        [
            ("Surface", "NodeSocketGeometry"),
            *((f"V{k}", "NodeSocketInt") for k in range(3)),
            *((f"W{k}", "NodeSocketFloat") for k in range(3)),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    weights = [b.input(f"W{k}") for k in range(3)]
    positions = _at_corners(b, b.out("GeometryNodeInputPosition"))
    normals = _at_corners(b, b.out("GeometryNodeInputNormal"))
    b.output("Position", _weighted(b, positions, weights))
    b.output("Rotation", _rotation(b, positions, _weighted(b, normals, weights)))
    b.arrange()
    return tree


def _at_corners(b: Builder, field: Socket) -> list[Socket]:
    surface = b.input("Surface")
    return [b.sample(surface, field, b.input(f"V{k}"), "FLOAT_VECTOR") for k in range(3)]


def _weighted(b: Builder, values: list[Socket], weights: list[Socket]) -> Socket:
    parts = [b.scaled(v, w) for v, w in zip(values, weights, strict=True)]
    return b.vector("ADD", b.vector("ADD", parts[0], parts[1]), parts[2])


def _rotation(b: Builder, positions: list[Socket], normal: Socket) -> Socket:
    """Z along the interpolated normal, X along the first edge, turned by an angle."""
    edge = b.vector("SUBTRACT", positions[1], positions[0])
    return inner(b, standing, normal, edge, b.input("Turn"), b.input("Side")).outputs["Rotation"]
