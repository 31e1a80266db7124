# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a share of the points is hidden in the viewport, so that the others stay even."""

import bpy

from .builder import Builder, new_group
from .groups import Group


def _build_viewport() -> bpy.types.NodeTree:
    """New group: those with the largest `dapple_rank` go, an order with even beginnings."""
    tree = new_group(
        VIEWPORT.name,
        [("Points", "NodeSocketGeometry"), ("Hidden", "NodeSocketFloat")],
        [("Points", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    some = b.compare("GREATER_THAN", b.input("Hidden"), 0.0, "FLOAT")
    hides = b.boolean("AND", some, b.out("GeometryNodeIsViewport"))
    last = b.number("SUBTRACT", 1.0, b.input("Hidden"))
    late = b.compare("GREATER_EQUAL", b.attribute("dapple_rank", "FLOAT"), last, "FLOAT")
    shown = b.out("GeometryNodeDeleteGeometry", b.input("Points"), late, domain="POINT")
    b.output("Points", b.switch("GEOMETRY", hides, b.input("Points"), shown))
    b.arrange()
    return tree


VIEWPORT = Group("Dapple Viewport", _build_viewport)
