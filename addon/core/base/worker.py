# SPDX-License-Identifier: GPL-3.0-or-later
"""Threads that take up one call after another.

Embree keeps some memory of each thread that ever built a tree, so that a new thread for each update
would take ever more.
"""

import queue
import threading
from collections.abc import Callable


class Work:
    """A call that a thread is at."""

    def __init__(self, call: Callable[[], None]) -> None:
        self._call: Callable[[], None] | None = call
        self._ended = threading.Event()
        _free_thread().give(self)

    def wait(self, seconds: float | None = None) -> bool:
        """Whether it has ended, within so many seconds; None: however long it takes."""
        return self._ended.wait(seconds)

    def do(self, thread: "_Thread") -> None:
        """What the thread calls; it is free before anyone learns that the work has ended."""
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
        """To be done next; None ends the thread."""
        self._given.put(work)

    def _run(self) -> None:
        while (work := self._given.get()) is not None:
            work.do(self)
            del work  # and what it was done for


_free: list[_Thread] = []


def _free_thread() -> _Thread:
    try:
        return _free.pop()
    except IndexError:
        return _Thread()


def end_free_threads() -> None:
    """End those that wait for work; one that is at work stays."""
    while _free:
        _free.pop().give(None)
