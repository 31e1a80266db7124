# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in steps: a generator on the main thread that hands heavy tasks to a worker.

The generator reads and writes Blender's data and yields a Task whenever numbers are to be
crunched; it is sent the task's result, or is thrown its error. The same generator runs at once
(run_now) or a little at every tick of a timer (Stepper); its `finally` clauses put the scene back
however it ends.
"""

import queue
import threading
import time
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

from .errors import StoppedError
from .native import package

_SHORT = 0.001  # seconds within which short tasks end


@dataclass(frozen=True)
class Task:
    """Work for the worker thread, and its share of the progress."""

    call: Callable[[Any], Any]  # takes a dapple.Context
    begin: float = 0.0
    end: float = 1.0


Steps = Generator[Task, Any, Any]
PAUSE = Task(lambda _: None)  # does nothing, but lets Blender process events


def run_now(steps: Steps) -> Any:
    """Run all steps in this thread; returns the value of the generator."""
    try:
        task = next(steps)
        while True:
            done = (None, None) if task is PAUSE else _outcome(task.call, package().Context())
            task = _answer(steps, *done)
    except StopIteration as stop:
        return stop.value
    finally:
        steps.close()


def _outcome(call: Callable[[Any], Any], context: Any) -> tuple[Any, Exception | None]:
    try:
        return call(context), None
    except Exception as error:  # raised in the generator, which puts the scene back
        return None, error


def _answer(steps: Steps, value: Any, error: Exception | None) -> Task:
    return steps.throw(error) if error else steps.send(value)


class Stepper:
    """Runs steps without blocking: call poll until it returns True, then read result."""

    def __init__(self, steps: Steps) -> None:
        self.result: Any = None
        self._steps = steps
        self._task: Task | None = None
        self._work: Work | None = None
        self._context: Any = None
        self._value: Any = None
        self._error: Exception | None = None
        self._begun = 0  # number of tasks so far
        self._stopped = self._done = False

    @property
    def progress(self) -> float:
        """Share of the whole that is done, in [0, 1]."""
        if self._task is None:
            return 0.0
        return self._task.begin + (self._task.end - self._task.begin) * self._context.progress

    @property
    def waits(self) -> bool:
        """Whether the worker is running a task."""
        return self._work is not None and not self._work.wait(0.0)

    @property
    def is_stopped(self) -> bool:
        """Whether it was cancelled."""
        return self._stopped

    def cancel(self) -> None:
        """Ask the worker to stop; poll then raises StoppedError."""
        self._stopped = True
        if self._context is not None:
            self._context.cancel()

    def poll(self, wait: float = 0.0) -> bool:
        """Go on to the next task, waiting at most so many seconds; True when all is done."""
        if self._done:
            return True
        if self._work is not None and not self._work.wait(wait):
            return False
        try:
            self._start(self._next_task())
        except StopIteration as stop:
            self.result, self._done = stop.value, True
        return self._done

    def run_for(self, seconds: float) -> bool:
        """Go on for so long at most, but no longer than until a task takes its time; True when all
        is done.
        """
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            before = self._begun
            if self.poll(wait=_SHORT):
                return True
            if self._begun == before:
                break
        return False

    def close(self) -> None:
        """Stop the worker, wait for it, and let the generator put the scene back."""
        self.cancel()
        if self._work is not None:
            self._work.wait()
        self._steps.close()

    def abandon(self) -> None:
        """Stop without waiting for the worker, whose result is discarded."""
        self.cancel()
        self._steps.close()

    def _next_task(self) -> Task:
        if self._stopped:
            return self._steps.throw(StoppedError("Canceled: nothing was written"))
        if not self._begun:
            return next(self._steps)
        return _answer(self._steps, self._value, self._error)

    def _start(self, task: Task) -> None:
        self._task, self._context, self._begun = task, package().Context(), self._begun + 1
        self._work, self._value, self._error = None, None, None
        if task is not PAUSE:
            self._work = Work(lambda: self._do(task))

    def _do(self, task: Task) -> None:
        self._value, self._error = _outcome(task.call, self._context)


class Work:
    """A call that a thread runs."""

    def __init__(self, call: Callable[[], None]) -> None:
        self._call: Callable[[], None] | None = call
        self._ended = threading.Event()
        _free_thread().give(self)

    def wait(self, seconds: float | None = None) -> bool:
        """Whether it has ended within so many seconds; None waits without a limit."""
        return self._ended.wait(seconds)

    def do(self, thread: "_Thread") -> None:
        """Run the call in a thread, which becomes free before anyone learns that it has ended."""
        call, self._call = self._call, None  # which may hold this
        try:
            if call is not None:
                call()
            _free.append(thread)
        finally:
            self._ended.set()


class _Thread:
    def __init__(self) -> None:
        self._given: queue.SimpleQueue[Work | None] = queue.SimpleQueue()
        threading.Thread(target=self._run, name="dapple", daemon=True).start()

    def give(self, work: Work | None) -> None:
        """Give it the next call; None ends the thread."""
        self._given.put(work)

    def _run(self) -> None:
        while (work := self._given.get()) is not None:
            work.do(self)
            del work  # and the references that it holds


_free: list[_Thread] = []


def _free_thread() -> _Thread:
    try:
        return _free.pop()
    except IndexError:
        return _Thread()


def free_threads() -> int:
    """How many threads wait for work."""
    return len(_free)


def end_free_threads() -> None:
    """End the threads that wait for work."""
    while _free:
        _free.pop().give(None)
