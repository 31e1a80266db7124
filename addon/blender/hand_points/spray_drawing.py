# SPDX-License-Identifier: GPL-3.0-or-later
"""What the spray brush shows in the 3D View: its circle, and the points of a stroke."""

from collections.abc import Callable
from typing import Any

import bpy
import gpu
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader

from ...core.spray import Contact, axes_across
from ...core.surface.arrays import Floats
from ...core.surface.mesh_snapshot import Singles
from .picking import Pixels

_COLOR = (1.0, 1.0, 1.0, 0.9)
_ADDED, _REMOVED = (1.0, 1.0, 1.0, 1.0), (1.0, 0.25, 0.2, 1.0)
_OUTLINE = (0.0, 0.0, 0.0, 1.0)
_DOT, _EDGE = 3.0, 1.0  # radius and outline in pixels, before the scale of the interface
_WIDTH = 1.0  # pixels
_SEGMENTS = 48
_SIDES = 10  # of a dot


class Dots:
    """The points of a stroke in a 3D View, until they are removed."""

    def __init__(
        self, context: bpy.types.Context, places: Callable[[], Floats], gone: bool
    ) -> None:
        self._region, self._places = context.region, places
        self._color = _REMOVED if gone else _ADDED
        space, draw = bpy.types.SpaceView3D, self._draw
        self._handler: Any = space.draw_handler_add(draw, (), "WINDOW", "POST_PIXEL")
        self.redraw()

    def redraw(self) -> None:
        """Show the points as they are now."""
        self._region.tag_redraw()

    def remove(self) -> None:
        """Take them away."""
        bpy.types.SpaceView3D.draw_handler_remove(self._handler, "WINDOW")
        self._region.tag_redraw()

    def _draw(self) -> None:
        context = bpy.context
        if context.region != self._region or context.region_data is None:
            return
        centers = _on_screen(self._places(), context.region, context.region_data)
        if not len(centers):
            return
        scale = context.preferences.system.ui_scale
        shader = gpu.shader.from_builtin("UNIFORM_COLOR")
        for radius, color in ((_DOT + _EDGE, _OUTLINE), (_DOT, self._color)):
            shader.uniform_float("color", color)
            corners = discs(centers, radius * scale)
            batch_for_shader(shader, "TRIS", {"pos": corners}).draw(shader)


def discs(centers: Floats, radius: float) -> Singles:
    """Corners (k, 2) of the triangles of round dots at centers (n, 2), in pixels."""
    turn = np.linspace(0.0, 2.0 * np.pi, _SIDES + 1)
    rim = radius * np.column_stack([np.cos(turn), np.sin(turn)])
    fan = np.stack([np.zeros((_SIDES, 2)), rim[:-1], rim[1:]], axis=1).reshape(-1, 2)
    return (centers[:, None] + fan).reshape(-1, 2).astype(np.float32)


def _on_screen(places: Floats, region: bpy.types.Region, view: bpy.types.RegionView3D) -> Floats:
    """Pixels (k, 2) of the places (n, 3) that are in front of the viewer."""
    matrix = np.array(view.perspective_matrix)
    seen = places @ matrix[:, :3].T + matrix[:, 3]
    seen = seen[seen[:, 3] > 0.0]
    size = np.array([region.width, region.height])
    found: Floats = 0.5 * size * (1.0 + seen[:, :2] / seen[:, 3:])
    return found


def draw_circle(
    region: bpy.types.Region, view: bpy.types.RegionView3D, contact: Contact, radius: float
) -> None:
    """Draw a circle that lies on the surface, with the pixels of the window as coordinates."""
    places = _around(contact, radius)
    seen = [location_3d_to_region_2d(region, view, place) for place in places]
    _draw_line([(one.x + region.x, one.y + region.y) for one in seen if one is not None])


def draw_flat_circle(center: Pixels, radius: float) -> None:
    """Draw a circle beside the surface, of a radius in pixels of the window."""
    turn = np.linspace(0.0, 2.0 * np.pi, _SEGMENTS + 1)
    x, y = center[0] + radius * np.cos(turn), center[1] + radius * np.sin(turn)
    _draw_line(list(zip(x.tolist(), y.tolist(), strict=True)))


def pixels_of(
    region: bpy.types.Region, view: bpy.types.RegionView3D, place: Floats, length: float
) -> float:
    """How many pixels a length has at a place, across the view."""
    aside = place + length * np.array(view.view_matrix.inverted().col[0][:3])
    ends = [location_3d_to_region_2d(region, view, one) for one in (place, aside)]
    return 0.0 if None in ends else float((ends[1] - ends[0]).length)


def _around(contact: Contact, radius: float) -> Floats:
    """Places on a circle around the normal of the surface."""
    x, y = axes_across(contact.normal)
    turn = np.linspace(0.0, 2.0 * np.pi, _SEGMENTS + 1)[:, None]
    circle = np.cos(turn) * x + np.sin(turn) * y
    found: Floats = contact.place + radius * circle
    return found


def _draw_line(ends: list[Pixels]) -> None:
    """Draw a line through pixels of the window, with a dark one under it for bright surfaces."""
    if len(ends) < 2:
        return
    scale = bpy.context.preferences.system.ui_scale
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    batch = batch_for_shader(shader, "LINE_STRIP", {"pos": [(*one, 0) for one in ends]})
    gpu.state.blend_set("ALPHA")
    for width, color in ((3.0 * _WIDTH, (0.0, 0.0, 0.0, 0.35)), (_WIDTH, _COLOR)):
        shader.uniform_float("lineWidth", width * scale)
        shader.uniform_float("color", color)
        batch.draw(shader)
    gpu.state.blend_set("NONE")
