# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare Dapple and other packages on the same meshes; write a Markdown table and a JSON file.

If a package is missing, crashes, takes too long or refuses a mesh, its line shows the reason. Run
through benchmarks/peers/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

import dapple3d as dapple
import numpy as np

from benchmarks.compare.cases import mesh_files, mesh_folder
from benchmarks.compare.tables import say, table
from benchmarks.peers.contenders import CONTENDERS, Task
from benchmarks.peers.meshes import MADE_UP, Mesh
from benchmarks.peers.processes import RefusedError, ask, one_line, worker
from benchmarks.tracking.implicit import Array

COUNTS, LARGE = [2000, 10_000], 100_000
REAL = "bunny"  # by default too where there is a folder of real meshes
FIGURES = ("alpha_min", "alpha_mean", "capacity_variation", "bond_order", "off_surface")
HEAD = ["mesh", "requested", "package", "placed", "s", "CPU s", "alpha min", "alpha mean"]
HEAD += ["variation", "psi6", "off"]
PROBE = 300.0  # seconds for a package to be imported
Record = dict[str, Any]


def judge(surface: dapple.Surface, points: Array) -> Record:
    """The figures of points, after they are moved to the nearest place of the surface."""
    places = dapple.project(surface, points)
    samples = dapple.Samples(surface, places.faces, places.barycentric)
    report = dapple.analyze(surface, samples)
    off = np.linalg.norm(samples.positions - points, axis=1).max() / report.spacing
    found = {name: getattr(report, name) for name in FIGURES if name != "off_surface"}
    return {"got": len(points), **found, "off_surface": float(off)}


def judged(surface: dapple.Surface, made: Record) -> Record:
    """A record for each run of an answer."""
    try:
        runs = [judge(surface, one) for one in np.split(made["points"], made["ends"][:-1])]
    except ValueError as error:
        raise RefusedError(one_line(f"points that cannot be judged: {error}")) from error
    for run, seconds, cpu in zip(runs, made["seconds"], made["cpu"], strict=True):
        run |= {"seconds": float(seconds), "cpu_seconds": float(cpu)}
    return {"runs": runs}


def compared(
    mesh: str, task: Task, names: list[str], given: argparse.Namespace
) -> Iterator[Record]:
    """A record for each contender on one mesh with one count."""
    surface = dapple.Surface(task.vertices, task.faces)
    for name in names:
        say(f"{mesh}, {task.wanted:,}: {CONTENDERS[name].title}")
        record: Record = {"mesh": mesh, "asked": task.wanted, "contender": name}
        try:
            made = ask(worker(name, given.peers_python), given.limit, task, given.runs)
            yield record | judged(surface, made)
        except RefusedError as reason:
            yield record | {"reason": str(reason)}


def row(record: Record) -> list[str]:
    """Medians over the runs; or the reason for a failure instead."""
    names = [record["mesh"], f"{record['asked']:,}", CONTENDERS[record["contender"]].title]
    if "reason" in record:
        return names + [record["reason"]] + [""] * (len(HEAD) - 4)

    def mid(name: str) -> float:
        return median(run[name] for run in record["runs"])

    return [
        *(*names, f"{mid('got'):,.0f}", f"{mid('seconds'):.2f}", f"{mid('cpu_seconds'):.2f}"),
        *(f"{mid('alpha_min'):.3f}", f"{mid('alpha_mean'):.3f}"),
        *(f"{mid('capacity_variation'):.4f}", f"{mid('bond_order'):.3f}"),
        f"{mid('off_surface'):.2f}",
    ]


def versions(names: list[str], given: argparse.Namespace) -> tuple[dict[str, str], dict[str, str]]:
    """The version of each contender that is there, and why the others are not."""
    there, missing = {}, {}
    for name in names:
        try:
            there[name] = str(ask(worker(name, given.peers_python), PROBE)["version"])
        except RefusedError as reason:
            missing[name] = str(reason)
            say(f"{CONTENDERS[name].title}: {reason}")
    return there, missing


def report(records: list[Record], there: dict[str, str], missing: dict[str, str]) -> str:
    """The tables of contenders and of what they made."""
    calls = [
        [CONTENDERS[name].title, there.get(name, missing.get(name, "")), CONTENDERS[name].call]
        for name in CONTENDERS
        if name in there or name in missing
    ]
    return (
        table(["package", "version, or why it is missing", "call"], calls)
        + "\n\n"
        + table(HEAD, map(row, records))
    )


def mesh_of(name: str, folder: Path) -> Mesh:
    return MADE_UP[name]() if name in MADE_UP else dapple.read_mesh(mesh_files(folder)[name])


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/peers/run.sh", description=__doc__)
    parser.add_argument("--meshes", nargs="+", metavar="NAME", help="figure, box or of the folder")
    parser.add_argument("--folder", type=Path, default=mesh_folder(), help="of real meshes")
    parser.add_argument("--counts", type=int, nargs="+", default=COUNTS, help="points to place")
    parser.add_argument("--large", action="store_true", help=f"also {LARGE:,} points")
    parser.add_argument("--only", nargs="+", choices=list(CONTENDERS), default=list(CONTENDERS))
    parser.add_argument("--runs", type=int, default=3, help="of each, with seeds from 0 on")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for the runs of one")
    parser.add_argument("--out", type=Path, default=Path("build/peers"), help="of table and JSON")
    parser.add_argument("--peers-python", default=sys.executable, help="that has the packages")
    given = parser.parse_args()
    if min(*given.counts, given.runs, given.limit) < 1:
        parser.error("--counts, --runs and --limit must be at least 1")
    known = [*MADE_UP, *mesh_files(given.folder)]
    given.meshes = given.meshes or [name for name in (*MADE_UP, REAL) if name in known]
    for name in given.meshes:
        if name not in known:
            parser.error(f"--meshes {name}: there are {', '.join(known)}")
    given.counts = [*given.counts, *([LARGE] if given.large else [])]
    return given


def main() -> None:
    given = arguments()
    given.out.mkdir(parents=True, exist_ok=True)
    there, missing = versions(given.only, given)
    machine = f"{os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f} at the start"
    records: list[Record] = []
    for mesh in given.meshes:
        vertices, faces = mesh_of(mesh, given.folder)
        for count in given.counts:
            for record in compared(mesh, Task(vertices, faces, count), list(there), given):
                records.append(record)
                stored = {"machine": machine, "versions": there, "missing": missing}
                text = json.dumps(stored | {"records": records}, indent=1)
                (given.out / "peers.json").write_text(text + "\n")
    text = f"{machine}\n\n{report(records, there, missing)}\n"
    (given.out / "peers.md").write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
