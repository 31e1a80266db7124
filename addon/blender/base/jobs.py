# SPDX-License-Identifier: GPL-3.0-or-later
"""Background work: its progress, how it is cancelled, its undo step, and what becomes of errors.

A worker computes; between two of its tasks a timer reads and writes the file. Blender without
windows has no timers: there all work is done at once.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.errors import StoppedError
from ...core.base.steps import Stepper, Steps
from .all_or_nothing import sentence
from .handlers import Subscriber

_LONG = 3600.0  # seconds that a Blender without windows waits for a worker

at_once = bpy.app.background
_running: "list[Job]" = []


def _nothing(_why: str) -> None: ...


@dataclass(eq=False)
class Job:
    """Steps, and what follows them. An operator's label says in errors what has failed."""

    label: str  # in English
    steps: Steps
    done: Callable[[Any], str]  # takes the result; returns the name of an undo step, or ""
    failed: Callable[[str], None]  # takes the reason, a sentence
    stopped: Callable[[str], None] = _nothing  # it was cancelled
    whole: bool | None = None  # do all of it at once; None: if there are no windows
    works_during_renders: bool = False
    stepper: Stepper = field(init=False)

    def __post_init__(self) -> None:
        self.stepper = Stepper(self.steps)
        self.whole = at_once if self.whole is None else self.whole
        _running.append(self)

    @property
    def progress(self) -> float:
        """Share of the whole that is done, in [0, 1]."""
        return self.stepper.progress

    @property
    def waits(self) -> bool:
        """Whether a worker is at a task."""
        return self.stepper.waits

    @property
    def is_running(self) -> bool:
        """Whether it has neither ended nor been cancelled."""
        return self in _running and not self.stepper.is_stopped

    def begin(self) -> None:
        """Do the first step. Errors are raised, and nothing else follows them."""
        try:
            if self._advance(0.0) and self.whole:
                self._finish()
        except BaseException:
            self.abandon()
            raise

    def go_on(self, seconds: float = 0.0) -> bool:
        """Go on for so long, or by one step; whether it has ended, in whatever way."""
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
        """Stop without waiting for the worker; nothing follows."""
        self._forget()
        self.stepper.abandon()

    def close(self) -> None:
        """Stop and wait for the worker; nothing follows."""
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


def _render_began() -> None:
    """Leave the processors to the render."""
    for job in _running:
        if not job.works_during_renders:
            job.cancel()


def _disabled() -> None:
    for job in list(_running):
        job.close()


SUBSCRIBER = Subscriber(render_began=_render_began, disabled=_disabled)

_OWN_STEPS = ("EDIT", "SCULPT", "PAINT_TEXTURE")  # modes whose steps hold one object or image alone


def push_undo(name: str) -> None:
    """Make what was written a step of its own.

    In modes whose steps would not hold it there is none: an undo there leaves it as it is, and one
    beyond takes it back.
    """
    windows = bpy.context.window_manager.windows
    with bpy.context.temp_override(window=windows[0] if windows else None):
        if not bpy.context.mode.startswith(_OWN_STEPS):
            bpy.ops.ed.undo_push(message=name)
