# SPDX-License-Identifier: GPL-3.0-or-later
"""The main panel in the 3D View's sidebar, and the order of its sub-panels."""

import bpy

from ..core.base.native import missing
from .add.operators import DAPPLE_OT_surface_from_selected
from .add.panel import DAPPLE_MT_over_collection, draw_surface
from .add.scatter_list import DAPPLE_OT_select_surface
from .assets.operators import draw_placing
from .bake.panel import DAPPLE_PT_animation
from .base.sidebars import lines_of
from .base.translation import translated
from .density.panel import DAPPLE_MT_materials, DAPPLE_PT_density, draw_painting
from .display.panel import DAPPLE_PT_display
from .hair.panel import DAPPLE_PT_hair
from .hand_points.panel import DAPPLE_PT_placement, draw_editing
from .object_types.panel import DAPPLE_PT_instances, DAPPLE_UL_object_types
from .presets.operators import draw_presets
from .remesh.operators import DAPPLE_OT_remesh
from .scatter.object import active_surface, is_scatter, is_surface, rest_note
from .scatter.panel import Panel
from .solve.operators import DAPPLE_OT_optimize
from .solve.panel import DAPPLE_PT_advanced, DAPPLE_PT_amount, DAPPLE_PT_details
from .solve.results_panel import draw_result, draw_work
from .surface import subdivision
from .surface.subdivision import DAPPLE_OT_match_subdivision
from .tiles.panel import DAPPLE_PT_tiles

SUB_PANELS = (  # in the order in which the sidebar shows them
    DAPPLE_UL_object_types,
    DAPPLE_MT_over_collection,
    DAPPLE_MT_materials,
    DAPPLE_PT_details,
    DAPPLE_PT_instances,
    DAPPLE_PT_amount,
    DAPPLE_PT_density,
    DAPPLE_PT_placement,
    DAPPLE_PT_display,
    DAPPLE_PT_animation,
    DAPPLE_PT_tiles,
    DAPPLE_PT_hair,
    DAPPLE_PT_advanced,
)


class DAPPLE_PT_main(Panel, bpy.types.Panel):
    bl_label = "Dapple"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        if missing():
            lines_of(layout, missing(), "ERROR")
            return
        draw_work(layout, context)
        if draw_editing(layout, context):
            return
        if is_scatter(context.object):
            if not draw_placing(layout, context.object):
                _draw_scatter(layout, context)
        elif not draw_painting(layout, context):
            draw_surface(layout, context.object)
            if is_surface(context.object):
                layout.operator(DAPPLE_OT_remesh.bl_idname, icon="MOD_REMESH")
            _draw_mismatch(layout, context, "INFO")


def _draw_scatter(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    settings = context.object.dapple
    row = layout.row()
    part = row.row(align=True)
    part.prop(settings, "surface")
    if len(context.selected_objects) > 1:
        part.operator(DAPPLE_OT_surface_from_selected.bl_idname, text="", icon="IMPORT")
    part.operator(DAPPLE_OT_select_surface.bl_idname, text="", icon="RESTRICT_SELECT_OFF")
    draw_presets(row)
    row = layout.row()
    row.scale_y = 1.5
    row.operator(DAPPLE_OT_optimize.bl_idname, icon="PLAY")
    layout.prop(settings, "quality")
    layout.prop(settings, "auto_update")
    draw_result(layout, context, context.object)
    if settings.attached_to == "FACES" and not rest_note(context.object):
        _draw_mismatch(layout, context, "ERROR")


def _draw_mismatch(layout: bpy.types.UILayout, context: bpy.types.Context, icon: str) -> None:
    surface = active_surface(context)
    causes = subdivision.DIFFERENCES.of(surface) if surface else ()
    if causes:
        text = translated("Viewport and renders differ: {causes}", causes="; ".join(causes))
        lines_of(layout, text, icon)
        layout.operator(DAPPLE_OT_match_subdivision.bl_idname)


CLASSES = (DAPPLE_PT_main, *SUB_PANELS)
