# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: fewer points far from the camera and outside its view, evenly spread.

The attribute `dapple_rank` orders points so that every beginning of the order is evenly spread. So
any share of the points is even if the lowest ranks are kept, also where the share varies. Points
without ranks stay wherever any are kept.
"""

import re

import bpy

from .builder import Builder, Group, Socket, inner, new_group

DETAIL_INPUTS = [
    ("Detail in Viewport", "NodeSocketBool"),
    ("Detail in Renders", "NodeSocketBool"),
    ("Detail Full Until", "NodeSocketFloat"),
    ("Detail Minimum", "NodeSocketFloat"),
    ("Detail Outside View", "NodeSocketFloat"),
    ("Detail Margin", "NodeSocketFloat"),
    ("Detail Fade", "NodeSocketFloat"),
    ("Detail Widen", "NodeSocketFloat"),
]
_TINY = 1e-6
# Variables of the expressions: properties of the scene, and their values without a camera.
_VARIABLES = {
    "kind": ("camera.data.type", -1.0),  # 0 perspective, 1 orthographic; others have no frame
    "angle": ("camera.data.angle", 1.0),
    "size": ("camera.data.ortho_scale", 1.0),
    "fit": ("camera.data.sensor_fit", 0.0),  # 1 width, 2 height, 0 the longer of them
    "shift_x": ("camera.data.shift_x", 0.0),
    "shift_y": ("camera.data.shift_y", 0.0),
    "x": ("render.resolution_x", 1.0),
    "y": ("render.resolution_y", 1.0),
    "u": ("render.pixel_aspect_x", 1.0),
    "v": ("render.pixel_aspect_y", 1.0),
}
_HALF = "(size/2 if kind==1 else tan(angle/2))"  # half the frame at distance 1
_SIDE = "(y*v if fit==2 else x*u if fit==1 else max(x*u,y*v))"


def _build_detail() -> bpy.types.NodeTree:
    """New group; Hidden is the share that Dapple Viewport hides."""
    geometry = [("Points", "NodeSocketGeometry")]
    tree = new_group(
        DETAIL.name, [*geometry, *DETAIL_INPUTS, ("Hidden", "NodeSocketFloat")], geometry
    )
    b = Builder(tree)
    viewport, view = b.out("GeometryNodeIsViewport"), inner(b, CAMERA_VIEW)
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
    """Points with a size above 0, scaled by it."""
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
    """Share that is kept at a distance: constant points per area of the picture from above."""
    full = b.input("Detail Full Until")
    ratio = b.number("DIVIDE", full, b.number("MAXIMUM", distance, full))
    return b.number("MAXIMUM", b.number("MULTIPLY", ratio, ratio), b.input("Detail Minimum"))


def _inside(b: Builder, outside: Socket) -> Socket:
    """1 in the view, and the share to keep outside."""
    kept = b.input("Detail Outside View")
    out = b.compare("GREATER_THAN", outside, b.input("Detail Margin"), "FLOAT")
    some = b.compare("LESS_THAN", kept, 1.0, "FLOAT")
    return b.switch("FLOAT", some, 1.0, b.switch("FLOAT", out, 1.0, kept))


def _rank(b: Builder, viewport: Socket) -> Socket:
    """The rank among the points that Dapple Viewport leaves."""
    left = b.number("SUBTRACT", 1.0, b.input("Hidden"))
    of = b.switch("FLOAT", viewport, 1.0, b.number("MAXIMUM", left, _TINY))
    return b.number("DIVIDE", b.attribute("dapple_rank", "FLOAT"), of)


def _size(b: Builder, share: Socket, rank: Socket) -> Socket:
    """1 for ranks below the share, then falling to 0 within a fraction of it."""
    fade = b.number("MULTIPLY", share, b.input("Detail Fade"))
    over = b.number("SUBTRACT", b.number("ADD", share, fade), rank)
    size = b.number("DIVIDE", over, b.number("MAXIMUM", fade, _TINY))
    return b.number("MAXIMUM", b.number("MINIMUM", size, 1.0), 0.0)


def _wider(b: Builder, near: Socket) -> Socket:
    """Factor of the width of distant instances, at most up to the same covered area.

    They do not grow taller, which would be visible against the sky.
    """
    widen = b.input("Detail Widen")
    power = b.number("MULTIPLY", widen, -0.5)
    wider = b.number("POWER", b.number("MAXIMUM", near, _TINY), power)
    return b.switch("FLOAT", b.compare("GREATER_THAN", widen, 0.0, "FLOAT"), 1.0, wider)


def _build_camera_view() -> bpy.types.NodeTree:
    """New group: a point's Distance from the camera, and its distance Outside of the view.

    Kind is below 0 without a camera. Outside is at most 0 in the view and for cameras without a
    frame. For an orthographic camera all points are equally near.
    """
    outputs = [(name, "NodeSocketFloat") for name in ("Distance", "Outside", "Kind")]
    tree = new_group(CAMERA_VIEW.name, [], outputs)
    b = Builder(tree)
    seen, kind = _seen(b), _driven(b, "Kind", "kind")
    x, y, z = b.parts(seen)
    flat = b.compare("EQUAL", kind, 1.0, "FLOAT")
    depth = b.switch("FLOAT", flat, b.number("MULTIPLY", z, -1.0), 1.0)
    sides = [_past(b, axis, at, depth, flat) for axis, at in (("x", x), ("y", y))]
    outside = b.number("MAXIMUM", b.number("MAXIMUM", *sides), z)
    framed = b.compare("LESS_THAN", kind, 1.5, "FLOAT")
    length = b.node("ShaderNodeVectorMath", seen, operation="LENGTH").outputs["Value"]
    b.output("Distance", b.switch("FLOAT", flat, length, 0.0))
    b.output("Outside", b.switch("FLOAT", framed, 0.0, outside))
    b.output("Kind", kind)
    b.arrange()
    return tree


CAMERA_VIEW = Group("Dapple Camera View", _build_camera_view)


def _seen(b: Builder) -> Socket:
    """The point in the camera's axes and in units of the world, whatever the camera's scale."""
    own, camera = (
        b.node("GeometryNodeObjectInfo", b.out(f"GeometryNode{kind}"), transform_space="ORIGINAL")
        for kind in ("SelfObject", "InputActiveCamera")
    )
    place = (camera.outputs["Location"], camera.outputs["Rotation"])
    back = b.out("FunctionNodeInvertMatrix", b.out("FunctionNodeCombineTransform", *place))
    whole = b.out("FunctionNodeMatrixMultiply", back, own.outputs["Transform"])
    return b.out("FunctionNodeTransformPoint", b.out("GeometryNodeInputPosition"), whole)


def _past(b: Builder, axis: str, at: Socket, depth: Socket, flat: Socket) -> Socket:
    """Distance beyond the frame's sides along an axis; negative between them."""
    long = "x*u" if axis == "x" else "y*v"
    half = _driven(b, f"Half {axis.upper()}", f"{_HALF}*{long}/{_SIDE}")
    middle = _driven(b, f"Middle {axis.upper()}", f"-2*{_HALF}*shift_{axis}")
    off = b.number("ABSOLUTE", b.number("MULTIPLY_ADD", depth, middle, at))
    slope = b.switch("FLOAT", flat, half, 0.0)
    length = b.number("SQRT", b.number("MULTIPLY_ADD", slope, slope, 1.0))
    across = b.number("DIVIDE", half, b.number("MULTIPLY", length, -1.0))
    return b.number("MULTIPLY_ADD", depth, across, b.number("DIVIDE", off, length))


def _driven(b: Builder, name: str, expression: str) -> Socket:
    """A number that is driven by the scene and its camera."""
    node = b.node("ShaderNodeValue", name=name, label=name)
    curve = b.tree.driver_add(f'nodes["{node.name}"].outputs[0].default_value')
    driver = curve.driver
    for one, (path, otherwise) in _VARIABLES.items():
        if one in re.findall(r"[a-z_]+", expression):
            variable = driver.variables.new()
            variable.name, variable.type = one, "CONTEXT_PROP"
            target = variable.targets[0]
            target.context_property, target.data_path = "ACTIVE_SCENE", path
            target.use_fallback_value, target.fallback_value = True, otherwise
    driver.expression = expression
    return node.outputs[0]


def _build_viewport() -> bpy.types.NodeTree:
    """New group: hides the points with the largest `dapple_rank`; the others are evenly spread."""
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
