# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a surface as it is now -> its rest shape, which knows the places of now.

The attribute rest_position goes with the surface through its modifiers. So the faces that they make
may be others in every frame, or in the render: a point is where its rest position is found.
"""

import bpy

from . import shading
from .builder import Builder, Socket, new_group
from .groups import inner

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
    surface, place = _with_normals(b), b.out("GeometryNodeInputPosition")
    surface = b.store(surface, PLACE, place, "FLOAT_VECTOR")
    rest = b.attribute_or("rest_position", "FLOAT_VECTOR", "VECTOR", b.input("Own"))
    b.output("Shape", b.out("GeometryNodeSetPosition", surface, True, rest))
    b.arrange()
    return tree


def _with_normals(b: Builder) -> Socket:
    """The surface with its normals, where it is not smooth everywhere those of the face corners."""
    surface = b.input("Surface")
    hard, shaded = inner(b, shading, surface).outputs
    smooth = b.store(surface, NORMAL, b.out("GeometryNodeInputNormal"), "FLOAT_VECTOR")
    corners = b.store(shaded, NORMAL, shading.normal_of_corners(b), "FLOAT_VECTOR", "CORNER")
    return b.switch("GEOMETRY", hard, smooth, corners)
