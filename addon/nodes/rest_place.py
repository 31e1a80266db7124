# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups: a place on the rest shape -> position and rotation."""

import bpy

from .builder import Builder, Group, Socket, inner, new_group
from .orientation import ORIENTATION
from .surface import NORMAL, SHADING

PLACE = "dapple_place"


def _build_rest_place() -> bpy.types.NodeTree:
    """New group; X points from Start to Ahead, two places near Rest on the rest shape.

    Normals is applied to the normals found there. Faces are divided into Parts, equal ranges in
    their order; a place is searched in its own part (core/surface/rest.py).
    """
    tree = new_group(
        REST_PLACE.name,
        [
            ("Shape", "NodeSocketGeometry"),
            ("Normals", "NodeSocketMatrix"),
            *((name, "NodeSocketVector") for name in ("Rest", "Start", "Ahead")),
            *((name, "NodeSocketInt") for name in ("Part", "Parts")),
            *((name, "NodeSocketFloat") for name in ("Turn", "Side")),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    b.output("Position", _found(b, PLACE, "Rest"))
    ahead, start = (_found(b, PLACE, name) for name in ("Ahead", "Start"))
    edge = b.vector("SUBTRACT", ahead, start)
    normal = _found(b, NORMAL, "Rest")
    normal = b.out("FunctionNodeTransformDirection", normal, b.input("Normals"))
    normal = b.vector("NORMALIZE", normal)
    feeds = (normal, edge, b.input("Turn"), b.input("Side"))
    b.output("Rotation", inner(b, ORIENTATION, *feeds).outputs["Rotation"])
    b.arrange()
    return tree


REST_PLACE = Group("Dapple Rest Place", _build_rest_place)


def _found(b: Builder, name: str, where: str) -> Socket:
    field, kind = b.attribute(name, "FLOAT_VECTOR"), "GeometryNodeSampleNearestSurface"
    feeds = (b.input("Shape"), field, _part(b), b.input(where), b.input("Part"))
    return b.out(kind, *feeds, data_type="FLOAT_VECTOR")


def _part(b: Builder) -> Socket:
    """Part of each face, by the share of the corners before its own, which Subdivision keeps.

    Without parts it is a constant, so that the search structure is built once.
    """
    corner = b.node("GeometryNodeCornersOfFace").outputs["Corner Index"]
    total = b.node("GeometryNodeAttributeDomainSize", b.input("Shape"), component="MESH")
    before = b.integer("MULTIPLY", b.input("Parts"), corner)
    part = b.integer("DIVIDE", before, total.outputs["Face Corner Count"])
    return b.switch("INT", b.compare("GREATER_THAN", b.input("Parts"), 1), 0, part)


def _build_rest_point() -> bpy.types.NodeTree:
    """New group; Rest and Ahead are two near places of the rest shape (core/surface/rest.py)."""
    tree = new_group(
        REST_POINT.name,
        [
            ("Surface", "NodeSocketGeometry"),
            ("Rest", "NodeSocketVector"),
            ("Ahead", "NodeSocketVector"),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
            ("Part", "NodeSocketInt"),
            ("Parts", "NodeSocketInt"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    shape = inner(b, REST_SHAPE, b.input("Surface"), None).outputs["Shape"]
    names = ("Rest", "Rest", "Ahead", "Part", "Parts", "Turn", "Side")
    placed = inner(b, REST_PLACE, shape, None, *(b.input(name) for name in names))
    for name in ("Position", "Rotation"):
        b.output(name, placed.outputs[name])
    b.arrange()
    return tree


REST_POINT = Group("Dapple Rest Point", _build_rest_point)


def _build_rest_shape() -> bpy.types.NodeTree:
    """New group; Transform moves the surface's own space to its place.

    Without rest positions a surface is searched by its positions in its own space.
    """
    tree = new_group(
        REST_SHAPE.name,
        [("Surface", "NodeSocketGeometry"), ("Transform", "NodeSocketMatrix")],
        [("Shape", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    own = b.out("GeometryNodeInputPosition")
    place = b.out("FunctionNodeTransformPoint", own, b.input("Transform"))
    surface = b.store(_with_normals(b), PLACE, place, "FLOAT_VECTOR")
    rest = b.attribute_or("rest_position", "FLOAT_VECTOR", "VECTOR", own)
    b.output("Shape", b.out("GeometryNodeSetPosition", surface, True, rest))
    b.arrange()
    return tree


REST_SHAPE = Group("Dapple Rest Shape", _build_rest_shape)


def _with_normals(b: Builder) -> Socket:
    """The surface with its normals; those of the face corners unless it is smooth everywhere."""
    surface = b.input("Surface")
    hard, shaded = inner(b, SHADING, surface).outputs
    normal = b.out("GeometryNodeInputNormal")
    smooth = b.store(surface, NORMAL, normal, "FLOAT_VECTOR")
    return b.switch("GEOMETRY", hard, smooth, shaded)
