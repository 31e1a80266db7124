# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: an object of the scene -> its mesh in the space of the object with the modifier."""

import bpy

from . import placed_part
from .builder import Builder, new_group
from .groups import Group, inner


def _build_part() -> bpy.types.NodeTree:
    """New group."""
    tree = new_group(
        PART.name,
        [("Object", "NodeSocketObject"), *placed_part.REST_INPUTS],
        [("Geometry", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    here = b.node("GeometryNodeObjectInfo", b.input("Object"), transform_space="RELATIVE")
    own = b.node("GeometryNodeObjectInfo", b.input("Object"), transform_space="ORIGINAL")
    rest = [b.input(name) for name, _ in placed_part.REST_INPUTS]
    feeds = (own.outputs["Geometry"], here.outputs["Transform"], *rest)
    b.output("Geometry", inner(b, placed_part.PLACED_PART, *feeds).outputs["Geometry"])
    b.arrange()
    return tree


PART = Group("Dapple Part", _build_part)
