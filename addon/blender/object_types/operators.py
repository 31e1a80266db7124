# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of object types, and the pair of instances that overlaps most."""

import bpy
from bpy.props import EnumProperty

from ..base.step_operators import OPTIONS, AllOrNothing
from ..base.translation import told
from ..settings.updates import settings_changed
from ..surface.polls import may_be_listed, writable
from .classes import change_classes, select_overlap


class DAPPLE_OT_edit_classes(AllOrNothing, bpy.types.Operator):
    """Edit the list of object types; optimize again to apply"""

    bl_idname = "dapple.edit_classes"
    bl_label = "Edit Object Types"
    bl_options = OPTIONS

    action: EnumProperty(
        name="Action",
        description="What is done to the list",
        items=[
            (
                "ADD",
                "Add",
                "Add an object type; the first one takes over the current instance settings",
            ),
            ("REMOVE", "Remove", "Remove the active object type"),
            ("UP", "Move Up", "Move the active object type up"),
            ("DOWN", "Move Down", "Move the active object type down"),
        ],
        default="ADD",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        why = told(
            "The object types come from a linked file: edit them there, or make the scatter local"
        )
        return may_be_listed(cls, context, why)

    def work(self, context: bpy.types.Context) -> None:
        change_classes(context.object, self.action)
        settings_changed(context.object.dapple, context)


class DAPPLE_OT_select_overlap(AllOrNothing, bpy.types.Operator):
    """Select the two points whose instances overlap most and place the 3D cursor between them; if
    baked, go to the frame with the largest overlap"""

    bl_idname = "dapple.select_overlap"
    bl_label = "Select Overlap"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        there = writable(cls, context) and context.mode == "OBJECT"
        return there and context.object.dapple.report.worst_overlap > 0

    def work(self, context: bpy.types.Context) -> None:
        context.scene.cursor.location = select_overlap(context.object, context)


CLASSES = (
    DAPPLE_OT_edit_classes,
    DAPPLE_OT_select_overlap,
)
