# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts in the sidebar: as wide as it is, or at its right."""

import textwrap

import bpy

_LETTER = 5.7  # pixels of a letter of a label, about
_MARGIN, _ICON = 50.0, 25.0  # pixels of the sidebar beside a label, and of its icon


def lines_of(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    """A text as labels, as wide as the sidebar is."""
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, letters(icon))):
        column.label(text=line, icon="BLANK1" if number and icon != "NONE" else icon)


def letters(icon: str) -> int:
    """That fit into a line; a background Blender has no region."""
    region, scale = bpy.context.region, bpy.context.preferences.system.ui_scale
    width = region.width / scale if region is not None and region.type == "UI" else 0.0
    taken = _MARGIN if icon == "NONE" else _MARGIN + _ICON
    return max(int((width - taken) / _LETTER), 24) if width else 44


def at_right(row: bpy.types.UILayout, text: str) -> None:
    """A label at the right end of a row."""
    part = row.row()
    part.alignment = "RIGHT"
    part.label(text=text)
