# SPDX-License-Identifier: GPL-3.0-or-later
"""The line from a point that is pulled to the mouse, in the region in which it is pulled."""

from typing import Any

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

_COLOR = (1.0, 1.0, 1.0, 0.9)
_WIDTH = 1.5  # pixels, before the scale of the interface
Place = tuple[int, int]  # pixels in the region


class Line:
    """Drawn from when it is made until it is taken away."""

    def __init__(self, context: bpy.types.Context, start: Place) -> None:
        self._region, self._area = context.region.as_pointer(), context.area
        self._ends = start, start
        space, draw = bpy.types.SpaceView3D, self._draw
        self._handler: Any = space.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")

    def to(self, end: Place) -> None:
        """The mouse is there now."""
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
