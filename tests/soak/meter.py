# SPDX-License-Identifier: GPL-3.0-or-later
"""What a process has and takes, step by step, and whether that stays."""

import ctypes
import gc
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import psutil
from numpy.typing import NDArray

MEMORY = 0.01  # share that may be gained: what allocators and caches vary by
LOOK = 1.0  # seconds at least from a look at the memory to the next
SPEED = 0.05  # share of a step's time that may be gained; only told, since machines are shared
HEAD = ("case", "steps", "minutes", "memory, first", "last", "time of a step, first", "last")
HEAD = (*HEAD, "files, threads, processes, first", "last", "memory", "speed")


# After a step: seconds of the processors in it, bytes that are in memory, and what is open.
READING = np.dtype([("seconds", "f8"), ("memory", "i8"), ("handles", "i4", 3)])


@dataclass(frozen=True)
class Soaked:
    """Readings of a case; the first tenth warms up."""

    name: str
    minutes: float
    readings: NDArray[np.void]  # of READING

    def ends(self) -> tuple[NDArray[np.void], NDArray[np.void]]:
        """The second tenth and the last."""
        tenth = max(len(self.readings) // 10, 1)
        return self.readings[tenth : 2 * tenth], self.readings[-tenth:]

    def memory(self) -> tuple[float, float]:
        """Median bytes of both ends."""
        first, last = (np.median(end["memory"]) for end in self.ends())
        return float(first), float(last)

    def seconds(self) -> tuple[float, float]:
        """Mean seconds of a step, of both ends."""
        first, last = (np.mean(end["seconds"]) for end in self.ends())
        return float(first), float(last)

    def handles(self) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
        """The fewest of both ends: what is left behind never goes."""
        first, last = (end["handles"].min(axis=0) for end in self.ends())
        return tuple(first.tolist()), tuple(last.tolist())

    def keeps_memory(self) -> bool:
        first, last = self.memory()
        return last <= (1.0 + MEMORY) * first

    def keeps_handles(self) -> bool:
        first, last = self.handles()
        return all(now <= before for before, now in zip(first, last, strict=True))

    def row(self) -> list[str]:
        """Of the table under HEAD."""
        (memory, memory_now), (seconds, seconds_now) = self.memory(), self.seconds()
        return [
            *(self.name, f"{len(self.readings):,}", f"{self.minutes:.0f}"),
            *(f"{memory / 1e6:.1f} MB", f"{memory_now / 1e6:.1f} MB"),
            *(f"{1e3 * seconds:.1f} ms", f"{1e3 * seconds_now:.1f} ms"),
            *(", ".join(map(str, one)) for one in self.handles()),
            f"{100 * (memory_now / memory - 1):+.1f} %",
            f"{100 * (seconds_now / seconds - 1):+.1f} %",
        ]


def soaked(name: str, steps: Iterator[None]) -> Soaked:
    """Go through the steps of a case and read the meter after each.

    Readings go to a file: a hundred thousand of them in memory would be a third of what a process
    takes that keeps its memory.
    """
    process, begun = psutil.Process(), time.monotonic()
    memory, next_look = 0, begun
    with tempfile.TemporaryFile() as kept:
        used = time.process_time()
        for _ in steps:
            spent = time.process_time() - used
            if time.monotonic() >= next_look:
                memory, next_look = _memory(process), time.monotonic() + LOOK
            reading = (spent, memory, _handles(process))
            kept.write(np.array(reading, READING).tobytes())
            used = time.process_time()
        kept.seek(0)
        readings = np.frombuffer(kept.read(), READING)
    return Soaked(name, (time.monotonic() - begun) / 60.0, readings)


def _memory(process: psutil.Process) -> int:
    """Bytes in use.

    What the C library keeps of freed memory is given back first: after edits in a random order it
    is a quarter of all, and grows for an hour before it stays.
    """
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    return process.memory_info().rss


def _handles(process: psutil.Process) -> tuple[int, int, int]:
    return process.num_fds(), process.num_threads(), len(process.children())
