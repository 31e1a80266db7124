# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators about what the viewport shows: preview, density, the same faces as in renders."""

import bpy
from bpy.props import EnumProperty

from ...core.errors import ScatterError
from ...core.native import missing
from ..base.job import OPTIONS, Status
from ..data.joined import parts_of
from ..data.library import read_only
from ..data.scatter import active_surface, is_scatter
from ..surface.topology import differences, match_subdivision
from ..viewport import overlay, preview
from .polls import writable


class DAPPLE_OT_preview(bpy.types.Operator):
    """Keep the points even in the viewport while scrubbing or posing, but not in renders. Run
    again to stop"""

    bl_idname = "dapple.preview"
    bl_label = "Live Preview"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context) and not missing()

    def execute(self, context: bpy.types.Context) -> Status:
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
        description="Which levels are used for both",
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
        reason = next(filter(None, map(read_only, parts_of(surface))), "")
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context: bpy.types.Context) -> Status:
        match_subdivision(active_surface(context), context.scene, self.use)
        return {"FINISHED"}


class DAPPLE_OT_show_density(bpy.types.Operator):
    """Color the surface by its density, from dark (no points) to yellow (most points), for the
    active object type. Run again to stop"""

    bl_idname = "dapple.show_density"
    bl_label = "Show Density"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and not missing()

    def execute(self, context: bpy.types.Context) -> Status:
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


CLASSES = (DAPPLE_OT_preview, DAPPLE_OT_match_subdivision, DAPPLE_OT_show_density)
