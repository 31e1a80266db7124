# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators of a density: painting on the surface, materials, Show Density."""

import bpy
from bpy.props import IntProperty, StringProperty

from ...core.base.errors import ScatterError
from ...core.base.native import missing
from ...core.settings.density_table import PAINTED
from ..base.step_operators import OPTIONS, AllOrNothing, Status
from ..base.translation import translated, translated_report
from ..scatter.object import is_scatter
from ..settings.updates import settings_changed
from ..surface.polls import may_be_listed, ready
from ..surface.scene_objects import by_full_name
from . import overlay
from .painting import begin_painting, end_painting, painted_scatter


class DAPPLE_OT_paint_density(AllOrNothing, bpy.types.Operator):
    """Paint the density of the points on the surface. Uses the vertex group of the density, or
    adds one with the same weight everywhere: no points where the weight is 0"""

    bl_idname = "dapple.paint_density"
    bl_label = "Paint Density"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        begin_painting(context, PAINTED["DENSITY"])


class DAPPLE_OT_paint_blocked_areas(AllOrNothing, bpy.types.Operator):
    """Paint areas without points on the surface. Uses the vertex group of Blocked Areas, or adds
    an empty one: no points where the weight is 1, whatever the density is"""

    bl_idname = "dapple.paint_blocked_areas"
    bl_label = "Paint Blocked Areas"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        begin_painting(context, PAINTED["BLOCKED"])


class DAPPLE_OT_finish_painting(AllOrNothing, bpy.types.Operator):
    """Leave Weight Paint mode and go back to the scatter"""

    bl_idname = "dapple.finish_painting"
    bl_label = "Finish Painting"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if painted_scatter(context) is None:
            cls.poll_message_set(translated("No surface of a scatter is being painted"))
            return False
        return True

    def work(self, context: bpy.types.Context) -> None:
        end_painting(context)


class DAPPLE_OT_add_material(AllOrNothing, bpy.types.Operator):
    """Add a material of the surface to those whose faces have points"""

    bl_idname = "dapple.add_material"
    bl_label = "Add Material"
    bl_options = OPTIONS

    material: StringProperty(name="Material", description="Full name of the material")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        why = translated(
            "The materials come from a linked file: choose them there, or make the scatter local"
        )
        return may_be_listed(cls, context, why)

    def work(self, context: bpy.types.Context) -> None:
        found = by_full_name(bpy.data.materials, self.material)
        chosen = context.object.dapple.density.materials
        if found is None:
            raise ScatterError(
                translated_report("There is no material '{name}'", name=self.material)
            )
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
        why = translated(
            "The materials come from a linked file: choose them there, or make the scatter local"
        )
        return may_be_listed(cls, context, why)

    def work(self, context: bpy.types.Context) -> Status | None:
        chosen = context.object.dapple.density.materials
        if self.index >= len(chosen):
            return {"CANCELLED"}
        chosen.remove(self.index)
        settings_changed(context.object.dapple, context)
        return None


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


CLASSES = (
    DAPPLE_OT_paint_density,
    DAPPLE_OT_paint_blocked_areas,
    DAPPLE_OT_finish_painting,
    DAPPLE_OT_add_material,
    DAPPLE_OT_remove_material,
    DAPPLE_OT_show_density,
)
