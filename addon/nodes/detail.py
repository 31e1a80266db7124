# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: fewer points far from the camera and outside its view, evenly spread.

Every beginning of the order `dapple_rank` is even. So the points of the first half of it are even
where half is kept, those of the first tenth where a tenth is kept, and where the share changes from
place to place the last ranks go first. Points without ranks stay wherever any are kept.
"""

import bpy

from . import camera_view
from .builder import Builder, Socket, new_group
from .groups import Group, inner

INPUTS = [
    ("Detail in Viewport", "NodeSocketBool"),
    ("Detail in Renders", "NodeSocketBool"),
    ("Detail Distance", "NodeSocketFloat"),
    ("Detail Minimum", "NodeSocketFloat"),
    ("Detail Outside", "NodeSocketFloat"),
    ("Detail Margin", "NodeSocketFloat"),
    ("Detail Fade", "NodeSocketFloat"),
    ("Detail Widen", "NodeSocketFloat"),
]
_TINY = 1e-6


def _build_detail() -> bpy.types.NodeTree:
    """New group; Hidden is the share that the viewport hides anyway, as Dapple Viewport does."""
    geometry = [("Points", "NodeSocketGeometry")]
    tree = new_group(DETAIL.name, [*geometry, *INPUTS, ("Hidden", "NodeSocketFloat")], geometry)
    b = Builder(tree)
    viewport, view = b.out("GeometryNodeIsViewport"), inner(b, camera_view.CAMERA_VIEW)
    where = (b.input(f"Detail in {name}") for name in ("Renders", "Viewport"))
    camera = b.compare("GREATER_EQUAL", view.outputs["Kind"], 0.0, "FLOAT")
    used = b.boolean("AND", b.switch("BOOLEAN", viewport, *where), camera)
    near = _near(b, view.outputs["Distance"])
    share = b.number("MULTIPLY", near, _inside(b, view.outputs["Outside"]))
    size = _size(b, share, _rank(b, viewport))
    b.output("Points", b.switch("GEOMETRY", used, b.input("Points"), _left(b, size, near)))
    b.arrange()
    return tree


DETAIL = Group("Dapple Level of Detail", _build_detail)


def _left(b: Builder, size: Socket, near: Socket) -> Socket:
    """Points that have a size, with the scale that it gives them."""
    sized = b.captured(b.input("Points"), Size=("FLOAT", size), Wider=("FLOAT", _wider(b, near)))
    size, wider = sized.outputs["Size"], sized.outputs["Wider"]
    gone = b.compare("LESS_EQUAL", size, 0.0, "FLOAT")
    left = b.out("GeometryNodeDeleteGeometry", sized.outputs[0], gone, domain="POINT")
    before = b.attribute_or("scale", "FLOAT_VECTOR", "VECTOR", (1.0, 1.0, 1.0))
    wide = b.number("MULTIPLY", size, wider)
    scale = b.vector("MULTIPLY", before, b.out("ShaderNodeCombineXYZ", wide, wide, size))
    most = b.number("MAXIMUM", b.input("Detail Fade"), b.input("Detail Widen"))
    changes = b.compare("GREATER_THAN", most, 0.0, "FLOAT")
    scaled = b.store(left, "scale", scale, "FLOAT_VECTOR")
    return b.switch("GEOMETRY", changes, left, scaled)


def _near(b: Builder, distance: Socket) -> Socket:
    """Share that is kept at a distance: as many per area of the picture, if seen from above."""
    full = b.input("Detail Distance")
    ratio = b.number("DIVIDE", full, b.number("MAXIMUM", distance, full))
    return b.number("MAXIMUM", b.number("MULTIPLY", ratio, ratio), b.input("Detail Minimum"))


def _inside(b: Builder, outside: Socket) -> Socket:
    """1 in the view, and the share that is kept outside."""
    kept = b.input("Detail Outside")
    out = b.compare("GREATER_THAN", outside, b.input("Detail Margin"), "FLOAT")
    some = b.compare("LESS_THAN", kept, 1.0, "FLOAT")
    return b.switch("FLOAT", some, 1.0, b.switch("FLOAT", out, 1.0, kept))


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


def _wider(b: Builder, near: Socket) -> Socket:
    """Factor by which those that are kept at a distance are wider: at most to the same area.

    They grow no taller: that would be seen against the sky.
    """
    widen = b.input("Detail Widen")
    power = b.number("MULTIPLY", widen, -0.5)
    wider = b.number("POWER", b.number("MAXIMUM", near, _TINY), power)
    return b.switch("FLOAT", b.compare("GREATER_THAN", widen, 0.0, "FLOAT"), 1.0, wider)
