# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: the surface's object -> its geometry, and what still has to be done to points on it.

A surface that Blender brings into the space of the scatter is a copy: its normals are computed a
second time in each frame, beside those that are drawn. So points are placed on the surface in its
own space and moved with it. That is the same unless it is sheared, mirrored or scaled by more than
one factor, which changes normals: then there is a copy.
"""

import functools

import bpy

from .builder import Builder, Socket, new_group

NAME = "Dapple Surface"
_UNITS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_EPSILON = 1e-5  # of squared lengths and of dot products, relative


def build() -> bpy.types.NodeTree:
    """New group; Moved is whether points on Geometry have yet to be brought to Relative.

    Side is 1, and -1 where the surface is mirrored and its normals point the other way.
    """
    tree = new_group(
        NAME,
        [("Surface", "NodeSocketObject")],
        [
            ("Geometry", "NodeSocketGeometry"),
            ("Relative", "NodeSocketGeometry"),
            ("Transform", "NodeSocketMatrix"),
            ("Rotation", "NodeSocketRotation"),
            ("Moved", "NodeSocketBool"),
            ("Side", "NodeSocketFloat"),
        ],
    )
    b = Builder(tree)
    info = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="RELATIVE")
    own = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="ORIGINAL")
    transform, relative = info.outputs["Transform"], info.outputs["Geometry"]
    side = b.number("SIGN", b.out("FunctionNodeMatrixDeterminant", transform))
    axes = [b.out("FunctionNodeTransformDirection", unit, transform) for unit in _UNITS]
    upright = b.compare("GREATER_THAN", side, 0.0, "FLOAT")
    kept = b.boolean("AND", upright, _are_alike(b, axes))
    b.output("Geometry", b.switch("GEOMETRY", kept, relative, own.outputs["Geometry"]))
    b.output("Relative", relative)
    b.output("Transform", transform)
    b.output("Rotation", info.outputs["Rotation"])
    b.output("Moved", b.boolean("AND", kept, _differ(b, axes, info.outputs["Location"])))
    b.output("Side", side)
    b.arrange()
    return tree


def _dot(b: Builder, u: Socket, v: Socket) -> Socket:
    return b.node("ShaderNodeVectorMath", u, v, operation="DOT_PRODUCT").outputs["Value"]


def _are_alike(b: Builder, axes: list[Socket]) -> Socket:
    """Whether axes are at right angles and of one length."""
    x, y, z = axes
    size = _dot(b, x, x)
    off = [b.number("SUBTRACT", _dot(b, axis, axis), size) for axis in (y, z)]
    off += [_dot(b, x, y), _dot(b, y, z), _dot(b, z, x)]
    worst = functools.reduce(
        lambda a, c: b.number("MAXIMUM", a, c), [b.number("ABSOLUTE", one) for one in off]
    )
    return b.compare("LESS_EQUAL", worst, b.number("MULTIPLY", size, _EPSILON), "FLOAT")


def _differ(b: Builder, axes: list[Socket], location: Socket) -> Socket:
    """Whether axes and location are not those of the scatter."""
    changes = [b.vector("SUBTRACT", *pair) for pair in zip(axes, _UNITS, strict=True)]
    squares = [_dot(b, one, one) for one in (*changes, location)]
    total = functools.reduce(lambda a, c: b.number("ADD", a, c), squares)
    return b.compare("GREATER_THAN", total, 0.0, "FLOAT")
