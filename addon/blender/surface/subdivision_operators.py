# SPDX-License-Identifier: GPL-3.0-or-later
"""Match Subdivision: the same faces in the viewport as in renders, and whether they differ."""

import bpy
from bpy.props import EnumProperty

from ..base.panel_values import Prepared
from ..base.step_operators import OPTIONS, AllOrNothing
from ..base.translation import told
from ..scatter.library import read_only
from ..scatter.object import active_surface
from .joined import parts_of
from .topology import differences, match_subdivision


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


def _differences(surface: bpy.types.Object) -> tuple[str, ...]:
    return tuple(differences(surface, bpy.context.scene, told))


# Of a surface: by what the viewport and renders differ.
DIFFERENCES = Prepared(_differences, ())


CLASSES = (DAPPLE_OT_match_subdivision,)
