# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a surface as it is now -> its rest shape, which knows the places of now.

The attribute rest_position goes with the surface through its modifiers. So the faces that they make
may be others in every frame, or in the render: a point is where its rest position is found.
"""

import bpy

from . import shading
from .builder import Builder, Socket, new_group
from .groups import Group, inner

PLACE = "dapple_place"


def _build_rest_shape() -> bpy.types.NodeTree:
    """New group; Transform brings what is in the surface's own space to its place. A surface
    without rest positions is found by its positions in its own space.
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
    """The surface with its normals, where it is not smooth everywhere those of the face corners."""
    surface = b.input("Surface")
    hard, shaded = inner(b, shading.SHADING, surface).outputs
    normal = b.out("GeometryNodeInputNormal")
    smooth = b.store(surface, shading.NORMAL, normal, "FLOAT_VECTOR")
    return b.switch("GEOMETRY", hard, smooth, shaded)
