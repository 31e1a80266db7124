# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: where a point is for the scene's camera.

Node trees of Blender before 5.0 cannot read a camera's lens. Drivers inside this group read it from
the scene that is evaluated. They follow its active camera, cameras bound to markers, animated
lenses and the resolution, in renders and in files that are opened without the add-on; inputs of the
modifier that the add-on keeps current would not. Their expressions need no Python, so Blender asks
nobody to allow scripts.
"""

import re

import bpy

from .builder import Builder, Socket, new_group
from .groups import Group

# What the expressions call a property of the scene, and what it is where there is no camera.
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
_HALF = "(size/2 if kind==1 else tan(angle/2))"  # at distance 1, of the side that the angle is of
_SIDE = "(y*v if fit==2 else x*u if fit==1 else max(x*u,y*v))"


def _build_camera_view() -> bpy.types.NodeTree:
    """New group: a point's Distance from the camera, and how far it is Outside of the view.

    Kind is below 0 where there is no camera. Within the view, and for cameras that have no frame,
    Outside is at most 0. For an orthographic camera all points are equally near.
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
    """The point in the camera's axes, in lengths of the world, whatever the camera's scale."""
    own, camera = (
        b.node("GeometryNodeObjectInfo", b.out(f"GeometryNode{kind}"), transform_space="ORIGINAL")
        for kind in ("SelfObject", "InputActiveCamera")
    )
    place = (camera.outputs["Location"], camera.outputs["Rotation"])
    back = b.out("FunctionNodeInvertMatrix", b.out("FunctionNodeCombineTransform", *place))
    whole = b.out("FunctionNodeMatrixMultiply", back, own.outputs["Transform"])
    return b.out("FunctionNodeTransformPoint", b.out("GeometryNodeInputPosition"), whole)


def _past(b: Builder, axis: str, at: Socket, depth: Socket, flat: Socket) -> Socket:
    """Distance to the frame's sides across an axis, below 0 between them."""
    long = "x*u" if axis == "x" else "y*v"
    half = _driven(b, f"Half {axis.upper()}", f"{_HALF}*{long}/{_SIDE}")
    middle = _driven(b, f"Middle {axis.upper()}", f"-2*{_HALF}*shift_{axis}")
    off = b.number("ABSOLUTE", b.number("MULTIPLY_ADD", depth, middle, at))
    slope = b.switch("FLOAT", flat, half, 0.0)
    length = b.number("SQRT", b.number("MULTIPLY_ADD", slope, slope, 1.0))
    across = b.number("DIVIDE", half, b.number("MULTIPLY", length, -1.0))
    return b.number("MULTIPLY_ADD", depth, across, b.number("DIVIDE", off, length))


def _driven(b: Builder, name: str, expression: str) -> Socket:
    """A number that follows the scene and its camera."""
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
