# SPDX-License-Identifier: GPL-3.0-or-later
"""Placing single points, in Edit Mode or one by one, and locking them."""

import bpy
import numpy as np
from bpy.props import BoolProperty, FloatVectorProperty, IntProperty

from ..base.step_operators import OPTIONS, AllOrNothing, Status, tried
from ..base.translation import translated, translated_report
from ..scatter.linked_data import read_only
from ..settings.updates import settings_changed
from ..solve import auto_update
from ..surface.polls import editable, writable
from .editing import add_vertex, begin_editing, edited_scatter, end_editing
from .hand_placed import lock_points
from .picking import place_under_mouse
from .single_points import add_point, move_point, remove_point


class DAPPLE_OT_edit_points(AllOrNothing, bpy.types.Operator):
    """Add, move and remove single points in Edit Mode. Added and moved points are locked; the next
    optimization arranges the others around them"""

    bl_idname = "dapple.edit_points"
    bl_label = "Edit Points"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return editable(cls, context)

    def work(self, context: bpy.types.Context) -> None:
        begin_editing(context)


class DAPPLE_OT_finish_editing_points(AllOrNothing, bpy.types.Operator):
    """Leave Edit Mode, attach added and moved points to the surface and lock them"""

    bl_idname = "dapple.finish_editing_points"
    bl_label = "Finish Editing Points"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = edited_scatter(context)
        if obj is None:
            cls.poll_message_set(translated("No points of a scatter are being edited"))
        elif read_only(obj):
            cls.poll_message_set(read_only(obj))
        else:
            return True
        return False

    def work(self, context: bpy.types.Context) -> None:
        placed, removed = end_editing(context)
        auto_update.touch(context.object)
        text = translated_report(
            "Points placed and locked: {placed:,}, removed: {removed:,}",
            placed=placed,
            removed=removed,
        )
        self.report({"INFO"}, text)


class _PointOperator(AllOrNothing):
    """An operator that edits a single point of the active scatter."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return editable(cls, context)

    def work(self, context: bpy.types.Context) -> None:
        self.place(context.object)
        auto_update.touch(context.object)

    def place(self, obj: bpy.types.Object) -> None:
        """Edit the point."""
        raise NotImplementedError


class _LocationOperator(_PointOperator):
    location: FloatVectorProperty(
        name="Location",
        description="Position in world space; the nearest position on the surface is used",
        subtype="XYZ",
        unit="LENGTH",
    )


class DAPPLE_OT_add_point(_LocationOperator, bpy.types.Operator):
    """Add a point and lock it"""

    bl_idname = "dapple.add_point"
    bl_label = "Add Point"
    bl_options = OPTIONS

    object_type: IntProperty(
        name="Object Type", description="Number of its object type, from 0", min=0, soft_max=9
    )

    def place(self, obj: bpy.types.Object) -> None:
        add_point(obj, np.array(self.location), self.object_type)


class DAPPLE_OT_place_point(_LocationOperator, bpy.types.Operator):
    """Add a point under the mouse while the points of a scatter are edited"""

    bl_idname = "dapple.place_point"
    bl_label = "Place Point"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return edited_scatter(context) is not None and context.mode == "EDIT_MESH"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Add the point under the mouse."""
        return tried(self, context, lambda: self._place_there(context, event))

    def _place_there(self, context: bpy.types.Context, event: bpy.types.Event) -> Status | None:
        place = place_under_mouse(context, event)
        if place is None:
            self.report({"WARNING"}, translated_report("The surface is not under the mouse"))
            return {"CANCELLED"}
        self.location = place
        self.work(context)
        return None

    def place(self, obj: bpy.types.Object) -> None:
        add_vertex(obj, np.array(self.location))


class _PointIdOperator:
    id: IntProperty(name="ID", description="ID of the point", min=0, soft_max=100_000)


class DAPPLE_OT_move_point(_LocationOperator, _PointIdOperator, bpy.types.Operator):
    """Move a point and lock it"""

    bl_idname = "dapple.move_point"
    bl_label = "Move Point"
    bl_options = OPTIONS

    def place(self, obj: bpy.types.Object) -> None:
        move_point(obj, self.id, np.array(self.location))


class DAPPLE_OT_remove_point(_PointOperator, _PointIdOperator, bpy.types.Operator):
    """Remove a point"""

    bl_idname = "dapple.remove_point"
    bl_label = "Remove Point"
    bl_options = OPTIONS

    def place(self, obj: bpy.types.Object) -> None:
        remove_point(obj, self.id)


class DAPPLE_OT_lock_points(AllOrNothing, bpy.types.Operator):
    """Keep the selected points in place when the scatter is optimized, or unlock them. Points can
    be moved, added and deleted in Edit Mode first. In a bake all points move"""

    bl_idname = "dapple.lock_points"
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
            self.report({"INFO"}, translated_report("Points locked: {count:,}", count=count))
        else:
            self.report({"INFO"}, translated_report("Points unlocked: {count:,}", count=count))


CLASSES = (
    DAPPLE_OT_edit_points,
    DAPPLE_OT_finish_editing_points,
    DAPPLE_OT_add_point,
    DAPPLE_OT_place_point,
    DAPPLE_OT_move_point,
    DAPPLE_OT_remove_point,
    DAPPLE_OT_lock_points,
)
