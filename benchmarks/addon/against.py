# SPDX-License-Identifier: GPL-3.0-or-later
"""This add-on and that of another checkout in turns, each time in a new Blender.

Both use the same package `dapple3d`, so that only the add-ons differ.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

_HERE = Path(__file__).resolve().parents[2]
_LIMIT = 900  # seconds for a turn
_MEASURE = """
import importlib, json, os, sys
import addon
addon.register()
module, name, *numbers = json.loads(sys.argv[1])
measure = getattr(importlib.import_module(f"benchmarks.addon.{module}"), name)
print(json.dumps(measure(*numbers)), flush=True)
os._exit(0)
"""


def compared(
    against: Path, turns: int, module: str, name: str, *numbers: int
) -> dict[str, tuple[float, float]]:
    """Median seconds of what a function of `benchmarks.addon` measures: here, and in the other
    checkout.
    """
    here, there = [], []
    for _ in range(turns):
        here.append(_measured(_HERE, module, name, *numbers))
        there.append(_measured(against, module, name, *numbers))
    names = [name for name in here[0] if name in there[0]]
    return {name: (_median(here, name), _median(there, name)) for name in names}


def _measured(checkout: Path, *call: object) -> dict[str, float]:
    """What one new Blender measures."""
    done = subprocess.run(
        [sys.executable, "-c", _MEASURE, json.dumps(call)],
        stdout=subprocess.PIPE,
        text=True,
        check=True,
        timeout=_LIMIT,
        cwd=checkout,
        env={**os.environ, "PYTHONPATH": str(checkout.resolve())},
    )
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


def _median(turns: list[dict[str, float]], name: str) -> float:
    return float(np.median([one[name] for one in turns]))
