# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures surfaces that are solved tile by tile; prints Markdown tables, progress on stderr.

seams: points beside seams next to those of one solution. speed: seconds and memory of many
points, and what they say of more. dask: what processes of Dask cost over one process, with one
thread each.
"""

from __future__ import annotations

import argparse
from statistics import median

from benchmarks.compare.tables import table
from benchmarks.tiles import seams, speed

CASES = ("seams", "speed", "dask")
BESIDE_COUNT = 20_000  # points where seams are measured


def show_seams(given: argparse.Namespace) -> None:
    """How even points are."""
    print(f"\nMedians over {given.seeds} seeds, least and most:\n")
    found = [seams.compare(tiles, BESIDE_COUNT, given.seeds) for tiles in (2, 3)]
    print(table(seams.HEAD, [row for one in found for row in one.rows()]))
    print("\nMeans of tiles over those of one solution, with their standard error:\n")
    print(table(seams.RATIO_HEAD, [row for one in found for row in one.ratios()]))


def show_speed(given: argparse.Namespace) -> None:
    """How long, and how much memory."""
    found = speed.run(given.count, given.tile, given.workers)
    print(f"\n{table(speed.HEAD, [found.row()])}")
    for count, machines in ((100_000_000, 1), (1_000_000_000, 100)):
        print(f"\n{speed.estimate(found, count, machines, given.workers)}")


def show_dask(given: argparse.Namespace) -> None:
    """What Dask costs."""
    ratios = []
    for _ in range(given.rounds):
        here = speed.run(given.dask_count, given.tile, None, "--threads", "1")
        there = speed.run(given.dask_count, given.tile, 1)
        ratios.append(there.seconds / here.seconds)
        print(f"\n{table(speed.HEAD, [here.row(), there.row()])}")
    print(f"\nDask: {100 * (median(ratios) - 1):+.1f} % of the time of one process, median")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/tiles/run.sh", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--seeds", type=int, default=5, help="seams: how many, at least 2")
    parser.add_argument("--count", type=int, default=10_000_000, help="speed: points")
    parser.add_argument("--tile", type=int, default=100_000, help="points of a tile")
    parser.add_argument("--workers", type=int, default=2, help="speed: processes")
    parser.add_argument("--dask-count", type=int, default=1_000_000, help="dask: points")
    parser.add_argument("--rounds", type=int, default=3, help="dask: how often")
    return parser.parse_args()


def main() -> None:
    given = arguments()
    shows = {"seams": show_seams, "speed": show_speed, "dask": show_dask}
    for name in given.only:
        shows[name](given)


if __name__ == "__main__":
    main()
