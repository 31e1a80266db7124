# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups: a binding -> position and rotation on a surface."""

import bpy

from ..core.surface.frames import LEAST_HEIGHT
from .builder import Builder, Group, Socket, inner, new_group
from .orientation import ORIENTATION
from .surface import NORMAL, SHADING

SHADING_INPUTS = [
    ("Unmoved", "NodeSocketGeometry"),
    ("Hard", "NodeSocketBool"),
    ("Shaded", "NodeSocketGeometry"),
    ("Sheared", "NodeSocketBool"),
    ("Normals", "NodeSocketMatrix"),
]


def _build_bound_place() -> bpy.types.NodeTree:
    """New group.

    The vertices V0 to V2, the face corners C0 to C2 there, their weights W0 to W2 and Turn are
    fields (core/surface); Hard and Shaded are outputs of shading for Unmoved, the surface in its
    own space. Normals rotates normals from there if Surface is sheared.
    """
    tree = new_group(
        BOUND_PLACE.name,
        [
            ("Surface", "NodeSocketGeometry"),
            *SHADING_INPUTS,
            *((f"{kind}{k}", "NodeSocketInt") for kind in "VC" for k in range(3)),
            *((f"W{k}", "NodeSocketFloat") for k in range(3)),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    weights = [b.input(f"W{k}") for k in range(3)]
    positions = _at_vertices(b, "Surface", b.out("GeometryNodeInputPosition"))
    smooth = _weighted(b, _at_vertices(b, "Unmoved", b.out("GeometryNodeInputNormal")), weights)
    normal = b.switch("VECTOR", b.input("Hard"), smooth, _weighted(b, _of_corners(b), weights))
    turned = b.out("FunctionNodeTransformDirection", normal, b.input("Normals"))
    normal = b.switch("VECTOR", b.input("Sheared"), normal, turned)
    first, second = (b.vector("SUBTRACT", positions[k], positions[0]) for k in (1, 2))
    along = b.vector("ADD", b.scaled(first, weights[1]), b.scaled(second, weights[2]))
    b.output("Position", b.vector("ADD", positions[0], along))
    normal = b.vector("NORMALIZE", normal)
    feeds = (normal, _ahead(b, first, second, normal), b.input("Turn"), b.input("Side"))
    b.output("Rotation", inner(b, ORIENTATION, *feeds).outputs["Rotation"])
    b.arrange()
    return tree


BOUND_PLACE = Group("Dapple Bound Place", _build_bound_place)


def _at_vertices(b: Builder, name: str, field: Socket) -> list[Socket]:
    surface = b.input(name)
    return [b.sample(surface, field, b.input(f"V{k}"), "FLOAT_VECTOR") for k in range(3)]


def _of_corners(b: Builder) -> list[Socket]:
    """The normals of the face corners."""
    shaded, field = b.input("Shaded"), b.attribute(NORMAL, "FLOAT_VECTOR")
    corners = [b.input(f"C{k}") for k in range(3)]
    return [b.sample(shaded, field, corner, "FLOAT_VECTOR", "CORNER") for corner in corners]


def _weighted(b: Builder, values: list[Socket], weights: list[Socket]) -> Socket:
    parts = [b.scaled(v, w) for v, w in zip(values, weights, strict=True)]
    return b.vector("ADD", b.vector("ADD", parts[0], parts[1]), parts[2])


def _ahead(b: Builder, first: Socket, second: Socket, normal: Socket) -> Socket:
    """The first edge, rotated with the triangle's plane to the normal by the shortest way.

    It may be off by a multiple of the normal, which the orientation removes
    (core/surface/frames.py).
    """
    flat = b.vector("NORMALIZE", b.vector("CROSS_PRODUCT", first, second))
    height = b.number("MAXIMUM", b.number("ADD", _dot(b, flat, normal), 1.0), LEAST_HEIGHT)
    share = b.number("DIVIDE", _dot(b, first, normal), height)
    return b.vector("SUBTRACT", first, b.scaled(flat, share))


def _dot(b: Builder, u: Socket, v: Socket) -> Socket:
    return b.node("ShaderNodeVectorMath", u, v, operation="DOT_PRODUCT").outputs["Value"]


def _build_bound_point() -> bpy.types.NodeTree:
    """New group. All inputs except Surface are fields: vertices, face corners, weights
    (records.py).
    """
    tree = new_group(
        BOUND_POINT.name,
        [
            ("Surface", "NodeSocketGeometry"),
            *((f"{kind}{k}", "NodeSocketInt") for kind in "VC" for k in range(3)),
            *((f"W{k}", "NodeSocketFloat") for k in range(3)),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    surface = b.input("Surface")
    shaded = (surface, *inner(b, SHADING, surface).outputs, False, None)
    fields = [f"{kind}{k}" for kind in "VCW" for k in range(3)] + ["Turn", "Side"]
    placed = inner(b, BOUND_PLACE, surface, *shaded, *(b.input(name) for name in fields))
    for name in ("Position", "Rotation"):
        b.output(name, placed.outputs[name])
    b.arrange()
    return tree


BOUND_POINT = Group("Dapple Bound Point", _build_bound_point)
