# SPDX-License-Identifier: GPL-3.0-or-later
"""Single evaluations of the energy, by the C++ benchmarks (benchmarks/sampling.cpp)."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.compare.cases import ROOT

BINARY = ROOT / "build" / "release" / "benchmarks" / "dapple_benchmarks"
REPEATED = 5


def measured(binary: Path, processors: int) -> dict[str, dict[str, Any]]:
    """Seconds an evaluation by the name of its case."""
    allowed = sorted(os.sched_getaffinity(0))[:processors]
    done = subprocess.run(
        [
            *("taskset", "--cpu-list", ",".join(map(str, allowed)), str(binary)),
            *("--benchmark_filter=one_evaluation", "--benchmark_format=json"),
            f"--benchmark_repetitions={REPEATED}",
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        check=True,
    )
    runs: dict[str, list[dict[str, Any]]] = {}
    for run in json.loads(done.stdout)["benchmarks"]:
        if run["run_type"] == "iteration":
            runs.setdefault("evaluation/" + run["name"].split("/")[1], []).append(run)
    return {
        name: {
            "seconds": 1e-3 * median(run["real_time"] for run in found),
            "processor_seconds": 1e-3 * median(run["cpu_time"] for run in found),
            "figures": {},
        }
        for name, found in runs.items()
    }
