# SPDX-License-Identifier: GPL-3.0-or-later
"""What the main panel shows of a scatter that comes from an asset and has no surface yet."""

import bpy

from ..base.labels import lines_of
from ..base.translation import told
from ..scatter.library import read_only
from ..scatter.object import is_unsolved
from . import dropped


def draw_placing(layout: bpy.types.UILayout, obj: bpy.types.Object) -> bool:
    """The question for a surface; False: it has one."""
    if dropped.note(obj):
        lines_of(layout, dropped.note(obj), "INFO")
    if not is_unsolved(obj) or obj.dapple.surface is not None:
        return False
    if read_only(obj):
        lines_of(layout, read_only(obj), "LIBRARY_DATA_DIRECT")
        return True
    lines_of(layout, told("Choose a surface: the points follow by themselves"), "INFO")
    row = layout.row()
    row.scale_y = 1.5
    row.prop(obj.dapple, "surface")
    return True
