# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that bake, delete a bake, and delete the frames of a stopped bake."""

from typing import Any

import bpy

from ...core.base.steps import Steps
from ..base.operator_jobs import Outcome
from ..base.step_operators import OPTIONS, AllOrNothing, Status, StepsOperator, is_under_way
from ..base.translation import operator_label, translated, translated_count, translated_report
from ..display import preview
from ..freshness import findings
from ..freshness.unfinished_bakes import all_work_files, finished_files
from ..scatter.key_writing import clear_keys
from ..scatter.object import is_scatter
from ..surface.joined_parts import members_of
from ..surface.polls import ready, writable
from .steps import bake_steps


class DAPPLE_OT_bake(StepsOperator, bpy.types.Operator):
    """Keep the points even in every frame of the scene range and store them as keyframes. Points
    that were optimized with other settings are optimized again first"""

    bl_idname = "dapple.bake"
    bl_label = "Bake"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def steps(self, context: bpy.types.Context) -> Steps:
        scene = context.scene
        return bake_steps(context, scene.frame_start, scene.frame_end)

    def watched(self, context: bpy.types.Context) -> dict[int, str]:
        members = members_of(context.object.dapple.surface)
        blocks = [(block, one) for one in members for block in (one, one.data) if block]
        return {block.session_uid: one.name for block, one in blocks}

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        messages = []
        if result.reoptimized_reason:
            preview.restart(obj)
            text = translated_report(
                "The points were optimized again first: {reason}", reason=result.reoptimized_reason
            )
            messages.append(("INFO", text))
        if result.trouble:
            messages.append(("WARNING", result.trouble))
        if result.taken:
            text = translated_report(
                "{taken} of {done} frames were already solved by a stopped bake",
                taken=result.taken,
                done=result.done,
            )
            messages.append(("INFO", text))
        return Outcome(obj, messages)


class DAPPLE_OT_clear_bake(AllOrNothing, bpy.types.Operator):
    """Delete the baked keyframes; the points then stick to the surface where they were optimized"""

    bl_idname = "dapple.clear_bake"
    bl_label = "Clear Bake"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        there = writable(cls, context) and context.mode == "OBJECT"
        return there and context.object.dapple.baked_keys > 0

    def work(self, context: bpy.types.Context) -> None:
        left = finished_files(context.object)
        clear_keys(context.object)
        for files in left:
            files.clear()


class DAPPLE_OT_discard_unfinished_bake(AllOrNothing, bpy.types.Operator):
    """Delete the frames that stopped bakes left behind; the next bake starts at its first frame"""

    bl_idname = "dapple.discard_unfinished_bake"
    bl_label = "Discard Unfinished Bake"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if is_under_way() or not is_scatter(context.object):
            return False
        return findings.has_work_files(context.object, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        if bpy.app.background:
            return self.execute(context)
        count = sum(files.frames() for files in all_work_files(context.object))
        return context.window_manager.invoke_confirm(
            self,
            event,
            title=translated("Discard the unfinished bake?"),
            message=translated_count(
                count,
                "{count} solved frame will be deleted from disk",
                "{count:,} solved frames will be deleted from disk",
            ),
            confirm_text=operator_label(self.bl_label),
            icon="WARNING",
        )

    def work(self, context: bpy.types.Context) -> None:
        for files in all_work_files(context.object):
            files.clear()
        findings.touch(context.object)


CLASSES = (DAPPLE_OT_bake, DAPPLE_OT_clear_bake, DAPPLE_OT_discard_unfinished_bake)
