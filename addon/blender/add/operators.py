# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that add a scatter over selected objects, or over a collection as one surface."""

from typing import Any

import bpy
from bpy.props import StringProperty

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps
from ...core.settings.tables import SCATTER
from ..base.operator_jobs import Outcome
from ..base.step_operators import OPTIONS, AllOrNothing, StepsOperator
from ..base.translation import translated, translated_report
from ..scatter.local_views import into_local_views
from ..scatter.object import rest_note
from ..settings.declarations import with_arguments
from ..surface.joined_surface import other_selected, put_on_selected
from ..surface.polls import free, ready
from .steps import add_steps

_ADDED_WITH = [setting for setting in SCATTER if setting.name in ("count", "seed", "attach_to")]


class _AddOperator(StepsOperator):
    """An operator that adds a scatter and makes it active."""

    properties: Any

    def given(self) -> dict[str, Any]:
        """Settings that were passed to the operator."""
        names = [setting.name for setting in _ADDED_WITH]
        return {
            name: getattr(self, name) for name in names if self.properties.is_property_set(name)
        }

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        into_local_views(obj, result.obj)
        if context.object in (obj, None) and context.mode == "OBJECT":  # the artist waits for it
            for other in context.selected_objects:
                other.select_set(False)
            result.obj.select_set(True)
            context.view_layer.objects.active = result.obj
        if result.note:
            return Outcome(result.obj, [("WARNING", result.note)])
        notes = [outside_note(result.hidden), rest_note(result.obj, translated_report)]
        return Outcome(result.obj, [("INFO", note) for note in notes if note])


def outside_note(hidden: float) -> str:
    """Why Outside Only is on; empty if it is not."""
    if not hidden:
        return ""
    return translated_report(
        "Outside Only is on, because {percent} % of the surface is inside other parts",
        percent=round(100 * hidden),
    )


@with_arguments(_ADDED_WITH)
class DAPPLE_OT_add_scatter(_AddOperator, bpy.types.Operator):
    """Scatter points evenly on the active object, or on all selected objects as one surface"""

    bl_idname = "dapple.add_scatter"
    bl_label = "Add Scatter"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=False)

    def steps(self, context: bpy.types.Context) -> Steps:
        return add_steps(context, **self.given())


@with_arguments(_ADDED_WITH)
class DAPPLE_OT_add_over_collection(_AddOperator, bpy.types.Operator):
    """Scatter points evenly on the objects of a collection as one surface. Objects that are added
    to the collection later belong to it too"""

    bl_idname = "dapple.add_over_collection"
    bl_label = "Add Scatter over Collection"
    bl_options = OPTIONS

    collection: StringProperty(
        name="Collection", description="Collection whose objects are one surface"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(translated("Needs Object Mode"))
        return context.mode == "OBJECT" and free(cls)

    def about(self, context: bpy.types.Context) -> bpy.types.Object:
        return context.object or next(iter(self._found().all_objects))

    def steps(self, context: bpy.types.Context) -> Steps:
        return add_steps(context, self._found(), **self.given())

    def _found(self) -> bpy.types.Collection:
        for collection in bpy.data.collections:
            if collection.name_full == self.collection and collection.all_objects:
                return collection
        raise ScatterError(f"There is no collection '{self.collection}' with objects")


class DAPPLE_OT_surface_from_selected(AllOrNothing, bpy.types.Operator):
    """Use the other selected objects as the surface, joined if there are several. The points move
    there when they are next optimized"""

    bl_idname = "dapple.surface_from_selected"
    bl_label = "Surface from Selected"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not ready(cls, context, scatter=True):
            return False
        if not other_selected(context):
            cls.poll_message_set(translated("Needs other selected objects as the surface"))
            return False
        return True

    def work(self, context: bpy.types.Context) -> None:
        put_on_selected(context)


CLASSES = (DAPPLE_OT_add_scatter, DAPPLE_OT_add_over_collection, DAPPLE_OT_surface_from_selected)
