# SPDX-License-Identifier: GPL-3.0-or-later
"""Schedules work on data that keeps changing: a moment after the last change."""

import math
import time
from collections.abc import Callable

PAUSE = 0.15  # seconds without a change


class Schedule:
    """Keys that wait for their turn, each since its last change."""

    def __init__(self, clock: Callable[[], float] = time.monotonic, pause: float = PAUSE) -> None:
        self._clock, self._pause = clock, pause
        self._changed: dict[int, float] = {}  # times in the order of changes

    def __contains__(self, key: int) -> bool:
        return key in self._changed

    def __bool__(self) -> bool:
        return bool(self._changed)

    def change(self, key: int) -> None:
        """A key has changed now; its pause starts again."""
        self._changed.pop(key, None)
        self._changed[key] = self._clock()

    def hurry(self, key: int) -> None:
        """Make a key the next one, without a pause."""
        self._changed.pop(key, None)
        self._changed = {key: -math.inf, **self._changed}

    def settle(self) -> None:
        """The source of the changes has ended: no key needs to pause any more."""
        self._changed = dict.fromkeys(self._changed, -math.inf)

    def forget(self, key: int) -> None:
        """Remove a key until it changes again."""
        self._changed.pop(key, None)

    def clear(self) -> None:
        """Remove all keys."""
        self._changed.clear()

    def take(self) -> int | None:
        """Remove and return the key that has waited longest, if its pause is over; else None."""
        for key, when in self._changed.items():
            if self._clock() - when >= self._pause:
                del self._changed[key]
                return key
            break  # the others were changed later
        return None

    def wait(self) -> float | None:
        """Seconds until a pause is over; None if no key waits."""
        for when in self._changed.values():
            return max(when + self._pause - self._clock(), 0.0)
        return None
