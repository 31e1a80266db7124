# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs one case in a process of its own; prints a line of JSON.

Arguments: the case, how many processors it may use, how often it is run, the seed, the mesh file or
nothing.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import time
from pathlib import Path
from statistics import median

FIGURES = ("alpha_min", "alpha_mean", "capacity_variation", "bond_order", "evaluations")


def main() -> None:
    name, threads, runs, seed, file = sys.argv[1:6]
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: int(threads)])

    from benchmarks.speed.cases import Mesh, cases  # after it is known how many threads there are

    run = cases(Mesh(Path(file) if file else None))[name](int(seed))
    walls, processor, report = [], [], None
    for _ in range(int(runs)):
        wall, cpu = time.perf_counter(), time.process_time()
        report = run()
        walls.append(time.perf_counter() - wall)
        processor.append(time.process_time() - cpu)
    found = {
        "seconds": median(walls),
        "processor_seconds": median(processor),
        "peak_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
        "figures": {key: getattr(report, key) for key in FIGURES} if report else {},
    }
    print(json.dumps(found))


if __name__ == "__main__":
    main()
