# SPDX-License-Identifier: GPL-3.0-or-later
"""What the mouse points at in the 3D View."""

import bpy
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d

from ...core.surface.arrays import Floats
from ..scatter.object import surface_of
from .picking import met


def place_under_mouse(context: bpy.types.Context, event: bpy.types.Event) -> Floats | None:
    """The place of the active scatter's surface that is under the mouse; None: none is."""
    region, view = context.region, context.region_data
    if view is None:
        return None
    at = event.mouse_region_x, event.mouse_region_y
    origin = region_2d_to_origin_3d(region, view, at)
    return met(surface_of(context.object), origin, region_2d_to_vector_3d(region, view, at))
