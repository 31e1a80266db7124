# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: instances -> the same with a radius of 1, to be scaled to the room of a point.

The radius of an instance is that of the circle around its own Z axis which it never leaves however
it is turned about it.
"""

import bpy

from .builder import Builder, Socket, new_group
from .groups import Group


def _build_fitting() -> bpy.types.NodeTree:
    """New group; Fit is the share of it, as an exponent: with 0.5 a radius of 4 becomes 2.

    What has no vertices keeps its size, as there is nothing to fit.
    """
    geometry = [("Instances", "NodeSocketGeometry")]
    tree = new_group(FITTING.name, [*geometry, ("Fit", "NodeSocketFloat")], geometry)
    b = Builder(tree)
    shape = b.input("Instances")
    loose = b.compare("EQUAL", b.count(shape, "INSTANCES"), 0)
    shape = b.switch("GEOMETRY", loose, shape, b.out("GeometryNodeGeometryToInstance", shape))
    measured, radius = b.each("INSTANCE", shape, _radius)
    none = b.compare("LESS_EQUAL", radius, 0.0, "FLOAT")
    factor = b.number("POWER", radius, b.number("MULTIPLY", b.input("Fit"), -1.0))
    factor = b.switch("FLOAT", none, factor, 1.0)
    b.output("Instances", b.out("GeometryNodeScaleInstances", measured, True, factor))
    b.arrange()
    return tree


FITTING = Group("Dapple Fitting", _build_fitting)


def _radius(b: Builder, element: Socket, _index: Socket) -> Socket:
    """Of all that one instance has. Mesh to Points would take twice the time, for its UV map."""
    points = b.out("GeometryNodeRealizeInstances", element)
    x, y, _ = b.parts(b.out("GeometryNodeInputPosition"))
    across = b.number("SQRT", b.number("MULTIPLY_ADD", x, x, b.number("MULTIPLY", y, y)))
    node = b.node("GeometryNodeAttributeStatistic", points, True, across)
    return node.outputs["Max"]
