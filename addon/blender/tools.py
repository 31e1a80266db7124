# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that are done at once: they change settings, the selection and what is shown."""

import bpy
from bpy.props import BoolProperty, EnumProperty

from ..core.errors import ScatterError
from ..core.native import missing
from ..core.quality import QUALITIES, quality_settings
from . import overlay, preview
from .classes import change_classes, select_overlap
from .job import OPTIONS, Answer
from .library import read_only, writable
from .locking import lock_points
from .scatter import active_surface, is_scatter
from .topology import differences, match_subdivision
from .translation import OWN, reported, told


class DAPPLE_OT_preview(bpy.types.Operator):
    """Keep the points even in the viewport while scrubbing or posing, but not in renders. Run
    again to stop"""

    bl_idname = "dapple.preview"
    bl_label = "Live Preview"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context) and not missing()

    def execute(self, context: bpy.types.Context) -> Answer:
        obj = context.object
        try:
            (preview.stop if preview.is_on(obj) else preview.start)(obj)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DAPPLE_OT_match_subdivision(bpy.types.Operator):
    """Use the same levels of the surface's modifiers in the viewport and in renders"""

    bl_idname = "dapple.match_subdivision"
    bl_label = "Match Subdivision"
    bl_options = OPTIONS

    use: EnumProperty(
        name="Use",
        items=[
            ("RENDER", "Render", "Use the levels of renders in the viewport"),
            ("VIEWPORT", "Viewport", "Use the levels of the viewport in renders"),
        ],
        default="RENDER",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        surface = active_surface(context)
        if surface is None or not differences(surface, context.scene):
            return False
        if read_only(surface):
            cls.poll_message_set(read_only(surface))
        return not read_only(surface)

    def execute(self, context: bpy.types.Context) -> Answer:
        match_subdivision(active_surface(context), context.scene, self.use)
        return {"FINISHED"}


class DAPPLE_OT_edit_classes(bpy.types.Operator):
    """Edit the list of object types; optimize again to apply"""

    bl_idname = "dapple.edit_classes"
    bl_label = "Edit Object Types"
    bl_options = OPTIONS

    action: EnumProperty(
        name="Action",
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
        if not writable(cls, context):
            return False
        if context.object.override_library:
            cls.poll_message_set(told("A library override keeps the object types of its library"))
        return not context.object.override_library

    def execute(self, context: bpy.types.Context) -> Answer:
        change_classes(context.object, self.action)
        return {"FINISHED"}


class DAPPLE_OT_lock(bpy.types.Operator):
    """Keep the selected points in place when the scatter is optimized, or unlock them. Points can
    be moved, added and deleted in Edit Mode first. In a bake all points move"""

    bl_idname = "dapple.lock"
    bl_label = "Lock Points"
    bl_options = OPTIONS

    lock: BoolProperty(
        name="Lock", description="Lock the points; if disabled, unlock them", default=True
    )
    every: BoolProperty(name="All Points", description="Include points that are not selected")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context)

    def execute(self, context: bpy.types.Context) -> Answer:
        try:
            count = lock_points(context.object, self.lock, self.every)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if self.lock:
            self.report({"INFO"}, reported("{count:,} points locked", count=count))
        else:
            self.report({"INFO"}, reported("{count:,} points unlocked", count=count))
        return {"FINISHED"}


class DAPPLE_OT_show_density(bpy.types.Operator):
    """Color the surface by its density, from dark (no points) to yellow (most points), for the
    active object type. Run again to stop"""

    bl_idname = "dapple.show_density"
    bl_label = "Show Density"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and not missing()

    def execute(self, context: bpy.types.Context) -> Answer:
        obj = context.object
        try:
            if overlay.is_on(obj):
                overlay.stop()
            else:
                overlay.start(obj)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DAPPLE_OT_set_quality(bpy.types.Operator):
    """Set how even and how regular the points become; optimize again to apply"""

    bl_idname = "dapple.set_quality"
    bl_label = "Quality"
    bl_options = OPTIONS

    quality: EnumProperty(
        name="Quality", items=QUALITIES, translation_context=OWN, default="NATURAL"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context)

    def execute(self, context: bpy.types.Context) -> Answer:
        for name, value in quality_settings(self.quality).items():
            setattr(context.object.dapple, name, value)
        return {"FINISHED"}


class DAPPLE_OT_select_overlap(bpy.types.Operator):
    """Select the two points whose instances overlap most and place the 3D cursor between them; if
    baked, go to the frame with the largest overlap"""

    bl_idname = "dapple.select_overlap"
    bl_label = "Select Overlap"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        there = writable(cls, context) and context.mode == "OBJECT"
        return there and context.object.dapple.report.worst_overlap > 0

    def execute(self, context: bpy.types.Context) -> Answer:
        try:
            context.scene.cursor.location = select_overlap(context.object, context)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (
    DAPPLE_OT_preview,
    DAPPLE_OT_match_subdivision,
    DAPPLE_OT_edit_classes,
    DAPPLE_OT_lock,
    DAPPLE_OT_show_density,
    DAPPLE_OT_set_quality,
    DAPPLE_OT_select_overlap,
)
