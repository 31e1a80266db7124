# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that work in steps: at once in background mode, else under a timer with Esc."""

import time
from collections.abc import Callable
from typing import ClassVar

import bpy

from ...core.errors import ScatterError, StoppedError
from ...core.steps import Stepper, Steps, run_now
from .translation import operator_label, told

_TICK = 0.01  # seconds between two ticks
_BUDGET = 0.04  # seconds of a tick
Status = set[str]  # that operators return
OPTIONS = {"REGISTER", "UNDO"}  # of operators that change the file


def is_under_way() -> bool:
    """Whether some work goes on under a timer."""
    return bool(StepsOperator.under_way)


class StepsOperator:
    """Mixin for operators: write steps(context), perhaps done(context, result)."""

    bl_label: str
    report: Callable[[set[str], str], None]
    _stepper: Stepper
    _timer: bpy.types.Timer
    under_way: ClassVar[set[int]] = set()  # ids of operators that have begun

    def steps(self, context: bpy.types.Context) -> Steps:
        """The work."""
        raise NotImplementedError

    def done(self, context: bpy.types.Context, result: object) -> None:
        """Called once when the work is done."""

    def execute(self, context: bpy.types.Context) -> Status:
        """Do all the work now."""
        try:
            self.done(context, run_now(self.steps(context)))
        except (ScatterError, StoppedError) as error:
            return self._failed(error)
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Start the work; modal goes on with it."""
        if bpy.app.background:
            return self.execute(context)
        self._stepper = Stepper(self.steps(context))
        StepsOperator.under_way.add(id(self._stepper))
        self._timer = context.window_manager.event_timer_add(_TICK, window=context.window)
        context.window_manager.progress_begin(0.0, 1.0)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """One tick; other events wait, so that the file stays as it was read."""
        if event.type == "ESC" and event.value == "PRESS":
            self._stepper.cancel()
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            if not self._advance():
                self._show(context)
                return {"RUNNING_MODAL"}
            self.done(context, self._stepper.result)
        except (ScatterError, StoppedError) as error:
            self.cancel(context)
            return self._failed(error)
        except BaseException:
            self.cancel(context)
            raise
        self.cancel(context)
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Clean up; Blender calls it too, when a file is opened meanwhile."""
        StepsOperator.under_way.discard(id(self._stepper))
        self._stepper.close()
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace:
            context.workspace.status_text_set(None)

    def _advance(self) -> bool:
        """As many steps as a tick has time for; True when all are done."""
        end = time.monotonic() + _BUDGET
        while (left := end - time.monotonic()) > 0.0:
            if self._stepper.poll(wait=left):
                return True
        return False

    def _show(self, context: bpy.types.Context) -> None:
        progress = self._stepper.progress
        context.window_manager.progress_update(progress)
        text = told(
            "{work}: {progress:.0%}    Esc cancels",
            work=operator_label(self.bl_label),
            progress=progress,
        )
        context.workspace.status_text_set(text)

    def _failed(self, error: Exception) -> Status:
        kind = "WARNING" if isinstance(error, StoppedError) else "ERROR"
        self.report({kind}, str(error))
        return {"CANCELLED"}
