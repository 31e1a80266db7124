# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares ways to optimize over real meshes; prints Markdown tables, progress on stderr.

Run through benchmarks/compare/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from statistics import median
from typing import Any

import dapple3d as dapple

from benchmarks.compare.cases import Case, cases, mesh_files, mesh_folder
from benchmarks.compare.components import component_rows
from benchmarks.compare.tables import say, table

Record = dict[str, Any]


class Runs:
    """Runs of sample(), each kept as a record of its case, options and report."""

    def __init__(self, threads: int) -> None:
        self.records: list[Record] = []
        self._threads = threads

    def sample(self, case: Case, seed: int, **options: Any) -> dapple.Report:
        return self.keep(case, seed, **options).report

    def keep(self, case: Case, seed: int, **options: Any) -> dapple.Samples:
        """The samples themselves."""
        samples = dapple.sample(
            case.surface, case.count, seed=seed, threads=self._threads, **options
        )
        self.records.append(
            {"mesh": case.mesh, "density_ratio": case.ratio, "seed": seed, "options": options}
            | samples.report.to_dict()
        )
        return samples


def energies_at(
    runs: Runs, case: Case, method: str, given: argparse.Namespace
) -> list[list[float]]:
    """The normalized energy without the repulsion: per number of evaluations, per seed."""
    return [
        [
            runs.sample(
                case,
                seed,
                method=method,
                cells=given.cells,
                repulsion_weight=0.0,
                tolerance=0.0,
                max_evaluations=evaluations,
            ).energy
            for seed in range(given.seeds)
        ]
        for evaluations in given.at
    ]


def compare_methods(given: argparse.Namespace, runs: Runs) -> str:
    """The trust region against plain L-BFGS from the same start after as many evaluations."""
    rows, above = [], 0
    for case in chosen_cases(given):
        say(f"{' '.join(case.names)}: {given.seeds} seeds, both methods")
        ours = energies_at(runs, case, "trust_region", given)
        plain = energies_at(runs, case, "line_search", given)
        differences = [
            [a - b for a, b in zip(*pair, strict=True)] for pair in zip(ours, plain, strict=True)
        ]
        above += sum(median(found) > 0.0 for found in differences)
        rows.append(
            [
                *case.names,
                *(f"{1e4 * median(found):.1f} ({1e4 * max(found):.1f})" for found in differences),
                f"{median(ours[-1]):.4f}",
            ]
        )
    head = [
        *("mesh", "density", "n"),
        *(f"{k} evaluations" for k in given.at),
        f"e at {given.at[-1]}",
    ]
    title = (
        "1e4 (e of the trust region - e of plain L-BFGS) from the same Poisson start: median over "
        f"{given.seeds} seeds (worst); negative is better."
    )
    return f"{title}\n\n{table(head, rows)}\n\nMedians above plain L-BFGS: {above}"


def setting_row(reports: list[dapple.Report]) -> list[str]:
    def both(values: list[float], digits: int, worst: float) -> str:
        return f"{median(values):.{digits}f} ({worst:.{digits}f})"

    evaluations = [float(report.evaluations) for report in reports]
    spreads = [report.capacity_variation for report in reports]
    orders = [report.bond_order for report in reports]
    alphas = [report.alpha_min for report in reports]
    return [
        both(evaluations, 0, max(evaluations)),
        both(spreads, 4, max(spreads)),
        both(orders, 3, max(orders)),
        both(alphas, 3, min(alphas)),
        f"{median(report.energy for report in reports):.4f}",
    ]


def compare_settings(given: argparse.Namespace, runs: Runs) -> str:
    """What each tolerance and repulsion weight of the default preset ends with."""
    rows = []
    for case in chosen_cases(given):
        for weight in given.repulsion_weights:
            for tolerance in given.tolerances:
                say(f"{' '.join(case.names)}: repulsion weight {weight:g}, tolerance {tolerance:g}")
                reports = [
                    runs.sample(case, seed, repulsion_weight=weight, tolerance=tolerance)
                    for seed in range(given.seeds)
                ]
                setting = [f"{weight:g}", f"{tolerance:g}"]
                rows.append([*case.names, *setting, *setting_row(reports)])
    head = [
        *("mesh", "density", "n", "repulsion weight", "tolerance"),
        *("evaluations", "capacity variation", "psi6", "alpha min", "e"),
    ]
    title = f"Median over {given.seeds} seeds (worst)."
    return f"{title}\n\n{table(head, rows)}"


def evaluations_to(
    report_of: Callable[[int], dapple.Report], energy: float, most: int
) -> int | None:
    """The fewest evaluations after which the energy is not above `energy`, by bisection.

    It falls with the evaluations, save for the little that the repulsion may cost.
    """
    low, high = 0, most + 1
    while high - low > 1:
        middle = (low + high) // 2
        if report_of(middle).energy <= energy:
            high = middle
        else:
            low = middle
    return high if high <= most else None


def compare_convergence(given: argparse.Namespace, runs: Runs) -> str:
    """How many evaluations it takes to an energy, and where the tolerance stops."""
    rows = []
    for case in chosen_cases(given):
        for weight in given.repulsion_weights:
            say(f"{' '.join(case.names)}: repulsion weight {weight:g}")
            ends, needed = [], []
            for seed in range(given.seeds):

                def report_of(evaluations: int, seed: int = seed) -> dapple.Report:
                    return runs.sample(
                        case,  # noqa: B023 (called within this round)
                        seed,
                        repulsion_weight=weight,  # noqa: B023
                        tolerance=given.tolerance,
                        max_evaluations=evaluations,
                    )

                ends.append(report_of(200))
                needed.append(evaluations_to(report_of, given.energy, ends[-1].evaluations))
            rows.append(
                [
                    *case.names,
                    f"{weight:g}",
                    " ".join("-" if k is None else str(k) for k in needed),
                    " ".join(str(end.evaluations) for end in ends),
                    " ".join(f"{end.energy:.4f}" for end in ends),
                ]
            )
    head = [
        *("mesh", "density", "n", "repulsion weight"),
        *(f"evaluations to e <= {given.energy}", f"at tolerance {given.tolerance:g}", "e there"),
    ]
    return f"Each of {given.seeds} seeds.\n\n{table(head, rows)}"


def compare_components(given: argparse.Namespace, runs: Runs) -> str:
    """Each connected component's capacity variation, and how much of it the counts alone make."""
    parts = []
    for case in chosen_cases(given):
        for seed in range(given.seeds):
            say(f"{' '.join(case.names)}: seed {seed}")
            samples = runs.keep(case, seed)
            title, head, rows = component_rows(case.surface, samples)
            parts.append(f"{', '.join(case.names)}, seed {seed}: {title}\n\n{table(head, rows)}")
    return "\n\n".join(parts)


def chosen_cases(given: argparse.Namespace) -> Iterable[Case]:
    files = mesh_files(given.folder)
    if given.only:
        files = {name: files[name] for name in given.only}
    return cases(files, given.densities, given.counts)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/compare/run.sh", description=__doc__)
    kinds = parser.add_subparsers(dest="kind", required=True)

    def add(name: str, verb: Any, counts: list[int], densities: list[float]) -> Any:
        kind = kinds.add_parser(name, help=verb.__doc__, description=verb.__doc__)
        kind.set_defaults(verb=verb)
        kind.add_argument("folder", type=Path, nargs="?", default=mesh_folder(), help="meshes")
        kind.add_argument("--only", nargs="+", metavar="MESH", help="these meshes of the folder")
        kind.add_argument("--counts", type=int, nargs="+", default=counts, help="samples to place")
        kind.add_argument(
            *("--densities", "--density"),
            type=float,
            nargs="+",
            default=densities,
            metavar="RATIO",
            help="1: uniform; else ratio^t for t from 0 to 1 along the longest axis",
        )
        kind.add_argument("--seeds", type=int, default=5, help="how many, from 0 on")
        kind.add_argument("--threads", type=int, default=1, help="0: all processors")
        kind.add_argument("--json", type=Path, help="write every run to this file")
        return kind

    kind = add("methods", compare_methods, [2000], [1.0, 100.0])
    kind.add_argument("--at", type=int, nargs="+", default=[5, 8, 10, 15, 20, 30])
    kind.add_argument("--cells", choices=["connected", "euclidean"], default="connected")
    kind = add("settings", compare_settings, [2000], [1.0])
    tolerances = [1e-5, 2e-5, 3e-5, 4e-5, 5e-5, 7e-5, 1e-4]
    kind.add_argument("--tolerances", type=float, nargs="+", default=tolerances)
    kind.add_argument("--repulsion-weights", type=float, nargs="+", default=[1.0])
    kind = add("converge", compare_convergence, [10_000], [1.0])
    kind.add_argument("--tolerance", type=float, default=1e-5)
    kind.add_argument("--energy", type=float, default=0.1650, help="normalized, to be reached")
    kind.add_argument("--repulsion-weights", type=float, nargs="+", default=[1.0])
    kind = add("components", compare_components, [2000], [1.0])
    kind.set_defaults(seeds=1)
    given = parser.parse_args()
    check(parser, given)
    return given


def check(parser: argparse.ArgumentParser, given: argparse.Namespace) -> None:
    if not given.folder.is_dir():
        parser.error(f"{given.folder} is no folder: name one that holds meshes, or set DAPPLE_DATA")
    known = mesh_files(given.folder)
    if not known:
        parser.error(f"{given.folder} holds no mesh")
    for name in given.only or []:
        if name not in known:
            parser.error(f"--only {name}: {given.folder} holds {', '.join(known)}")
    for name in ("counts", "densities", "at"):
        for value in getattr(given, name, []):
            if value < 1:
                parser.error(f"--{name} {value}: must be at least 1")
    if given.seeds < 1:
        parser.error(f"--seeds {given.seeds}: at least one is needed")


def main() -> None:
    given = arguments()
    runs = Runs(given.threads)
    print(given.verb(given, runs))
    if given.json:
        given.json.write_text(json.dumps(runs.records, indent=1) + "\n")


if __name__ == "__main__":
    main()
