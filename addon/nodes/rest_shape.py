# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a surface as it is now -> its rest shape, which knows the places of now.

The attribute rest_position goes with the surface through its modifiers. So the faces that they make
may be others in every frame, or in the render: a point is where its rest position is found.
"""

import bpy

from .builder import Builder, new_group

NAME = "Dapple Rest Shape"
PLACE, NORMAL = "dapple_place", "dapple_normal"


def build() -> bpy.types.NodeTree:
    """New group; Own is a field, the rest position of a surface that has no such attribute."""
    tree = new_group(
        NAME,
        [("Surface", "NodeSocketGeometry"), ("Own", "NodeSocketVector")],
        [("Shape", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    place, normal = b.out("GeometryNodeInputPosition"), b.out("GeometryNodeInputNormal")
    surface = b.store(b.input("Surface"), PLACE, place, "FLOAT_VECTOR")
    surface = b.store(surface, NORMAL, normal, "FLOAT_VECTOR")
    rest = b.attribute_or("rest_position", "FLOAT_VECTOR", "VECTOR", b.input("Own"))
    b.output("Shape", b.out("GeometryNodeSetPosition", surface, True, rest))
    b.arrange()
    return tree
