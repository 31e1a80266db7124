# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: an object of an instanced collection -> its mesh, where the instance has it."""

import bpy

from . import placed_part
from .builder import Builder, new_group
from .groups import Group, inner


def _build_instanced_part() -> bpy.types.NodeTree:
    """New group; Frame is from the space of the collection to that of the joined surface."""
    tree = new_group(
        INSTANCED_PART.name,
        [("Object", "NodeSocketObject"), ("Frame", "NodeSocketMatrix"), *placed_part.REST_INPUTS],
        [("Geometry", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    own = b.node("GeometryNodeObjectInfo", b.input("Object"), transform_space="ORIGINAL")
    place = b.out("FunctionNodeMatrixMultiply", b.input("Frame"), own.outputs["Transform"])
    rest = [b.input(name) for name, _ in placed_part.REST_INPUTS]
    placed = inner(b, placed_part.PLACED_PART, own.outputs["Geometry"], place, *rest)
    b.output("Geometry", placed.outputs["Geometry"])
    b.arrange()
    return tree


INSTANCED_PART = Group("Dapple Instanced Part", _build_instanced_part)
