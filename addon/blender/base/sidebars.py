# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebars with the add-on's panels: wrapped texts, redrawing, whether an object is shown."""

import re
from collections.abc import Iterator

import blf
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


_FONT, _SIZE = 0, 11  # font of the interface and its size in points
_MARGIN, _ICON = 56.0, 25.0  # pixels of the sidebar beside a label, and of its icon
BUTTON = 28.0  # pixels of an icon button with the gap before it
_WORD = re.compile(r"\S+(?: %\S*)?")  # a percentage is one
_LEAST, _WITHOUT_REGION = 140.0, 250.0  # pixels of a line: smallest, and if there is no region


def lines_of(
    layout: bpy.types.UILayout, text: str, icon: str = "NONE", nearby: float = 0.0
) -> None:
    """Draw a text as labels that fill the sidebar, except `nearby` pixels for other items."""
    column = layout.column(align=True)
    for number, line in enumerate(wrapped(text, line_width(icon) - nearby)):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


def line_width(icon: str) -> float:
    """Width of a line in pixels at a scale of 1; Blender in background mode has no region."""
    region, scale = bpy.context.region, bpy.context.preferences.system.ui_scale
    if region is None or region.type != "UI":
        return _WITHOUT_REGION
    taken = _MARGIN if icon == "NONE" else _MARGIN + _ICON
    return max(region.width / scale - taken, _LEAST)


def wrapped(text: str, width: float) -> list[str]:
    """The lines of a text; only a single word can be wider than this width in pixels."""
    lines: list[str] = []
    for word in _WORD.findall(text):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and width_of(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def width_of(text: str) -> float:
    """Width of a label in pixels at a scale of 1."""
    blf.size(_FONT, _SIZE)
    width: float = blf.dimensions(_FONT, text)[0]
    return width


def at_right(row: bpy.types.UILayout, text: str) -> None:
    """Draw a label at the right end of a row."""
    part = row.row()
    part.alignment = "RIGHT"
    part.label(text=text)
