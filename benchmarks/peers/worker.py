# SPDX-License-Identifier: GPL-3.0-or-later
"""One contender in a process of its own: python -m benchmarks.peers.worker NAME OUT.npz [IN.npz]

Without a task it only says its version. It leaves without the module's own end, where some hang.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # for a Blender that is given the file
from benchmarks.peers.contenders import CONTENDERS, Draw, Task


def version(name: str, module: Any) -> str:
    if name == "bpy":
        return str(module.app.version_string)
    if found := getattr(module, "__version__", None):
        return str(found)
    return importlib.metadata.version(importlib.metadata.packages_distributions()[name][0])


def timed(draw: Draw, runs: int) -> dict[str, Any]:
    """The points of all runs, where those of each end, and what each took."""
    points, seconds, cpu = [], [], []
    for seed in range(runs):
        began, used = time.perf_counter(), time.process_time()
        points.append(draw(seed))
        seconds.append(time.perf_counter() - began)
        cpu.append(time.process_time() - used)
    ends = np.cumsum([len(one) for one in points])
    return {"points": np.vstack(points), "ends": ends, "seconds": seconds, "cpu": cpu}


def main(name: str, made: str, given: str = "") -> None:
    contender = CONTENDERS[name]
    module = importlib.import_module(contender.module)
    found: dict[str, Any] = {"version": version(contender.module, module)}
    if given:
        with np.load(given) as stored:
            task = Task(stored["vertices"], stored["faces"], int(stored["wanted"]))
            runs = int(stored["runs"])
        found |= timed(contender.prepare(module, task), runs)
    part = made.removesuffix(".npz") + ".part.npz"
    np.savez(part, **found)
    os.replace(part, made)
    os._exit(0)


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1 if "--" in sys.argv else 1 :])
