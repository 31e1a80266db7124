# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators about what the viewport shows: preview, density, the same faces as in renders."""

import bpy
from bpy.props import EnumProperty

from ...core.native import missing
from ..base.job import OPTIONS, AllOrNothing
from ..data.joined import parts_of
from ..data.library import read_only
from ..data.scatter import active_surface, is_scatter
from ..surface.topology import differences, match_subdivision
from ..viewport import overlay, preview
from .polls import ready


class DAPPLE_OT_preview(AllOrNothing, bpy.types.Operator):
    """Keep the points even in the viewport while scrubbing or posing, but not in renders. Run
    again to stop"""

    bl_idname = "dapple.preview"
    bl_label = "Live Preview"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        obj = context.object
        (preview.stop if preview.is_on(obj) else preview.start)(obj)


class DAPPLE_OT_match_subdivision(AllOrNothing, bpy.types.Operator):
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

    def work(self, context: bpy.types.Context) -> None:
        match_subdivision(active_surface(context), context.scene, self.use)

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        return [obj for obj in parts_of(active_surface(context)) if obj.type != "MESH"]


class DAPPLE_OT_show_density(AllOrNothing, bpy.types.Operator):
    """Color the surface by its density, from dark (no points) to yellow (most points), for the
    active object type. Run again to stop"""

    bl_idname = "dapple.show_density"
    bl_label = "Show Density"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and not missing()

    def work(self, context: bpy.types.Context) -> None:
        obj = context.object
        if overlay.is_on(obj):
            overlay.stop()
        else:
            overlay.start(obj)


CLASSES = (DAPPLE_OT_preview, DAPPLE_OT_match_subdivision, DAPPLE_OT_show_density)
