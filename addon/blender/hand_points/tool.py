# SPDX-License-Identifier: GPL-3.0-or-later
"""Tool of the 3D View in Object Mode: click to add a point, drag to move one, Ctrl to remove."""

from typing import Any, ClassVar

import bpy
import gpu
import numpy as np
from bpy.props import BoolProperty
from gpu_extras.batch import batch_for_shader

from ...core.surface.arrays import Floats
from ..base.step_operators import Status, tried
from ..base.translation import translated_report
from ..solve import auto_update
from ..surface.polls import editable
from .hand_placed import kind_of_new
from .picking import place_under_mouse
from .single_points import add_point, move_point, nearest_point, remove_point
from .spray_tool import DAPPLE_TOOL_spray

_GRAB, _REMOVE = 0.35, 1.0  # distances in spacings within which a point is under the mouse
_STILL = 3  # pixels by which the mouse may move during a click
_added: list[type] = []
_COLOR = (1.0, 1.0, 1.0, 0.9)
_WIDTH = 1.5  # pixels, before the scale of the interface
Place = tuple[int, int]  # pixels in the region


class DAPPLE_OT_pull_point(bpy.types.Operator):
    """Click on the surface to add a point, drag a point to move it. Both are locked. With Ctrl,
    remove the nearest point"""

    bl_idname = "dapple.pull_point"
    bl_label = "Pull Point"
    bl_options: ClassVar = {"REGISTER", "UNDO", "INTERNAL"}

    remove: BoolProperty(name="Remove", description="Remove the nearest point")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return editable(cls, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Add or remove a point under the mouse, or start to drag it."""
        return self._tried(context, lambda: self._begin(context, event))

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Move the point when the button is released; Esc and the right button cancel."""
        if event.type in {"ESC", "RIGHTMOUSE"}:
            self._release(context)
            return {"CANCELLED"}
        if event.type == "MOUSEMOVE":
            self._line.to((event.mouse_region_x, event.mouse_region_y))
        if event.type != "LEFTMOUSE" or event.value != "RELEASE":
            return {"RUNNING_MODAL"}
        self._release(context)
        moved = max(abs(event.mouse_x - self._from[0]), abs(event.mouse_y - self._from[1]))
        if moved <= _STILL:
            return {"CANCELLED"}
        return self._tried(context, lambda: self._end(context, event))

    def _tried(self, context: bpy.types.Context, work: Any) -> Status:
        status = tried(self, context, work)
        if status == {"FINISHED"}:
            auto_update.touch(context.object)
        return status

    def _begin(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        obj, place = context.object, self._place(context, event)
        if place is None:
            return {"CANCELLED"}
        spacing = obj.dapple.report.spacing
        point = nearest_point(obj, place, (_REMOVE if self.remove else _GRAB) * spacing)
        if self.remove and point is not None:
            remove_point(obj, point)
        elif not self.remove and point is None:
            kind = kind_of_new(obj)
            add_point(obj, place, kind)
        elif point is None:
            return {"CANCELLED"}
        else:
            self._point, self._from = point, (event.mouse_x, event.mouse_y)
            self._line = Line(context, (event.mouse_region_x, event.mouse_region_y))
            context.window.cursor_modal_set("SCROLL_XY")
            context.window_manager.modal_handler_add(self)
            return {"RUNNING_MODAL"}
        return {"FINISHED"}

    def _end(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        place = self._place(context, event)
        if place is None:
            return {"CANCELLED"}
        move_point(context.object, self._point, place)
        return {"FINISHED"}

    def _place(self, context: bpy.types.Context, event: bpy.types.Event) -> Floats | None:
        place = place_under_mouse(context, event)
        if place is None:
            self.report({"WARNING"}, translated_report("The surface is not under the mouse"))
        return None if place is None else np.asarray(place)

    def _release(self, context: bpy.types.Context) -> None:
        context.window.cursor_modal_restore()
        self._line.remove()


class DAPPLE_TOOL_points(bpy.types.WorkSpaceTool):
    bl_space_type = "VIEW_3D"
    bl_context_mode = "OBJECT"
    bl_idname = "dapple.points"
    bl_label = "Scatter Points"
    bl_description = (
        "Click on the surface of the active scatter to add a point, drag a point to move it, Ctrl "
        "and click to remove one"
    )
    bl_icon = "ops.curves.sculpt_add"
    bl_keymap = (
        ("dapple.pull_point", {"type": "LEFTMOUSE", "value": "PRESS"}, None),
        (
            "dapple.pull_point",
            {"type": "LEFTMOUSE", "value": "PRESS", "ctrl": True},
            {"properties": [("remove", True)]},
        ),
    )


def register() -> None:
    """Add the tools, if there are windows."""
    if not bpy.app.background:
        add_tool()


def add_tool() -> None:
    bpy.utils.register_tool(DAPPLE_TOOL_points, separator=True)
    _added.append(DAPPLE_TOOL_points)
    bpy.utils.register_tool(DAPPLE_TOOL_spray, after={DAPPLE_TOOL_points.bl_idname})
    _added.append(DAPPLE_TOOL_spray)


def unregister() -> None:
    """Remove the tools."""
    while _added:
        bpy.utils.unregister_tool(_added.pop())


class Line:
    """A line that is drawn in the 3D View until it is removed."""

    def __init__(self, context: bpy.types.Context, start: Place) -> None:
        self._region, self._area = context.region.as_pointer(), context.area
        self._ends = start, start
        space, draw = bpy.types.SpaceView3D, self._draw
        self._handler: Any = space.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")

    def to(self, end: Place) -> None:
        """Move the end of the line."""
        self._ends = self._ends[0], end
        self._area.tag_redraw()

    def remove(self) -> None:
        """Take it away."""
        bpy.types.SpaceView3D.draw_handler_remove(self._handler, "WINDOW")
        self._area.tag_redraw()

    def _draw(self) -> None:
        if bpy.context.region.as_pointer() != self._region:
            return
        shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
        shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
        shader.uniform_float("lineWidth", _WIDTH * bpy.context.preferences.system.ui_scale)
        shader.uniform_float("color", _COLOR)
        gpu.state.blend_set("ALPHA")
        batch_for_shader(shader, "LINES", {"pos": [(*one, 0) for one in self._ends]}).draw(shader)
        gpu.state.blend_set("NONE")


CLASSES = (DAPPLE_OT_pull_point,)
