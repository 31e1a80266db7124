# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators Optimize and Reattach, and those that cancel background work."""

from typing import Any, ClassVar

import bpy
from bpy.props import BoolProperty, EnumProperty

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.solve.class_counts import clearances
from ...core.solve.solve import nearest_binding
from ..base import operator_jobs
from ..base.object_handles import ObjectHandle
from ..base.operator_jobs import Outcome
from ..base.step_operators import OPTIONS, AllOrNothing, Status, StepsOperator
from ..base.translation import operator_label, translated, translated_report
from ..display import preview
from ..freshness.concurrent_edits import check_points_kept, points_now
from ..scatter.object import check_all_over, settings_of
from ..scatter.points import columns_with_own_ids, places_of
from ..surface.current_binding import rest_of
from ..surface.joined_surface import surface_for
from ..surface.polls import ready
from ..surface.reading import as_read, read
from ..surface.rest_position import kind_of_binding, rest_position
from . import auto_update
from .optimize import optimize_steps
from .session_solutions import write_reattached
from .small_parts import names_of, select, small_parts_of


def _confirms(operator: Any, context: bpy.types.Context) -> bool:
    """Whether the artist is asked to confirm that a bake is deleted."""
    if not context.object.dapple.baked_keys or operator.delete_keyframes or bpy.app.background:
        return False
    bpy.ops.dapple.delete_keyframes("INVOKE_DEFAULT", action=operator._action)
    return True  # it starts again once the user has confirmed


class _DeletesKeyframes(StepsOperator):
    """An operator that deletes baked keyframes."""

    _action: ClassVar[str]
    delete_keyframes: BoolProperty(
        name="Delete Keyframes",
        description="Delete baked keyframes without asking",
        options={"HIDDEN", "SKIP_SAVE"},
    )


class DAPPLE_OT_delete_keyframes(AllOrNothing, bpy.types.Operator):
    """Continue with the operation that deletes the baked keyframes"""

    bl_idname = "dapple.delete_keyframes"
    bl_label = "Delete Baked Keyframes"
    bl_options: ClassVar = {"INTERNAL"}

    action: EnumProperty(
        name="Action",
        description="Operation that follows once the keyframes are deleted",
        items=[
            ("OPTIMIZE", "Optimize", "Optimize the points again"),
            ("REATTACH", "Reattach", "Attach the points to the nearest places"),
        ],
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        settings = context.object.dapple
        last = settings.baked_start + settings.baked_frames - 1
        return context.window_manager.invoke_confirm(
            self,
            event,
            title=translated("Delete the bake?"),
            message=translated(
                "The keyframes of frames {first} to {last} will be deleted",
                first=settings.baked_start,
                last=last,
            ),
            confirm_text=operator_label(self.bl_label),
            icon="WARNING",
        )

    def work(self, context: bpy.types.Context) -> None:
        operator = getattr(bpy.ops.dapple, self.action.lower())
        try:
            operator("INVOKE_DEFAULT", delete_keyframes=True)
        except RuntimeError as error:  # its report
            raise ScatterError(str(error).removeprefix("Error: ").strip()) from error


class DAPPLE_OT_optimize(_DeletesKeyframes, bpy.types.Operator):
    """Distribute the points evenly on the surface in the current frame. Baked keyframes are
    deleted"""

    bl_idname = "dapple.optimize"
    bl_label = "Optimize"
    bl_options = OPTIONS
    _action = "OPTIMIZE"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Start the work in the background; it makes an undo step at its end."""
        if bpy.app.background:
            return self.execute(context)
        if not _confirms(self, context):
            auto_update.request(context.object)
        return {"CANCELLED"}

    def execute(self, context: bpy.types.Context) -> Status:
        auto_update.forget(context.object)
        return StepsOperator.execute(self, context)

    def steps(self, context: bpy.types.Context) -> Steps:
        return optimize_steps(ObjectHandle(context.object))

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        preview.restart(obj)
        return Outcome(obj)


def reattach_steps(context: bpy.types.Context) -> Steps:
    """Bind the active scatter to the places of its surface that are nearest to its points."""
    check_all_over(context.object, "Optimize puts its points on the edges of the present faces")
    handle = ObjectHandle(context.object)
    with surface_for(context.object) as surface:
        kind = kind_of_binding(surface.get(), context, context.object.dapple.attach_to)
        before, arrays = points_now(context.object), read(surface.get())
        points, columns = places_of(context.object), columns_with_own_ids(context.object)
        settings = settings_of(context.object)
        binding = yield Task(lambda _: nearest_binding(points, arrays))
        columns["dapple_clearance"] = clearances(points, columns["dapple_object_type"], settings)
        obj = handle.get()
        check_points_kept(obj, before, "attached")
        with as_read(arrays, surface), rest_position(surface, kind):
            rest = rest_of(surface.get(), arrays, binding, kind)
            write_reattached(obj, arrays, binding, columns, rest)
    return obj


class DAPPLE_OT_reattach(_DeletesKeyframes, bpy.types.Operator):
    """Attach the points to the nearest places of a surface whose faces changed. Go to the frame
    and pose in which they were optimized first. Baked keyframes are deleted"""

    bl_idname = "dapple.reattach"
    bl_label = "Reattach"
    bl_options = OPTIONS
    _action = "REATTACH"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        if _confirms(self, context):
            return {"CANCELLED"}
        return StepsOperator.invoke(self, context, event)

    def steps(self, context: bpy.types.Context) -> Steps:
        return reattach_steps(context)

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        preview.restart(obj)
        return Outcome(obj)


class DAPPLE_OT_cancel_update(AllOrNothing, bpy.types.Operator):
    """Cancel the running update; the points stay unchanged"""

    bl_idname = "dapple.cancel_update"
    bl_label = "Cancel Update"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        is_running = auto_update.is_active() or operator_jobs.current() is not None
        if not is_running:  # then Esc does what it does without the add-on
            cls.poll_message_set(translated("No points are being updated"))
        return is_running

    def work(self, context: bpy.types.Context) -> None:
        if operator_jobs.current() is not None:
            operator_jobs.cancel()
        else:
            auto_update.cancel()


class DAPPLE_OT_hide_message(AllOrNothing, bpy.types.Operator):
    """Hide this message"""

    bl_idname = "dapple.hide_message"
    bl_label = "Hide Message"
    bl_options: ClassVar = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and bool(operator_jobs.notes(context.object))

    def work(self, context: bpy.types.Context) -> None:
        operator_jobs.dismiss(context.object)


class DAPPLE_OT_select_small_parts(AllOrNothing, bpy.types.Operator):
    """Select the parts of the surface that are too small for a whole point: their objects, and
    their faces for Edit Mode"""

    bl_idname = "dapple.select_small_parts"
    bl_label = "Select Small Parts"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def work(self, context: bpy.types.Context) -> None:
        parts = small_parts_of(context.object)
        if not parts:
            self.report({"INFO"}, translated_report("Every part has room for a whole point"))
            return
        select(context, parts)
        text = translated_report(
            "{count:,} parts are too small for a whole point: {names}",
            count=len(parts),
            names=names_of(parts),
        )
        self.report({"INFO"}, text)


CLASSES = (
    DAPPLE_OT_cancel_update,
    DAPPLE_OT_hide_message,
    DAPPLE_OT_delete_keyframes,
    DAPPLE_OT_optimize,
    DAPPLE_OT_reattach,
    DAPPLE_OT_select_small_parts,
)
