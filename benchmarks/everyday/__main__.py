# SPDX-License-Identifier: GPL-3.0-or-later
"""Does everyday jobs in Blender, prints a Markdown table, exits with 1 if a promise is broken.

Run through benchmarks/everyday/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

import addon
from benchmarks.compare.tables import say, table
from benchmarks.everyday import scenes
from benchmarks.everyday.bakes import BAKES
from benchmarks.everyday.judged import Found, Job
from benchmarks.everyday.stills import STILLS

JOBS = (*STILLS, *BAKES)
HEAD = ("job", "seconds", "ratio", "variation", "alpha", "overlap", "inside", "between", "off")


def main() -> int:
    parser = argparse.ArgumentParser(prog="benchmarks/everyday/run.sh", description=__doc__)
    parser.add_argument("--only", default="", help="jobs whose names hold this text")
    given = parser.parse_args()
    chosen = [job for job in JOBS if given.only in job.name]
    rows, broken = done([*_beside(chosen), *chosen])
    print(table((*HEAD, "promises"), rows))
    print(f"\n{len(rows)} jobs, {broken} with a broken promise.")
    return 1 if broken else 0


def _beside(chosen: Sequence[Job]) -> list[Job]:
    """Those that others are measured beside and that are not chosen themselves."""
    names = {job.beside for job in chosen} - {job.name for job in chosen}
    return [job for job in JOBS if job.name in names]


def done(jobs: Sequence[Job]) -> tuple[list[list[str]], int]:
    """Rows of the table, and how many jobs have a broken promise."""
    seconds: dict[str, float] = {}
    rows, count = [], 0
    for job in jobs:
        say(job.name)
        scenes.empty()
        found = _run(job)
        seconds[job.name] = found.seconds
        ratio = found.seconds / seconds[job.beside] if job.beside in seconds else None
        broken = job.broken(found, ratio)
        count += bool(broken)
        rows.append(_row(job, found, ratio, broken))
    return rows, count


def _run(job: Job) -> Found:
    try:
        return job.run()
    except Exception as error:
        return Found(wrong=f"{type(error).__name__}: {error}".splitlines()[0])


def _row(job: Job, found: Found, ratio: float | None, broken: list[str]) -> list[str]:
    def text(value: float | None, form: str) -> str:
        return "-" if value is None else format(value, form)

    return [
        *(job.name, f"{found.seconds:.2f}", text(ratio, ".1f"), text(found.variation, ".3f")),
        *(text(found.alpha, ".2f"), text(found.overlap, ".3f"), text(found.inside, "d")),
        *(text(found.between, "d"), text(found.off, ".4f")),
        "; ".join(broken) or "kept",
    ]


if __name__ == "__main__":
    addon.register()
    code = main()
    sys.stdout.flush()
    os._exit(code)
