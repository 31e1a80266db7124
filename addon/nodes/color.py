# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: points -> points with the color that the surface has there."""

import bpy

from .builder import Builder, Group, Socket, new_group

COLOR_INPUTS = [
    ("Color Attribute", "NodeSocketString"),
    ("Color Image", "NodeSocketImage"),
    ("Color UV Map", "NodeSocketString"),
]


def _build_color() -> bpy.types.NodeTree:
    """New group; the points get `dapple_color` if there is an attribute or an image.

    Position is their place on the surface. The surface is searched for it, which works for points
    that are bound in any way.
    """
    geometry = [("Geometry", "NodeSocketGeometry")]
    tree = new_group(
        COLOR.name,
        [
            *geometry,
            ("Surface", "NodeSocketObject"),
            ("Position", "NodeSocketVector"),
            *COLOR_INPUTS,
        ],
        geometry,
    )
    b = Builder(tree)
    points = b.input("Geometry")
    info = b.node("GeometryNodeObjectInfo", b.input("Surface"), transform_space="RELATIVE")
    surface = info.outputs["Geometry"]
    length = b.out("FunctionNodeStringLength", b.input("Color Attribute"))
    named = b.compare("GREATER_THAN", length, 0)
    width = b.node("GeometryNodeImageInfo", b.input("Color Image")).outputs["Width"]
    pictured = b.compare("GREATER_THAN", width, 0)
    tinted = _stored(b, points, _attribute(b, surface))
    own = b.switch("RGBA", named, (1.0, 1.0, 1.0, 1.0), b.attribute("dapple_color", "FLOAT_COLOR"))
    laid = b.switch("GEOMETRY", named, points, tinted)
    painted = _stored(b, laid, _multiplied(b, own, _picture(b, surface)))
    b.output("Geometry", b.switch("GEOMETRY", pictured, laid, painted))
    b.arrange()
    return tree


COLOR = Group("Dapple Color", _build_color)


def _stored(b: Builder, points: Socket, color: Socket) -> Socket:
    return b.store(points, "dapple_color", color, "FLOAT_COLOR")


def _attribute(b: Builder, surface: Socket) -> Socket:
    """The attribute at the points; white on a surface that does not have it."""
    white = (1.0, 1.0, 1.0, 1.0)
    name = b.input("Color Attribute")
    return _sampled(b, surface, b.attribute_or(name, "FLOAT_COLOR", "RGBA", white), "FLOAT_COLOR")


def _picture(b: Builder, surface: Socket) -> Socket:
    """The image at the points' places on the UV map."""
    place = _sampled(
        b, surface, b.attribute(b.input("Color UV Map"), "FLOAT_VECTOR"), "FLOAT_VECTOR"
    )
    return b.out("GeometryNodeImageTexture", b.input("Color Image"), place)


def _sampled(b: Builder, surface: Socket, value: Socket, kind: str) -> Socket:
    """A field of the surface at the points' places."""
    node = b.node("GeometryNodeSampleNearestSurface", data_type=kind)
    feeds = {"Mesh": surface, "Value": value, "Sample Position": b.input("Position")}
    for name, feed in feeds.items():
        socket = next(one for one in node.inputs if one.name == name and one.enabled)
        b.tree.links.new(feed, socket)
    return next(socket for socket in node.outputs if socket.enabled)


def _multiplied(b: Builder, one: Socket, other: Socket) -> Socket:
    node = b.node("ShaderNodeMix", data_type="RGBA", blend_type="MULTIPLY")
    for name, feed in (("Factor", 1.0), ("A", one), ("B", other)):
        socket = next(own for own in node.inputs if own.name == name and own.enabled)
        if isinstance(feed, bpy.types.NodeSocket):
            b.tree.links.new(feed, socket)
        else:
            socket.default_value = feed
    return next(socket for socket in node.outputs if socket.enabled)
