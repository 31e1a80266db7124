# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: the surface object -> its geometry and the transform still to be applied to points.

A surface transformed into the space of the scatter is a copy, which takes time in each frame. So
points are placed on the surface in its own space and then moved. If it is sheared, mirrored or
scaled by different factors, they are placed on a transformed copy. Normals always come from the
surface in its own space, like those of its shading: a copy has different ones.
"""

import functools

import bpy

from .builder import Builder, Group, Socket, new_group

_UNITS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_EPSILON = 1e-5  # relative tolerance of squared lengths and dot products
NORMAL = "dapple_normal"
_MOST = 0.9  # threshold of a coordinate: 0.58 at the corner of a smooth cube, 1 on its faces


def _build_surface() -> bpy.types.NodeTree:
    """New group; Moved is whether points on Geometry still have to be moved by Transform.

    Unmoved is the surface in its own space; Sheared is whether Geometry is a copy. Normals
    transforms normals as Transform transforms the surface, except for their lengths.
    """
    tree = new_group(
        SURFACE.name,
        [("Surface", "NodeSocketObject")],
        [
            ("Geometry", "NodeSocketGeometry"),
            ("Unmoved", "NodeSocketGeometry"),
            ("Transform", "NodeSocketMatrix"),
            ("Rotation", "NodeSocketRotation"),
            ("Moved", "NodeSocketBool"),
            ("Sheared", "NodeSocketBool"),
            ("Normals", "NodeSocketMatrix"),
        ],
    )
    b = Builder(tree)
    info = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="RELATIVE")
    own = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="ORIGINAL")
    transform, relative = info.outputs["Transform"], info.outputs["Geometry"]
    mirrored = b.compare(
        "LESS_THAN", b.out("FunctionNodeMatrixDeterminant", transform), 0.0, "FLOAT"
    )
    axes = [b.out("FunctionNodeTransformDirection", unit, transform) for unit in _UNITS]
    kept = b.boolean("AND", b.boolean("NOT", mirrored), _are_alike(b, axes))
    b.output("Geometry", b.switch("GEOMETRY", kept, relative, own.outputs["Geometry"]))
    b.output("Unmoved", own.outputs["Geometry"])
    b.output("Transform", transform)
    b.output("Rotation", info.outputs["Rotation"])
    b.output("Moved", b.boolean("AND", kept, _differ(b, axes, info.outputs["Location"])))
    b.output("Sheared", b.boolean("NOT", kept))
    b.output("Normals", _cofactors(b, axes, mirrored))
    b.arrange()
    return tree


SURFACE = Group("Dapple Surface", _build_surface)


def _cofactors(b: Builder, axes: list[Socket], mirrored: Socket) -> Socket:
    """The matrix for normals, also of a flattened surface; mirrored surfaces still face outward."""
    x, y, z = axes
    sign = b.switch("FLOAT", mirrored, 1.0, -1.0)
    columns = [b.vector("CROSS_PRODUCT", *pair) for pair in ((y, z), (z, x), (x, y))]
    rows = [(*b.parts(b.scaled(column, sign)), 0.0) for column in columns]
    return b.out("FunctionNodeCombineMatrix", *(value for row in rows for value in row))


def _dot(b: Builder, u: Socket, v: Socket) -> Socket:
    return b.node("ShaderNodeVectorMath", u, v, operation="DOT_PRODUCT").outputs["Value"]


def _are_alike(b: Builder, axes: list[Socket]) -> Socket:
    """Whether axes are perpendicular and of equal length."""
    x, y, z = axes
    size = _dot(b, x, x)
    off = [b.number("SUBTRACT", _dot(b, axis, axis), size) for axis in (y, z)]
    off += [_dot(b, x, y), _dot(b, y, z), _dot(b, z, x)]
    worst = functools.reduce(
        lambda a, c: b.number("MAXIMUM", a, c), [b.number("ABSOLUTE", one) for one in off]
    )
    return b.compare("LESS_EQUAL", worst, b.number("MULTIPLY", size, _EPSILON), "FLOAT")


def _differ(b: Builder, axes: list[Socket], location: Socket) -> Socket:
    """Whether axes and location differ from those of the scatter."""
    changes = [b.vector("SUBTRACT", *pair) for pair in zip(axes, _UNITS, strict=True)]
    squares = [_dot(b, one, one) for one in (*changes, location)]
    total = functools.reduce(lambda a, c: b.number("ADD", a, c), squares)
    return b.compare("GREATER_THAN", total, 0.0, "FLOAT")


def _build_shading() -> bpy.types.NodeTree:
    """New group; Hard is whether corner normals differ. A smooth surface uses vertex normals, as
    Shaded would only take longer.
    """
    tree = new_group(
        SHADING.name,
        [("Surface", "NodeSocketGeometry")],
        [("Hard", "NodeSocketBool"), ("Shaded", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    surface = b.input("Surface")
    face, edge = (b.attribute(name, "BOOLEAN") for name in ("sharp_face", "sharp_edge"))
    custom = b.attribute("custom_normal", "FLOAT").node.outputs["Exists"]
    sharp = b.boolean("OR", _any(b, face, "FACE"), _any(b, edge, "EDGE"))
    b.output("Hard", b.boolean("OR", sharp, b.sample(surface, custom, 0, "BOOLEAN")))
    split = b.out("GeometryNodeSplitEdges", surface, b.boolean("OR", face, edge))
    split = b.store(split, NORMAL, b.out("GeometryNodeInputNormal"), "FLOAT_VECTOR")
    exact = b.store(surface, NORMAL, _of_corners(b), "FLOAT_VECTOR", "CORNER")
    b.output("Shaded", b.switch("GEOMETRY", _knows_corners(b), split, exact))
    b.arrange()
    return tree


SHADING = Group("Dapple Shading", _build_shading)


def _of_corners(b: Builder) -> Socket:
    """The field of the corners' normals, if Blender provides it."""
    node = b.node("GeometryNodeInputNormal")
    if hasattr(node, "legacy_corner_normals"):
        node.legacy_corner_normals = False
    return node.outputs[0]


def _any(b: Builder, value: Socket, domain: str) -> Socket:
    """Whether an attribute is set anywhere; most surfaces do not have it."""
    surface = b.input("Surface")
    there = b.sample(surface, value.node.outputs["Exists"], 0, "BOOLEAN")
    statistic = b.node("GeometryNodeAttributeStatistic", surface, True, value, domain=domain)
    some = b.compare("GREATER_THAN", statistic.outputs["Sum"], 0.0, "FLOAT")
    return b.switch("BOOLEAN", there, False, some)


def _knows_corners(b: Builder) -> Socket:
    """Whether the normal at the corner of a smooth cube differs from that of a face."""
    cube = b.out("GeometryNodeSetShadeSmooth", b.out("GeometryNodeMeshCube"), True, True)
    normal = b.sample(cube, _of_corners(b), 0, "FLOAT_VECTOR", "CORNER")
    x, y, z = (b.number("ABSOLUTE", part) for part in b.parts(normal))
    most = b.number("MAXIMUM", b.number("MAXIMUM", x, y), z)
    return b.compare("LESS_THAN", most, _MOST, "FLOAT")
