# SPDX-License-Identifier: GPL-3.0-or-later
"""How much faster several Blender processes bake several shots than one does, and that the bakes
are the same.

The shots are baked by the command that farms call, each in a process of its own: one after another
on all cores of this machine, one after another on the cores that each of several workers has, and
by so many workers at once.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

from benchmarks.farm.shots import digest, make

ROOT = Path(__file__).resolve().parents[2]
STAND_IN = [sys.executable, str(ROOT / "tests" / "blender" / "stand_in.py")]
GOAL, AT = 1.8, (6, 100, 5000, 2)  # times, with these options


def main() -> None:
    options = _options()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = make(folder / "made", options.shots, options.frames, options.sites)
        cores = sorted(os.sched_getaffinity(0))
        shares = [cores[k :: options.processes] for k in range(options.processes)]
        print(f"{options.shots} shots of {options.frames} frames x {options.sites} sites")
        whole = _run("one process, all cores", folder, made, [cores], options.blender)
        single = _run(f"one process, cores {shares[0]}", folder, made, shares[:1], options.blender)
        several = _run(f"{options.processes} processes", folder, made, shares, options.blender)
        print(f"  {single / several:.2f} times as fast as one of them, ", end="")
        print(f"{whole / several:.2f} times as fast as one process on all cores")
        if (options.shots, options.frames, options.sites, options.processes) == AT:
            met = "met" if single / several >= GOAL else "missed"
            print(f"  goal: {GOAL} times as fast as one of them, {met}")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="benchmarks/farm/run.sh",
        description=__doc__,
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    parser.add_argument("--shots", type=int, default=AT[0])
    parser.add_argument("--frames", type=int, default=AT[1])
    parser.add_argument("--sites", type=int, default=AT[2])
    parser.add_argument("--processes", type=int, default=AT[3])
    parser.add_argument(
        "--blender",
        type=lambda text: [text],
        default=STAND_IN,
        help="executable with the extension enabled; by default Python with the module bpy",
    )
    return parser.parse_args()


def _run(
    name: str, folder: Path, made: list[Path], shares: list[list[int]], blender: list[str]
) -> float:
    """Seconds in which workers, each on its share of the cores, have baked copies of the shots."""
    work = folder / "work"
    shutil.copytree(made[0].parent, work)
    free: SimpleQueue[list[int]] = SimpleQueue()
    for share in shares:
        free.put(share)

    def bake(path: Path) -> None:
        share = free.get()
        try:
            _bake(path, share, blender, folder)
        finally:
            free.put(share)

    begin, spent = time.perf_counter(), _processor_time()
    with ThreadPoolExecutor(len(shares)) as workers:
        list(workers.map(bake, [work / path.name for path in made]))
    seconds, spent = time.perf_counter() - begin, _processor_time() - spent
    found = digest(sorted(work.iterdir()))
    print(f"  {name}: {seconds:.1f} s, {spent:.1f} s of processors, bytes of the bakes {found}")
    shutil.rmtree(work)
    return seconds


def _processor_time() -> float:
    """Seconds of all processes that have ended: other work on the machine hardly changes them."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _bake(path: Path, share: list[int], blender: list[str], home: Path) -> None:
    subprocess.run(
        [*blender, "-b", str(path), "--command", "dapple", "bake", "--quiet"],
        env={"BLENDER_USER_RESOURCES": str(home), **os.environ},
        preexec_fn=lambda: os.sched_setaffinity(0, share),
        stdout=subprocess.DEVNULL,
        check=True,
    )


main()
sys.stdout.flush()
os._exit(0)  # Blender hangs at exit when a class is still registered
