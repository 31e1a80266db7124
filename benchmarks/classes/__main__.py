# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges many classes at once; prints a Markdown table, progress on stderr.

Each class and all samples together stand beside as many samples of the same density placed as one
class ("alone"), which is as even as a set gets that need not share its place with others, and
beside the paper's two stages. Run through benchmarks/classes/run.sh, which sets everything up
first.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from statistics import mean
from typing import Any

import dapple3d as dapple

from benchmarks.classes.cases import MAKERS, Case, Goals
from benchmarks.compare.cases import mesh_files, mesh_folder
from benchmarks.compare.tables import say, table

FIGURES = {"alpha_min": 3, "alpha_mean": 3, "capacity_variation": 4, "bond_order": 3}
HEAD = [
    *("case", "set", "n", "way", "alpha min", "alpha mean", "capacity variation", "psi6"),
    *("evaluations", "goals", "verdict"),
]


def reports(case: Case, way: str, seeds: int, threads: int) -> list[list[dapple.Quality]]:
    """The quality of each set, per seed; the last set is a whole report, of all together."""
    found: list[list[dapple.Quality]] = []
    for seed in range(seeds):
        say(f"{case.name}: {way}, seed {seed}")
        if way == "alone":
            options: dict[str, Any] = {"seed": seed, "threads": threads}
            found.append([case.by_itself(k, **options) for k in range(len(case.counts))])
            continue
        options = {"max_evaluations": case.max_evaluations}
        if way == "two stages":
            options = {**dapple.PAPER, "two_stages": True}
        report = case.together(seed, threads=threads, **options)
        found.append([*report.classes, report])
    return found


def goals_of(case: Case, way: str, k: int) -> Goals | None:
    if way != "joint" or case.goals is None:
        return None
    return case.goals[k == len(case.classes)]


def row(case: Case, way: str, k: int, runs: Sequence[dapple.Quality]) -> list[str]:
    means = {name: mean(getattr(run, name) for run in runs) for name in FIGURES}
    goals = goals_of(case, way, k)
    misses = goals.misses(means) if goals else []
    shown = [
        f"**{means[name]:.{digits}f}**" if name in misses else f"{means[name]:.{digits}f}"
        for name, digits in FIGURES.items()
    ]
    evaluations = [run.evaluations for run in runs if isinstance(run, dapple.Report)]
    return [
        *(case.name, set_name(case, k), f"{case.counts[k]:,}", way, *shown),
        f"{mean(evaluations):.0f}" if evaluations else "",
        str(goals) if goals else "",
        ("missed: " + ", ".join(misses) if misses else "met") if goals else "",
    ]


def set_name(case: Case, k: int) -> str:
    return "all" if k == len(case.classes) else f"class {k}"


def rows_of(
    case: Case, given: argparse.Namespace, records: list[dict[str, Any]]
) -> list[list[str]]:
    found = {way: reports(case, way, given.seeds, given.threads) for way in given.ways}
    for way, runs in found.items():
        for seed, sets in enumerate(runs):
            figures = [{name: getattr(one, name) for name in FIGURES} for one in sets]
            records.append({"case": case.name, "way": way, "seed": seed, "sets": figures})
    return [
        row(case, way, k, [run[k] for run in found[way]])
        for k in range(len(case.counts))
        for way in given.ways
    ]


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/classes/run.sh", description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=mesh_folder(), help="meshes")
    parser.add_argument("--only", nargs="+", choices=MAKERS, metavar="CASE", help=", ".join(MAKERS))
    ways = ["joint", "two stages", "alone"]
    parser.add_argument("--ways", nargs="+", choices=ways, default=ways)
    parser.add_argument("--seeds", type=int, default=5, help="how many, from 0 on")
    parser.add_argument("--threads", type=int, default=0, help="0: all processors")
    parser.add_argument("--json", type=Path, help="write every run to this file")
    given = parser.parse_args()
    given.only = given.only or list(MAKERS)
    if given.seeds < 1:
        parser.error(f"--seeds {given.seeds}: at least one is needed")
    if given.only != ["torus"] and "bunny" not in mesh_files(given.folder):
        parser.error(f"{given.folder} holds no bunny: name a folder, or take --only torus")
    return given


def main() -> None:
    given = arguments()
    records: list[dict[str, Any]] = []
    rows = [
        row for name in given.only for row in rows_of(MAKERS[name](given.folder), given, records)
    ]
    print(f"Means over {given.seeds} seeds; goals: alpha min, alpha mean, capacity variation.\n")
    print(table(HEAD, rows))
    if given.json:
        given.json.write_text(json.dumps(records, indent=1) + "\n")


if __name__ == "__main__":
    main()
