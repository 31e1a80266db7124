# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: the geometry of one object -> its mesh where it belongs on a joined surface.

Instances and curves are left out: what is scattered on is the mesh. Faces of a mirrored part are
turned over, so that all face outward. Rest positions are put into a cell of their own: parts that
are copies of each other have the same.
"""

import bpy

from .builder import Builder, Socket, new_group
from .groups import Group

REST_INPUTS = [("Rest Scale", "NodeSocketFloat"), ("Rest Shift", "NodeSocketVector")]


def _build_placed_part() -> bpy.types.NodeTree:
    """New group; Matrix is from the part's own space to that of the joined surface."""
    tree = new_group(
        PLACED_PART.name,
        [("Geometry", "NodeSocketGeometry"), ("Matrix", "NodeSocketMatrix"), *REST_INPUTS],
        [("Geometry", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    position = b.out("GeometryNodeInputPosition")
    mesh = b.out("GeometryNodeSeparateComponents", b.input("Geometry"))
    mesh = b.store(mesh, "rest_position", _rest(b, position), "FLOAT_VECTOR")
    place = b.out("FunctionNodeTransformPoint", position, b.input("Matrix"))
    mesh = b.out("GeometryNodeSetPosition", mesh, True, place)
    side = b.out("FunctionNodeMatrixDeterminant", b.input("Matrix"))
    mirrored = b.compare("LESS_THAN", side, 0.0, "FLOAT")
    b.output("Geometry", b.out("GeometryNodeFlipFaces", mesh, mirrored))
    b.arrange()
    return tree


PLACED_PART = Group("Dapple Placed Part", _build_placed_part)


def _rest(b: Builder, position: Socket) -> Socket:
    """Where a vertex is at rest; one that has no rest position is taken for still."""
    own = b.attribute_or("rest_position", "FLOAT_VECTOR", "VECTOR", position)
    return b.vector("ADD", b.scaled(own, b.input("Rest Scale")), b.input("Rest Shift"))
