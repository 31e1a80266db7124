# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of drawings in a 3D View: without a window, Blender draws while it renders."""

import bpy
import gpu
import mathutils
import numpy as np
import probe


class DrawingEngine(bpy.types.RenderEngine):
    """Draws into a picture of its own in place of a render."""

    bl_idname = "DAPPLE_TESTS_DRAWING"
    bl_label = "Drawing"
    bl_use_gpu_context = True
    drawing, size, projection = None, (0, 0), None
    found = None  # the picture, or the error

    def render(self, depsgraph):
        try:
            DrawingEngine.found = self._picture()
        except Exception as error:  # Blender would only print it
            DrawingEngine.found = error

    def _picture(self):
        width, height = self.size
        screen = gpu.types.GPUOffScreen(width, height, format="RGBA16F")
        with screen.bind():
            buffer = gpu.state.active_framebuffer_get()
            buffer.clear(color=(0.0, 0.0, 0.0, 1.0), depth=1.0)
            gpu.matrix.load_matrix(mathutils.Matrix.Identity(4))
            gpu.matrix.load_projection_matrix(self.projection)
            DrawingEngine.drawing()
            pixels = buffer.read_color(0, 0, width, height, 4, 0, "FLOAT")
            pixels.dimensions = width * height * 4
        screen.free()
        return np.array(pixels).reshape(height, width, 4)


def picture(draw, low, high, size):
    """What `draw` draws of the box between two corners (x, y), from above: (height, width, 4), with
    the row of the smallest y first.
    """
    (left, bottom), (right, top) = low, high
    across, up = 2.0 / (right - left), 2.0 / (top - bottom)
    DrawingEngine.projection = mathutils.Matrix(
        (
            (across, 0.0, 0.0, -across * (left + right) / 2.0),
            (0.0, up, 0.0, -up * (bottom + top) / 2.0),
            (0.0, 0.0, -1e-3, 0.0),
            (0.0, 0.0, 0.0, 1.0),
        )
    )
    DrawingEngine.drawing, DrawingEngine.size, DrawingEngine.found = draw, size, None
    with probe.registered(DrawingEngine):
        probe.prepare(DrawingEngine)
        bpy.ops.render.render()
    if isinstance(DrawingEngine.found, Exception):
        raise DrawingEngine.found
    return DrawingEngine.found
