# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts in the sidebar: as wide as it is, or at its right."""

import blf
import bpy

_FONT, _SIZE = 0, 11  # that of the interface, in points
_MARGIN, _ICON = 56.0, 25.0  # pixels of the sidebar beside a label, and of its icon
BUTTON = 28.0  # pixels of a button that is an icon, and of the gap before it
_LEAST, _WITHOUT_REGION = 140.0, 250.0  # pixels of a line


def lines_of(
    layout: bpy.types.UILayout, text: str, icon: str = "NONE", nearby: float = 0.0
) -> None:
    """A text as labels, as wide as the sidebar is, less the pixels of what is beside them."""
    column = layout.column(align=True)
    for number, line in enumerate(wrapped(text, line_width(icon) - nearby)):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


def line_width(icon: str) -> float:
    """Pixels of a line, at a scale of 1; a background Blender has no region."""
    region, scale = bpy.context.region, bpy.context.preferences.system.ui_scale
    if region is None or region.type != "UI":
        return _WITHOUT_REGION
    taken = _MARGIN if icon == "NONE" else _MARGIN + _ICON
    return max(region.width / scale - taken, _LEAST)


def wrapped(text: str, width: float) -> list[str]:
    """The lines of a text, none wider than so many pixels unless it is one word."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and width_of(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def width_of(text: str) -> float:
    """Of a label, in pixels at a scale of 1."""
    blf.size(_FONT, _SIZE)
    width: float = blf.dimensions(_FONT, text)[0]
    return width


def at_right(row: bpy.types.UILayout, text: str) -> None:
    """A label at the right end of a row."""
    part = row.row()
    part.alignment = "RIGHT"
    part.label(text=text)
