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
    """Keep the points even in the viewport while you scrub or pose; never in a render. Run again
    to end it"""

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
    """Give the surface's modifiers the same levels in the viewport and in the render"""

    bl_idname = "dapple.match_subdivision"
    bl_label = "Match Subdivision"
    bl_options = OPTIONS

    use: EnumProperty(
        name="Use",
        items=[
            ("RENDER", "Render", "Show the render's levels in the viewport"),
            ("VIEWPORT", "Viewport", "Render the viewport's levels"),
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
    """Change the list of classes; optimize again to see it"""

    bl_idname = "dapple.edit_classes"
    bl_label = "Edit Classes"
    bl_options = OPTIONS

    action: EnumProperty(
        name="Action",
        items=[
            ("ADD", "Add", "Add a class; the first takes over what the scatter places now"),
            ("REMOVE", "Remove", "Remove the class that is shown"),
            ("UP", "Move Up", "Move the class that is shown one place up"),
            ("DOWN", "Move Down", "Move the class that is shown one place down"),
        ],
        default="ADD",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not writable(cls, context):
            return False
        if context.object.override_library:
            cls.poll_message_set(told("A library override keeps the classes of its file"))
        return not context.object.override_library

    def execute(self, context: bpy.types.Context) -> Answer:
        change_classes(context.object, self.action)
        return {"FINISHED"}


class DAPPLE_OT_lock(bpy.types.Operator):
    """Keep the selected points where they are when the scatter is optimized, or set them free. In
    Edit Mode points can be moved, added and deleted before; in a bake all points move"""

    bl_idname = "dapple.lock"
    bl_label = "Lock Points"
    bl_options = OPTIONS

    lock: BoolProperty(name="Lock", description="Off: unlock", default=True)
    every: BoolProperty(name="All Points", description="Not only those that are selected")

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
    """Color the surface by its density, from dark for no points to yellow for the most; of the
    class that is shown. Run again to end it"""

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
    """Set how even and how regular the points become; optimize again to see it"""

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
    """Select the two points whose things overlap most, and put the 3D cursor between them; a bake
    goes to the frame in which they do"""

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
