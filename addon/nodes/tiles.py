# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: stored tiles -> tiles on the surface of the current (sub-)frame."""

import bpy

from .bound_place import BOUND_POINT
from .builder import Builder, Group, Socket, inner, new_group
from .rest_place import REST_POINT

OFFSET = "dapple_offset"  # offset of a vertex from its place, in the local axes
_CORNERS = [f"dapple_{kind}{k}" for kind in "vc" for k in range(3)]


def _build_tiles() -> bpy.types.NodeTree:
    """New group. Each vertex has a place on the surface, like a point, and an offset from it.

    Tiles do not move if the number of the surface's vertices has changed.
    """
    tree = new_group(
        TILES.name,
        [
            ("Geometry", "NodeSocketGeometry"),
            ("Surface", "NodeSocketObject"),
            ("Surface Vertices", "NodeSocketInt"),
            ("Rest Binding", "NodeSocketBool"),
            ("Rest Parts", "NodeSocketInt"),
        ],
        [("Geometry", "NodeSocketGeometry")],
    )
    tree.is_modifier = True
    b = Builder(tree)
    info = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="ORIGINAL")
    surface = info.outputs["Geometry"]
    on_faces, at_rest = _on_faces(b, surface), _at_rest(b, surface)
    position, rotation = (
        b.switch(kind, b.input("Rest Binding"), on_faces.outputs[name], at_rest.outputs[name])
        for kind, name in (("VECTOR", "Position"), ("ROTATION", "Rotation"))
    )
    offset = b.attribute(OFFSET, "FLOAT_VECTOR")
    offset = b.out("FunctionNodeRotateVector", offset, rotation)
    there = b.vector("ADD", position, offset)
    moved = b.out("GeometryNodeSetPosition", b.input("Geometry"), True, there)
    b.output("Geometry", b.switch("GEOMETRY", _fits(b, surface), b.input("Geometry"), moved))
    b.arrange()
    return tree


TILES = Group("Dapple Tiles", _build_tiles)


def _on_faces(b: Builder, surface: Socket) -> bpy.types.Node:
    corners = [b.attribute(name, "INT") for name in _CORNERS]
    weights = b.parts(b.attribute("dapple_barycentric", "FLOAT_VECTOR"))
    return inner(b, BOUND_POINT, surface, *corners, *weights, 0.0, 1.0)


def _at_rest(b: Builder, surface: Socket) -> bpy.types.Node:
    rest, ahead = (b.attribute(name, "FLOAT_VECTOR") for name in ("dapple_rest", "dapple_ahead"))
    part = b.attribute("dapple_part", "INT")
    feeds = (rest, ahead, 0.0, 1.0, part, b.input("Rest Parts"))
    return inner(b, REST_POINT, surface, *feeds)


def _fits(b: Builder, surface: Socket) -> Socket:
    size = b.node("GeometryNodeAttributeDomainSize", surface, component="MESH")
    count = size.outputs["Point Count"]
    same = b.compare("EQUAL", count, b.input("Surface Vertices"))
    there = b.compare("GREATER_THAN", count, 0)
    return b.switch("BOOLEAN", b.input("Rest Binding"), same, there)
