# SPDX-License-Identifier: GPL-3.0-or-later
"""Background work: progress, cancellation, errors and the undo step.

A worker thread computes; between two of its tasks a timer reads and writes the file. Blender
without windows has no timers, so there all work is done at once.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.errors import StoppedError
from ...core.base.steps import Stepper, Steps
from .all_or_nothing import sentence
from .handlers import Subscriber

_LONG = 3600.0  # seconds that Blender without windows waits for a task

at_once = bpy.app.background
_running: "list[Job]" = []


def _nothing(_why: str) -> None: ...


@dataclass(eq=False)
class Job:
    """Steps, and functions that are called when they end."""

    label: str  # of an operator, in English; error messages contain it
    steps: Steps
    done: Callable[[Any], str]  # takes the result; returns the name of an undo step, or ""
    failed: Callable[[str], None]  # takes the reason, a sentence
    stopped: Callable[[str], None] = _nothing  # it was cancelled
    whole: bool | None = None  # whether to do all work at once; None: if there are no windows
    works_during_renders: bool = False
    stepper: Stepper = field(init=False)

    def __post_init__(self) -> None:
        self.stepper = Stepper(self.steps)
        self.whole = at_once if self.whole is None else self.whole
        _running.append(self)

    @property
    def progress(self) -> float:
        """Completed share of the work, in [0, 1]."""
        return self.stepper.progress

    @property
    def waits(self) -> bool:
        """Whether the worker is busy."""
        return self.stepper.waits

    @property
    def is_running(self) -> bool:
        """Whether the job has neither ended nor been cancelled."""
        return self in _running and not self.stepper.is_stopped

    def begin(self) -> None:
        """Do the first step. Errors are raised, and no function is called."""
        try:
            if self._advance(0.0) and self.whole:
                self._finish()
        except BaseException:
            self.abandon()
            raise

    def go_on(self, seconds: float = 0.0) -> bool:
        """Continue for this time, or by one step; returns whether the job has ended in any way."""
        try:
            ended = self._advance(seconds)
            if ended:
                self._finish()
            return ended
        except StoppedError as error:
            self.abandon()
            self.stopped(str(error))
        except Exception as error:
            self.abandon()
            self.failed(sentence(self.label, error))
        except BaseException:
            self.abandon()
            raise
        return True

    def cancel(self) -> None:
        """Ask the worker to stop; the next step ends the job."""
        self.stepper.cancel()

    def abandon(self) -> None:
        """Stop without waiting for the worker; no function is called."""
        self._forget()
        self.stepper.abandon()

    def close(self) -> None:
        """Stop and wait for the worker; no function is called."""
        self._forget()
        self.stepper.close()

    def _advance(self, seconds: float) -> bool:
        ended = self.stepper.run_for(seconds) if seconds else self.stepper.poll()
        while self.whole and not ended:
            ended = self.stepper.poll(wait=_LONG)
        return ended

    def _finish(self) -> None:
        self._forget()
        undo = self.done(self.stepper.result)
        if undo:
            push_undo(undo)

    def _forget(self) -> None:
        if self in _running:
            _running.remove(self)


def is_working() -> bool:
    """Whether any job is running."""
    return any(job.is_running for job in _running)


def _render_began() -> None:
    """Leave the processors to the render."""
    for job in _running:
        if not job.works_during_renders:
            job.cancel()


def _disabled() -> None:
    for job in list(_running):
        job.close()


SUBSCRIBER = Subscriber(render_began=_render_began, disabled=_disabled)

# Modes in which an undo step contains one object or image only.
_OWN_STEPS = ("EDIT", "SCULPT", "PAINT_TEXTURE")


def push_undo(name: str) -> None:
    """Make an undo step of what was written.

    In modes whose undo steps would not contain it none is made: an undo in the mode does not change
    it, an undo of an earlier step does.
    """
    windows = bpy.context.window_manager.windows
    with bpy.context.temp_override(window=windows[0] if windows else None):
        if not bpy.context.mode.startswith(_OWN_STEPS):
            bpy.ops.ed.undo_push(message=name)
