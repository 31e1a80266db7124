# SPDX-License-Identifier: GPL-3.0-or-later
"""How honest the progress of long work is, and how soon it stops once cancelled.

For each verb: the progress that a watcher sees at a quarter, half and three quarters of the time,
and the longest wait from cancel() until the work has ended, asked for at nine moments.
"""

from __future__ import annotations

import argparse
import contextlib
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import dapple3d as dapple

from benchmarks.progress.cases import Prepared, cases

INTERVAL = 0.002  # between two looks, in seconds
HONEST = (0.25, 0.75)  # at half of the time
SOON = 0.1  # seconds until cancelled work ends

Work = Callable[[dapple.Context], object]


@dataclass
class Watched:
    """What was seen of one run: (seconds since its start, progress)."""

    seconds: float = 0.0
    end: float = 0.0
    cancelled_after: float = 0.0  # seconds from cancel() to the end
    seen: list[tuple[float, float]] = field(default_factory=list)

    def at(self, share: float) -> float:
        """The progress at that share of the time."""
        return max((p for t, p in self.seen if t <= share * self.seconds), default=0.0)


def watched(case: Work | Prepared, cancel_at: float | None = None) -> Watched:
    """Run the work in a thread of its own and look at it; `cancel_at` in seconds."""
    work = case.ready() if isinstance(case, Prepared) else case
    context, result = dapple.Context(), Watched()

    def run() -> None:
        with contextlib.suppress(dapple.Cancelled):
            work(context)

    thread, asked = threading.Thread(target=run), 0.0
    start = time.perf_counter()
    thread.start()
    while thread.is_alive():
        now = time.perf_counter() - start
        result.seen.append((now, context.progress))
        if cancel_at is not None and not asked and now >= cancel_at:
            context.cancel()
            asked = now
        thread.join(INTERVAL)
    result.seconds, result.end = time.perf_counter() - start, context.progress
    result.cancelled_after = result.seconds - asked if asked else 0.0
    return result


def main() -> None:
    """Print a line for each verb."""
    parser = argparse.ArgumentParser(prog="benchmarks/progress/run.sh", description=__doc__)
    parser.add_argument("--only", help="verbs whose name has this in it")
    parser.add_argument("--size", type=float, default=1.0, help="of every case (default 1)")
    options = parser.parse_args()
    print(f"{'verb':32} {'time':>7} {'25 %':>5} {'50 %':>5} {'75 %':>5} {'end':>4} {'stops in':>9}")
    for name, case in cases(options.size).items():
        if options.only and options.only not in name:
            continue
        run = watched(case)
        stops = [watched(case, run.seconds * k / 10).cancelled_after for k in range(1, 10)]
        quarters = " ".join(f"{run.at(share):5.2f}" for share in (0.25, 0.5, 0.75))
        misses = [] if HONEST[0] <= run.at(0.5) <= HONEST[1] else ["half"]
        misses += [] if run.end == 1.0 else ["end"]
        misses += [] if max(stops) <= SOON else ["cancel"]
        print(
            f"{name:32} {run.seconds:6.2f}s {quarters} {run.end:4.2f} {1000 * max(stops):6.0f} ms"
            f"  {'misses ' + ', '.join(misses) if misses else ''}",
            flush=True,
        )


if __name__ == "__main__":
    main()
