# SPDX-License-Identifier: GPL-3.0-or-later
"""Tool of the 3D View in Object Mode: a brush that sprays points onto the surface of a scatter."""

from typing import Any

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ..scatter.object import is_scatter, surface_of
from .picking import Pixels, Rays, contact_at
from .spray_drawing import draw_circle, draw_flat_circle, pixels_of
from .spray_operators import (
    TOOL,
    DAPPLE_OT_resize_spray_brush,
    DAPPLE_OT_spray_points,
    anchored,
)

_SPRAY, _RESIZE = DAPPLE_OT_spray_points.bl_idname, DAPPLE_OT_resize_spray_brush.bl_idname


class DAPPLE_TOOL_spray(bpy.types.WorkSpaceTool):
    bl_space_type = "VIEW_3D"
    bl_context_mode = "OBJECT"
    bl_idname = TOOL
    bl_label = "Spray Points"
    bl_description = (
        "Drag over the surface of the active scatter to add points inside the brush, with Ctrl to "
        "remove them. F changes the radius, Shift F the strength"
    )
    bl_icon = "ops.curves.sculpt_density"
    bl_cursor = "PAINT_CROSS"
    bl_keymap = (
        (_SPRAY, {"type": "LEFTMOUSE", "value": "PRESS"}, None),
        (
            _SPRAY,
            {"type": "LEFTMOUSE", "value": "PRESS", "ctrl": True},
            {"properties": [("remove", True)]},
        ),
        (_RESIZE, {"type": "F", "value": "PRESS"}, {"properties": [("setting", "radius")]}),
        (
            _RESIZE,
            {"type": "F", "value": "PRESS", "shift": True},
            {"properties": [("setting", "strength")]},
        ),
    )

    @staticmethod
    def draw_settings(_: bpy.types.Context, layout: bpy.types.UILayout, tool: Any) -> None:
        """Draw the settings of the brush, in the header and in the tab Tool."""
        draw_brush(layout, tool.operator_properties(_SPRAY))

    @staticmethod
    def draw_cursor(_: bpy.types.Context, tool: Any, xy: Pixels) -> None:
        """Draw the circle of the brush on the surface."""
        _draw_cursor(tool.operator_properties(_SPRAY).radius, anchored.at or xy)


def draw_brush(layout: bpy.types.UILayout, settings: Any) -> None:
    """Draw the settings of the brush as Blender draws those of its own."""
    for name, pressure in (
        ("radius", "use_pressure_size"),
        ("strength", "use_pressure_strength"),
    ):
        row = layout.row(align=True)
        row.prop(settings, name, slider=True)
        row.prop(settings, pressure, text="", icon="STYLUS_PRESSURE")
    layout.prop(settings, "spacing")


def _draw_cursor(radius: float, xy: Pixels) -> None:
    context = bpy.context
    region, view, obj = context.region, context.region_data, context.object
    if view is None or not is_scatter(obj) or region.type != "WINDOW":
        return
    length = radius * obj.dapple.report.spacing
    contact = None
    if obj.dapple.surface is not None and obj.dapple.surface.type == "MESH":
        try:
            at = xy[0] - region.x, xy[1] - region.y
            contact = contact_at(region, view, at, Rays(surface_of(obj)))
        except (ScatterError, RuntimeError):  # it is not there, or not evaluated
            contact = None
    if contact is not None:
        draw_circle(region, view, contact, length)
    else:
        draw_flat_circle(xy, pixels_of(region, view, _middle(obj), length))


def _middle(obj: bpy.types.Object) -> Any:
    """The middle of an object in world space."""
    corners = np.array([corner[:] for corner in obj.bound_box])
    matrix = np.array(obj.matrix_world)
    return matrix[:3, :3] @ corners.mean(axis=0) + matrix[:3, 3]
