# SPDX-License-Identifier: GPL-3.0-or-later
"""The one table, as Markdown and as JSON."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import dapple3d as dapple

from benchmarks.compare.tables import table
from benchmarks.paper.setting import Plate

HEAD = ["fig.", "quantity", "paper", "the paper's preset", "our default", "difference and reason"]
DRAWINGS = {2, 9}
INTRODUCTION = """\
This page reproduces the figures of Chen, Yuan, Choi, Liu and Wang, *Variational Blue Noise
Sampling* (IEEE TVCG 2012). *The paper's preset* is `dapple.PAPER`: white noise, plain L-BFGS,
Euclidean cells, no repulsion, tolerance 1e-5. *Our default* is `sample` and the related functions
without options. *Picture only* means that the text of the paper gives no number and that its
picture was not measured. lambda is 30 unless stated otherwise.

alpha is the distance to the nearest neighbor, 1 for perfect hexagons (alpha min: the normalized
Poisson-disk radius); the variation is the standard deviation of the capacities over their mean;
psi6 is 1 for a hexagonal lattice and 0.37 for white noise. The times of the paper are from a
3.16 GHz Xeon of its day, on one thread; those of other methods are quoted from it and were not
measured. Times on different machines can only be compared in magnitude."""


def machine() -> str:
    """The number and type of the cores, and their load."""
    cores, load = len(os.sched_getaffinity(0)), os.getloadavg()[1]
    return (
        f"{cores} {platform.machine()} cores, load average {load:.1f}, "
        f"including up to {cores} from this run"
    )


def left_out(plates: Sequence[Plate]) -> str:
    """Which of the paper's figures are not here."""
    missing = sorted({*range(1, 18)} - DRAWINGS - {plate.figure for plate in plates})
    drawings = " and ".join(map(str, sorted(DRAWINGS)))
    not_here = f"; not made in this run: {', '.join(map(str, missing))}" if missing else ""
    return f"Figs. {drawings} are drawings{not_here}."


def markdown(plates: Sequence[Plate], command: str, pictures: bool = True) -> str:
    """The page: how it was made, the table and, if asked for, the pictures."""
    rows = [
        [str(plate.figure), row.quantity, row.paper, row.preset, row.default, row.remark]
        for plate in plates
        for row in plate.rows
    ]
    made = f"Made by `{command}` with dapple {dapple.__version__} on {machine()}."
    parts = ["# The paper's figures", made, INTRODUCTION, left_out(plates), table(HEAD, rows)]
    if pictures:
        parts += [
            f"## Fig. {plate.figure}: {plate.title}\n\n![{plate.title}]({plate.picture.name})"
            for plate in plates
        ]
    return "\n\n".join(parts) + "\n"


def record(plates: Sequence[Plate], command: str) -> dict[str, Any]:
    """The same as numbers and text for machines."""
    return {
        "command": command,
        "machine": machine(),
        "version": dapple.__version__,
        "rows": [
            {"figure": plate.figure, "picture": plate.picture.name, **asdict(row)}
            for plate in plates
            for row in plate.rows
        ],
    }


def write(plates: Sequence[Plate], command: str, out: Path) -> None:
    (out / "report.md").write_text(markdown(plates, command))
    (out / "report.json").write_text(json.dumps(record(plates, command), indent=1) + "\n")
