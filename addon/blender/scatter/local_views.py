# SPDX-License-Identifier: GPL-3.0-or-later
"""Local View, which shows some objects alone: new ones appear there with those they belong to."""

import bpy

from .linked_data import is_in_view_layer


def into_local_views(seen: bpy.types.Object, new: bpy.types.Object) -> None:
    """Show a new object in each local view that shows another object."""
    if not is_in_view_layer(new):
        return
    areas = [area for window in bpy.context.window_manager.windows for area in window.screen.areas]
    for space in (area.spaces.active for area in areas if area.type == "VIEW_3D"):
        if space.local_view is not None and seen.visible_get(viewport=space):
            new.local_view_set(space, True)
