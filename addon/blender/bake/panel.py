# SPDX-License-Identifier: GPL-3.0-or-later
"""The sub-panel Animation: the bake, frames left by a stopped bake, the live preview."""

from typing import ClassVar

import bpy

from ...core.settings.solver_options import MOTION
from ..base.sidebars import lines_of
from ..base.translation import translated, translated_count
from ..display import preview
from ..display.preview import DAPPLE_OT_live_preview
from ..freshness import findings
from ..freshness.content_changes import frozen_note
from ..freshness.unfinished_bakes import unsaved_note
from ..scatter.object import follows_masks
from ..scatter.panel import ScatterPanel, draw_in_header
from .operators import DAPPLE_OT_bake, DAPPLE_OT_clear_bake, DAPPLE_OT_discard_unfinished_bake


class DAPPLE_PT_animation(ScatterPanel, bpy.types.Panel):
    bl_label = "Animation"
    bl_options: ClassVar = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        draw_in_header(self.layout, DAPPLE_OT_bake.bl_idname, "REC")

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.object.dapple
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(context.scene, "frame_start", text="Frame Start")
        layout.prop(context.scene, "frame_end", text="End")
        layout.prop(settings, "population")
        if settings.population == "KEEP_DENSITY":
            layout.prop(settings, "fade_duration")
        else:
            layout.prop(settings, "smoothing")
        for option in MOTION:
            layout.prop(settings, option.name)
        row = layout.row()
        row.active = settings.masks == "FIRST_FRAME" or follows_masks(context.object)
        row.prop(settings, "masks")
        layout.prop(settings, "keyframe_step")
        layout.prop(settings, "new_topology")
        row = layout.row(align=True)
        row.operator(DAPPLE_OT_bake.bl_idname, icon="REC")
        row.operator(DAPPLE_OT_clear_bake.bl_idname, icon="X", text="")
        if settings.baked_keys:
            lines_of(layout, baked_line(context.object), "CHECKMARK")
            if frozen_note(context.object):
                lines_of(layout, frozen_note(context.object), "INFO")
        else:
            lines_of(layout, translated("Not baked: points stick to the surface"), "INFO")
        row = layout.row(align=True)
        row.operator(DAPPLE_OT_live_preview.bl_idname, depress=preview.is_on(context.object))
        row.use_property_split = False
        row.prop(settings, "preview_budget", text="Time (ms)")
        if preview.note(context.object):
            lines_of(layout, preview.note(context.object), "INFO")
        _draw_work_files(layout, findings.findings(context.object, context))
        if unsaved_note() and not settings.baked_keys:
            lines_of(layout, unsaved_note(), "INFO")


def _draw_work_files(layout: bpy.types.UILayout, known: findings.Findings | None) -> None:
    if known is None:
        return
    if known.unfinished:
        text = translated_count(
            known.unfinished,
            "Unfinished bake: {count} frame is solved, Bake continues",
            "Unfinished bake: {count} frames are solved, Bake continues",
        )
        lines_of(layout, text, "INFO")
    if known.left_over:
        text = translated_count(
            known.left_over,
            "{count} frame solved from other settings or points is kept",
            "{count} frames solved from other settings or points are kept",
        )
        lines_of(layout, text, "INFO")
    if known.unfinished or known.left_over:
        layout.operator(DAPPLE_OT_discard_unfinished_bake.bl_idname, icon="TRASH")


def baked_line(obj: bpy.types.Object) -> str:
    """The baked frames, and the deviation on frames between keyframes."""
    settings, report = obj.dapple, obj.dapple.report
    last = settings.baked_start + settings.baked_frames - 1
    line = translated("Baked: frames {first} to {last}", first=settings.baked_start, last=last)
    if settings.baked_keys == settings.baked_frames:
        return line
    return translated(
        "{baked}, {keys} keyframes; between them points are off by {mean:.2g} spacings (at "
        "most {most:.2g})",
        baked=line,
        keys=settings.baked_keys,
        mean=report.key_error_mean,
        most=report.key_error_max,
    )
