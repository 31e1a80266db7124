# SPDX-License-Identifier: GPL-3.0-or-later
"""What the main panel shows of long work: how far it is, with a cross, and how it has ended."""

import bpy

from ..base import jobs
from ..base.labels import BUTTON, lines_of
from .cancel_operators import DAPPLE_OT_cancel_update, DAPPLE_OT_dismiss

_ICONS = {"ERROR": "ERROR", "WARNING": "ERROR", "INFO": "INFO"}


def draw_work(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """A bar while something goes on; else what is to be said of the active object's last work."""
    work, obj = jobs.current(), context.object
    if work is None:
        _end_bar(layout)
    else:
        row = layout.row(align=True)
        row.progress(factor=work.stepper.progress, text=work.line())
        row.operator(DAPPLE_OT_cancel_update.bl_idname, text="", icon="X")
    said = jobs.notes(obj) if obj is not None else []
    if not said:
        return
    row = layout.row()
    column = row.column(align=True)
    for kind, text in said:
        lines_of(column, text, _ICONS[kind], BUTTON)
    row.operator(DAPPLE_OT_dismiss.bl_idname, text="", icon="X")


def _end_bar(layout: bpy.types.UILayout) -> None:
    """Have something without a size come first.

    Blender before 5 takes a bar under the mouse for the first label of what is drawn after it, and
    draws that label as a bar.
    """
    layout.column(align=True).separator(factor=0.0)
