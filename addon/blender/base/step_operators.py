# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that work in steps: at once for scripts and in background mode, otherwise in a timer
while the artist continues.
"""

from collections.abc import Callable
from typing import Any

import bpy

from ...core.base.steps import Steps, run_now
from . import jobs, operator_jobs
from .all_or_nothing import AllOrNothing, Status, tried
from .object_handles import ObjectHandle
from .operator_jobs import Outcome, Work

__all__ = ["OPTIONS", "AllOrNothing", "Status", "StepsOperator", "is_under_way", "tried"]

OPTIONS = {"REGISTER", "UNDO"}  # of operators that change the file


def is_under_way() -> bool:
    """Whether the work of an operator continues in a timer."""
    return operator_jobs.current() is not None


class StepsOperator:
    """Mixin for operators: write steps(context), perhaps done(context, result)."""

    bl_label: str
    report: Callable[[set[str], str], None]

    def steps(self, context: bpy.types.Context) -> Steps:
        """The work."""
        raise NotImplementedError

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        """Called once the work on an object is done; the operator may not exist any more."""
        return Outcome(obj)

    def about(self, context: bpy.types.Context) -> bpy.types.Object:
        """The object whose panel shows the outcome."""
        return context.object

    def written(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Objects whose content is written."""
        return [self.about(context)]

    def watched(self, context: bpy.types.Context) -> dict[int, str]:
        """Data-blocks that must not change during the work: names by session_uid."""
        return {}

    def execute(self, context: bpy.types.Context) -> Status:
        """Do all the work now."""
        return tried(self, context, lambda: self._work(context), lambda: self.written(context))

    def _work(self, context: bpy.types.Context) -> None:
        about = ObjectHandle(self.about(context))
        result = run_now(self.steps(context))
        outcome = self.done(context, result, about.get())
        for kind, text in outcome.messages:
            self.report({kind}, text)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Start the work; its undo step is made when it is done."""
        if jobs.at_once:
            return self.execute(context)
        return tried(self, context, lambda: self._begin(context), lambda: self.written(context))

    def _begin(self, context: bpy.types.Context) -> Status:
        steps, about = self.steps(context), ObjectHandle(self.about(context))
        work = Work(self.bl_label, about, steps, self.done, self.watched(context))
        operator_jobs.begin(context, work)
        return {"CANCELLED"}
