# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a place of the rest shape -> position and rotation on the surface as it is now."""

import bpy

from . import rest_shape, shading, standing
from .builder import Builder, Socket, new_group
from .groups import Group, inner


def _build_rest_place() -> bpy.types.NodeTree:
    """New group; X points from Start to Ahead, two places near Rest on the rest shape. Normals is
    applied to the normals that are found there.

    Faces are divided into so many Parts, equal runs in their order; a place is looked for in its
    own part (core/surface/rest.py).
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
    b.output("Position", _found(b, rest_shape.PLACE, "Rest"))
    ahead, start = (_found(b, rest_shape.PLACE, name) for name in ("Ahead", "Start"))
    edge = b.vector("SUBTRACT", ahead, start)
    normal = _found(b, shading.NORMAL, "Rest")
    normal = b.out("FunctionNodeTransformDirection", normal, b.input("Normals"))
    normal = b.vector("NORMALIZE", normal)
    feeds = (normal, edge, b.input("Turn"), b.input("Side"))
    b.output("Rotation", inner(b, standing.STANDING, *feeds).outputs["Rotation"])
    b.arrange()
    return tree


REST_PLACE = Group("Dapple Rest Place", _build_rest_place)


def _found(b: Builder, name: str, where: str) -> Socket:
    field, kind = b.attribute(name, "FLOAT_VECTOR"), "GeometryNodeSampleNearestSurface"
    feeds = (b.input("Shape"), field, _part(b), b.input(where), b.input("Part"))
    return b.out(kind, *feeds, data_type="FLOAT_VECTOR")


def _part(b: Builder) -> Socket:
    """Of each face, by the share of the corners before its own, which Subdivision keeps.

    Without parts one number: then the search is prepared once for all that look here.
    """
    corner = b.node("GeometryNodeCornersOfFace").outputs["Corner Index"]
    total = b.node("GeometryNodeAttributeDomainSize", b.input("Shape"), component="MESH")
    before = b.integer("MULTIPLY", b.input("Parts"), corner)
    part = b.integer("DIVIDE", before, total.outputs["Face Corner Count"])
    return b.switch("INT", b.compare("GREATER_THAN", b.input("Parts"), 1), 0, part)
