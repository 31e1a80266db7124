# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebars with the add-on's panels: whether they may show an object, and redrawing them."""

from collections.abc import Iterator

import bpy


def is_shown(obj: bpy.types.Object) -> bool:
    """Whether a sidebar may show an object."""
    return any(
        window.view_layer.objects.active == obj or _is_painted(obj, window)
        for manager in bpy.data.window_managers
        for window in manager.windows
        if any(_sidebars(window))
    )


def redraw() -> None:
    """Redraw the panels and the preferences."""
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for region in (*_sidebars(window), *_preferences(window)):
                region.tag_redraw()


def _is_painted(obj: bpy.types.Object, window: bpy.types.Window) -> bool:
    """Whether a window shows a scatter while its surface is active and painted."""
    active = window.view_layer.objects.active
    painting = active is not None and active.mode == "WEIGHT_PAINT"
    return painting and window.scene.dapple_painted == obj.name


def _sidebars(window: bpy.types.Window) -> Iterator[bpy.types.Region]:
    for area in window.screen.areas:
        if area.type == "VIEW_3D" and area.spaces.active.show_region_ui:
            yield from (region for region in area.regions if region.type == "UI")


def _preferences(window: bpy.types.Window) -> Iterator[bpy.types.Region]:
    for area in window.screen.areas:
        if area.type == "PREFERENCES":
            yield from area.regions
