# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: fewer points far from the camera and outside its view, evenly spread.

Every beginning of the order `dapple_rank` is even. So the points of the first half of it are even
where half is kept, those of the first tenth where a tenth is kept, and where the share changes from
place to place the last ranks go first. Points without ranks stay wherever any are kept.
"""

import bpy

from . import camera_view
from .builder import Builder, Socket, new_group
from .groups import inner

NAME = "Dapple Level of Detail"
INPUTS = [
    ("Detail in Viewport", "NodeSocketBool"),
    ("Detail in Renders", "NodeSocketBool"),
    ("Detail Distance", "NodeSocketFloat"),
    ("Detail Minimum", "NodeSocketFloat"),
    ("Detail Outside", "NodeSocketFloat"),
    ("Detail Margin", "NodeSocketFloat"),
    ("Detail Fade", "NodeSocketFloat"),
    ("Detail Enlarge", "NodeSocketFloat"),
]
_TINY = 1e-6


def build() -> bpy.types.NodeTree:
    """New group; Hidden is the share that the viewport hides anyway, as Dapple Viewport does."""
    geometry = [("Points", "NodeSocketGeometry")]
    tree = new_group(NAME, [*geometry, *INPUTS, ("Hidden", "NodeSocketFloat")], geometry)
    b = Builder(tree)
    viewport = b.out("GeometryNodeIsViewport")
    view = inner(b, camera_view)
    asked = b.switch(
        "BOOLEAN", viewport, b.input("Detail in Renders"), b.input("Detail in Viewport")
    )
    camera = b.compare("GREATER_EQUAL", view.outputs["Kind"], 0.0, "FLOAT")
    near = _near(b, view.outputs["Distance"])
    share = b.number("MULTIPLY", near, _inside(b, view.outputs["Outside"]))
    size = b.number("MULTIPLY", _size(b, share, _rank(b, viewport)), _larger(b, near))
    sized = b.captured(b.input("Points"), Size=("FLOAT", size))
    gone = b.compare("LESS_EQUAL", sized.outputs["Size"], 0.0, "FLOAT")
    left = b.out("GeometryNodeDeleteGeometry", sized.outputs[0], gone, domain="POINT")
    shown = _resized(b, left, sized.outputs["Size"])
    used = b.boolean("AND", asked, camera)
    b.output("Points", b.switch("GEOMETRY", used, b.input("Points"), shown))
    b.arrange()
    return tree


def _near(b: Builder, distance: Socket) -> Socket:
    """Share that is kept at a distance: as many per area of the picture, if seen from above."""
    full = b.input("Detail Distance")
    ratio = b.number("DIVIDE", full, b.number("MAXIMUM", distance, full))
    return b.number("MAXIMUM", b.number("MULTIPLY", ratio, ratio), b.input("Detail Minimum"))


def _inside(b: Builder, outside: Socket) -> Socket:
    """1 in the view, and the share that is kept outside."""
    out = b.compare("GREATER_THAN", outside, b.input("Detail Margin"), "FLOAT")
    return b.switch("FLOAT", out, 1.0, b.input("Detail Outside"))


def _rank(b: Builder, viewport: Socket) -> Socket:
    """The place in the order among the points that Dapple Viewport leaves."""
    left = b.number("SUBTRACT", 1.0, b.input("Hidden"))
    of = b.switch("FLOAT", viewport, 1.0, b.number("MAXIMUM", left, _TINY))
    return b.number("DIVIDE", b.attribute("dapple_rank", "FLOAT"), of)


def _size(b: Builder, share: Socket, rank: Socket) -> Socket:
    """1 for ranks below the share, then falling to 0 within a part of it."""
    fade = b.number("MULTIPLY", share, b.input("Detail Fade"))
    over = b.number("SUBTRACT", b.number("ADD", share, fade), rank)
    size = b.number("DIVIDE", over, b.number("MAXIMUM", fade, _TINY))
    return b.number("MAXIMUM", b.number("MINIMUM", size, 1.0), 0.0)


def _larger(b: Builder, near: Socket) -> Socket:
    """Factor by which those that are kept at a distance are larger: at most to the same area."""
    power = b.number("MULTIPLY", b.input("Detail Enlarge"), -0.5)
    return b.number("POWER", b.number("MAXIMUM", near, _TINY), power)


def _resized(b: Builder, points: Socket, size: Socket) -> Socket:
    before = b.attribute_or("scale", "FLOAT_VECTOR", "VECTOR", (1.0, 1.0, 1.0))
    return b.store(points, "scale", b.scaled(before, size), "FLOAT_VECTOR")
