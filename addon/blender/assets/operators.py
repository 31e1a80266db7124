# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators of assets: Mark as Asset, and placing a scatter that was dropped into a scene."""

from contextlib import suppress
from typing import Any

import bpy
from bpy.props import StringProperty

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps
from ..base import jobs
from ..base.operator_jobs import Outcome
from ..base.sidebars import lines_of
from ..base.step_operators import OPTIONS, AllOrNothing, Status, StepsOperator, tried
from ..base.translation import translated, translated_report
from ..scatter.linked_data import read_only
from ..scatter.object import is_surface, is_unsolved
from ..surface.polls import ready
from . import dropped
from .marking import marked
from .placing import place_steps


class DAPPLE_OT_mark_asset(AllOrNothing, bpy.types.Operator):
    """Make an asset of this scatter: its settings, object types and objects, without surface,
    points and bake. Save the file in an asset library, then drop it on any surface"""

    bl_idname = "dapple.mark_asset"
    bl_label = "Mark as Asset"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        made = marked(context.object)
        if not bpy.app.background:
            _draw_preview(context, made)
        text = translated_report(
            "Asset '{name}' added: save the file in an asset library", name=made.name
        )
        self.report({"INFO"}, text)


def _draw_preview(context: bpy.types.Context, asset: bpy.types.Object) -> None:
    """Render the preview of an asset from the active scatter, as the asset itself has no points.

    The asset is valid without a preview.
    """
    draw = bpy.ops.ed.lib_id_generate_preview_from_object
    with context.temp_override(id=asset), suppress(AttributeError, RuntimeError):
        draw()


class DAPPLE_OT_place_scatter(StepsOperator, bpy.types.Operator):
    """Place a scatter that has no points yet on a surface"""

    bl_idname = "dapple.place_scatter"
    bl_label = "Place Scatter"
    bl_options = OPTIONS

    surface: StringProperty(
        name="Surface", description="Name of the surface; if empty, the most likely one"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not ready(cls, context, scatter=True):
            return False
        if not is_unsolved(context.object):
            cls.poll_message_set(
                translated("This scatter has points: choose its surface and optimize")
            )
        return is_unsolved(context.object)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Start the work in the background; it makes an undo step at its end."""
        if jobs.at_once:
            return self.execute(context)
        return tried(self, context, lambda: self._choose(context))

    def _choose(self, context: bpy.types.Context) -> Status:
        context.object.dapple.surface = self._surface(context)
        return {"CANCELLED"}

    def steps(self, context: bpy.types.Context) -> Steps:
        return place_steps(context, self._surface(context))

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        return Outcome(obj, [("WARNING", result)] if result else [])

    def _surface(self, context: bpy.types.Context) -> bpy.types.Object:
        if not self.surface:
            return context.object.dapple.surface or dropped.target_surface(context.object)
        found = context.view_layer.objects.get(self.surface)
        if not is_surface(found):
            raise ScatterError(f"'{self.surface}' is not a surface of the view layer")
        return found


def draw_placing(layout: bpy.types.UILayout, obj: bpy.types.Object) -> bool:
    """Draw the choice of a surface; False if the scatter has one."""
    if dropped.note(obj):
        lines_of(layout, dropped.note(obj), "INFO")
    if not is_unsolved(obj) or obj.dapple.surface is not None:
        return False
    if read_only(obj):
        lines_of(layout, read_only(obj), "LIBRARY_DATA_DIRECT")
        return True
    lines_of(layout, translated("Choose a surface: the points are then placed on it"), "INFO")
    row = layout.row()
    row.scale_y = 1.5
    row.prop(obj.dapple, "surface")
    return True


CLASSES = (DAPPLE_OT_mark_asset, DAPPLE_OT_place_scatter)
