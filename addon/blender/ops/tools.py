# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that are done at once: the list of classes, materials, locks, the worst overlap."""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ...core.errors import ScatterError
from ..base.job import OPTIONS, AllOrNothing, Status
from ..base.translation import reported, told
from ..data.locking import lock_points
from ..settings.updates import settings_changed
from ..steps.classes import change_classes, select_overlap
from ..surface.beside import by_full_name
from .polls import writable


def _may_be_listed(cls: type[bpy.types.Operator], context: bpy.types.Context, why: str) -> bool:
    """Whether the active object is a scatter whose lists can be edited; else it is said why."""
    if not writable(cls, context):
        return False
    if context.object.override_library:
        cls.poll_message_set(why)
    return not context.object.override_library


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
        return _may_be_listed(cls, context, why)

    def work(self, context: bpy.types.Context) -> None:
        change_classes(context.object, self.action)
        settings_changed(context.object.dapple, context)


class DAPPLE_OT_add_material(AllOrNothing, bpy.types.Operator):
    """Add a material of the surface to those whose faces have points"""

    bl_idname = "dapple.add_material"
    bl_label = "Add Material"
    bl_options = OPTIONS

    material: StringProperty(name="Material", description="Full name of the material")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        why = told(
            "The materials come from a linked file: choose them there, or make the scatter local"
        )
        return _may_be_listed(cls, context, why)

    def work(self, context: bpy.types.Context) -> None:
        found = by_full_name(bpy.data.materials, self.material)
        chosen = context.object.dapple.density.materials
        if found is None:
            raise ScatterError(reported("There is no material '{name}'", name=self.material))
        if all(one.material != found for one in chosen):
            chosen.add().material = found  # which has an update function


class DAPPLE_OT_remove_material(AllOrNothing, bpy.types.Operator):
    """Remove the material from those whose faces have points"""

    bl_idname = "dapple.remove_material"
    bl_label = "Remove Material"
    bl_options = OPTIONS

    index: IntProperty(
        name="Index", description="Index of the material in the list", min=0, soft_max=100
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        why = told(
            "The materials come from a linked file: choose them there, or make the scatter local"
        )
        return _may_be_listed(cls, context, why)

    def work(self, context: bpy.types.Context) -> Status | None:
        chosen = context.object.dapple.density.materials
        if self.index >= len(chosen):
            return {"CANCELLED"}
        chosen.remove(self.index)
        settings_changed(context.object.dapple, context)
        return None


class DAPPLE_OT_lock(AllOrNothing, bpy.types.Operator):
    """Keep the selected points in place when the scatter is optimized, or unlock them. Points can
    be moved, added and deleted in Edit Mode first. In a bake all points move"""

    bl_idname = "dapple.lock"
    bl_label = "Lock or Unlock Points"
    bl_options = OPTIONS

    lock: BoolProperty(
        name="Lock", description="Lock the points; if disabled, unlock them", default=True
    )
    every: BoolProperty(name="All Points", description="Include points that are not selected")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context)

    def work(self, context: bpy.types.Context) -> None:
        count = lock_points(context.object, self.lock, self.every)
        settings_changed(context.object.dapple, context)  # an update may have waited for it
        if self.lock:
            self.report({"INFO"}, reported("Points locked: {count:,}", count=count))
        else:
            self.report({"INFO"}, reported("Points unlocked: {count:,}", count=count))


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
    DAPPLE_OT_add_material,
    DAPPLE_OT_remove_material,
    DAPPLE_OT_lock,
    DAPPLE_OT_select_overlap,
)
