# SPDX-License-Identifier: GPL-3.0-or-later
"""When something that changes again and again is to be worked on: once it has rested for a moment.

Knows neither Blender nor what is to be done; the clock is given, so that time can be made up.
"""

import math
import time
from collections.abc import Callable

PAUSE = 0.15  # seconds without a change


class Schedule:
    """What waits for its turn, by keys, each from its last change on."""

    def __init__(self, clock: Callable[[], float] = time.monotonic, pause: float = PAUSE) -> None:
        self._clock, self._pause = clock, pause
        self._changed: dict[int, float] = {}  # when, in the order of the changes

    def __contains__(self, key: int) -> bool:
        return key in self._changed

    def __bool__(self) -> bool:
        return bool(self._changed)

    def change(self, key: int) -> None:
        """It was changed now; its pause begins anew."""
        self._changed.pop(key, None)
        self._changed[key] = self._clock()

    def hurry(self, key: int) -> None:
        """It is the next one, without a pause."""
        self._changed.pop(key, None)
        self._changed = {key: -math.inf, **self._changed}

    def settle(self) -> None:
        """What changed all of it has ended: none has to wait for more than its turn."""
        self._changed = dict.fromkeys(self._changed, -math.inf)

    def forget(self, key: int) -> None:
        """It is not to be worked on, until it is changed again."""
        self._changed.pop(key, None)

    def clear(self) -> None:
        """Nothing is to be worked on."""
        self._changed.clear()

    def take(self) -> int | None:
        """What has rested longest and for long enough, which waits no more; None: nothing has."""
        for key, when in self._changed.items():
            if self._clock() - when >= self._pause:
                del self._changed[key]
                return key
            break  # the others were changed later
        return None

    def wait(self) -> float | None:
        """Seconds until there is something to take; None where nothing waits."""
        for when in self._changed.values():
            return max(when + self._pause - self._clock(), 0.0)
        return None
