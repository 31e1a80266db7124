# SPDX-License-Identifier: GPL-3.0-or-later
"""How long many points take, and how much memory: of a whole command and the processes below it."""

from __future__ import annotations

import json
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import psutil  # type: ignore[import-untyped]

from benchmarks.compare.tables import say
from benchmarks.tiles.terrain import side_for, write_hills

HEAD = [
    *("points", "faces", "tiles", "processes", "seconds", "processor seconds"),
    *("points a second", "memory"),
]
LOOK = 0.5  # seconds between two looks at the memory


@dataclass(frozen=True)
class Run:
    """One command."""

    count: int
    faces: int
    tiles: int
    workers: int | None
    seconds: float
    work: float  # seconds of processors
    memory: int  # bytes, at most

    def row(self) -> list[str]:
        """Of the table."""
        return [
            *(f"{self.count:,}", f"{self.faces:,}", str(self.tiles), self.processes()),
            *(f"{self.seconds:.0f}", f"{self.work:.0f}", f"{self.count / self.seconds:,.0f}"),
            f"{self.memory / 1e9:.2f} GB",
        ]

    def processes(self) -> str:
        """What did the work."""
        return "1, all threads" if self.workers is None else f"{self.workers} of Dask, 1 thread"


def run(count: int, tile: int, workers: int | None, *more: str) -> Run:
    """`dapple tiles` on a terrain with two faces for each point."""
    folder = Path(tempfile.mkdtemp())
    try:
        terrain = write_hills(folder / "hills.npy", side_for(2 * count))
        say(f"{count:,} points, {'no workers' if workers is None else f'{workers} workers'}")
        report = folder / "report.json"
        command = [sys.executable, "-m", "dapple3d", "tiles", str(terrain), str(folder / "out")]
        command += ["-n", str(count), "--tile", str(tile), "--json", str(report), *more]
        command += [] if workers is None else ["--workers", str(workers)]
        seconds, work, memory = watched(command)
        found = json.loads(report.read_text(encoding="utf-8"))
    finally:
        shutil.rmtree(folder)
    rows, columns = found["input"]["shape"]
    faces = 2 * (rows - 1) * (columns - 1)
    return Run(count, faces, found["rows"] * found["columns"], workers, seconds, work, memory)


def watched(command: list[str]) -> tuple[float, float, int]:
    """Seconds, those of processors, and the most memory of the process and those below it."""
    begun, worked = time.monotonic(), work_of_children()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    most = 0
    while process.poll() is None:
        most = max(most, memory_below(process.pid))
        time.sleep(LOOK)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return time.monotonic() - begun, work_of_children() - worked, most


def work_of_children() -> float:
    """Seconds of processors, of all processes below this one that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def memory_below(pid: int) -> int:
    """Of a process and those below it; what several share counts for each."""
    total = 0
    try:
        own = psutil.Process(pid)
        for process in [own, *own.children(recursive=True)]:
            total += process.memory_info().rss
    except psutil.NoSuchProcess:
        return total
    return total


def estimate(run: Run, count: int, machines: int, processors: int) -> str:
    """What a measured run says of more points on more machines."""
    tiles = run.tiles * count / run.count
    each = run.work / run.tiles
    hours = tiles * each / (machines * processors) / 3600
    return (
        f"{each:.1f} s of a processor for a tile and its seams: {count:.0e} points are "
        f"{tiles:,.0f} tiles, so {hours:.2f} hours on {machines} x {processors} processors"
    )
