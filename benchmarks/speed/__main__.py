# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast: evaluations and whole runs, on one processor and on two, in one Markdown table.

With --against the same is measured of another build of the package in the same run, turn by turn,
and the ratio is given: times of a shared machine say nothing by themselves. Run through
benchmarks/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any

import dapple3d as dapple

from benchmarks.compare.cases import ROOT
from benchmarks.compare.tables import say, table
from benchmarks.speed import evaluations
from benchmarks.speed.cases import Mesh, cases

FAST = 100_000  # samples: runs of fewer are repeated
REPEATED = 3
LIMIT = 1800  # seconds a run
HEAD = [
    *("case", "samples", "processors", "build", "wall", "processor time", "peak memory"),
    *("alpha min", "alpha mean", "capacity variation", "psi6", "evaluations", "ratio"),
]
Found = dict[str, Any]


def measured(name: str, threads: int, seed: int, given: argparse.Namespace, build: Path) -> Found:
    """One process; `build` is the folder that holds its package."""
    runs = REPEATED if int(name.split("/")[1]) < FAST else 1
    command = [sys.executable, "-m", "benchmarks.speed.worker", name, str(threads), str(runs)]
    command += [str(seed), str(given.mesh or "")]
    say(f"{name}, {threads} processors, seed {seed}, {build}")
    done = subprocess.run(
        command,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(build), str(ROOT)])},
        stdout=subprocess.PIPE,
        text=True,
        timeout=LIMIT,
        check=True,
    )
    return dict(json.loads(done.stdout.splitlines()[-1]))


def over_seeds(runs: list[Found]) -> Found:
    """The median of each figure."""
    found = {key: median(run[key] for run in runs) for key in runs[0] if key != "figures"}
    figures = [run["figures"] for run in runs]
    return found | {"figures": {key: median(f[key] for f in figures) for key in figures[0]}}


def row(name: str, threads: int, build: str, found: Found, ratio: float | None) -> list[str]:
    case, count = name.split("/")
    figures = found["figures"]
    shown = [
        f"{figures[key]:.{digits}f}" if figures else ""
        for key, digits in (
            ("alpha_min", 3),
            ("alpha_mean", 4),
            ("capacity_variation", 4),
            ("bond_order", 3),
            ("evaluations", 0),
        )
    ]
    return [
        *(case, f"{int(count):,}", str(threads), build),
        *(f"{1e3 * found[key]:.1f} ms" for key in ("seconds", "processor_seconds")),
        f"{found['peak_bytes'] / 2**20:.0f} MiB" if "peak_bytes" in found else "",
        *shown,
        f"{ratio:.2f}" if ratio is not None else "",
    ]


def main() -> None:
    given = arguments()
    builds = {"this": Path(dapple.__file__).parents[1]}
    if given.against:
        builds = {"before": given.against.resolve()} | builds
    known = list(cases(Mesh(given.mesh)))
    if unknown := set(given.only or ()) - set(known):
        sys.exit(
            f"{min(unknown)} is no case: {', '.join(known)}; evaluations are run without --only"
        )
    names = given.only or [name for name in known if count_of(name) <= given.most]
    results = Results(given.json)
    if not given.only:
        evaluated(results, given)
    for name in names:
        for processors in given.processors:
            found: dict[str, list[Found]] = {build: [] for build in builds}
            for seed in range(given.seeds):
                for build, folder in builds.items():
                    found[build].append(measured(name, processors, seed, given, folder))
            results.add(name, processors, {build: over_seeds(f) for build, f in found.items()})
    print(table(HEAD, results.rows))


class Results:
    """Rows of the table, and the same as records in a file."""

    def __init__(self, file: Path | None) -> None:
        self.rows: list[list[str]] = []
        self._records: list[Found] = []
        self._file = file

    def add(self, name: str, processors: int, builds: dict[str, Found]) -> None:
        for build, found in builds.items():
            before = builds.get("before", found)["seconds"]
            ratio = found["seconds"] / before if build == "this" and "before" in builds else None
            self.rows.append(row(name, processors, build, found, ratio))
            self._records.append({"case": name, "processors": processors, "build": build, **found})
        if self._file:
            self._file.write_text(json.dumps(self._records, indent=1) + "\n")


def evaluated(results: Results, given: argparse.Namespace) -> None:
    """Evaluations by the C++ benchmarks, where they are built."""
    binaries = {"this": evaluations.BINARY}
    if given.against_benchmarks:
        binaries = {"before": given.against_benchmarks} | binaries
    if not evaluations.BINARY.exists():
        say(f"{evaluations.BINARY} is not built: no single evaluations")
        return
    for processors in given.processors:
        say(f"evaluations, {processors} processors")
        found = {build: evaluations.measured(file, processors) for build, file in binaries.items()}
        for name in found["this"]:
            results.add(name, processors, {build: found[build][name] for build in binaries})


def count_of(name: str) -> int:
    return int(name.split("/")[1])


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/run.sh", description=__doc__)
    parser.add_argument("--only", nargs="+", metavar="CASE", help="cases such as sample/2000")
    parser.add_argument("--most", type=int, default=100_000, help="samples; 1000000 for all cases")
    parser.add_argument("--seeds", type=int, default=1, help="runs whose median is shown")
    parser.add_argument("--processors", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--mesh", type=Path, help="a mesh file instead of a torus with waves")
    parser.add_argument(
        "--against", type=Path, metavar="FOLDER", help="that holds the package of another build"
    )
    parser.add_argument(
        "--against-benchmarks", type=Path, metavar="FILE", help="its program dapple_benchmarks"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same figures as JSON")
    return parser.parse_args()


if __name__ == "__main__":
    main()
