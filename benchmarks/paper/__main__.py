# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the paper's figures again: a picture of each, and one table beside its own numbers.

Pictures, report.md and report.json are written to --out; progress goes to stderr. Run through
benchmarks/paper/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from time import perf_counter

from benchmarks.compare.cases import mesh_folder
from benchmarks.compare.tables import say
from benchmarks.paper import (
    classes,
    motion,
    pictures,
    placement,
    plane,
    report,
    study,
    surfaces,
)
from benchmarks.paper.setting import Maker, Setting

# In the order of the table; a figure is a function that draws a picture and returns its rows.
FIGURES: dict[int, Maker] = {
    1: plane.figure_1,
    3: plane.figure_3,
    4: study.figure_4,
    5: plane.figure_5,
    6: surfaces.figure_6,
    7: surfaces.figure_7,
    8: surfaces.figure_8,
    10: classes.figure_10,
    11: classes.figure_11,
    12: classes.figure_12,
    13: classes.figure_13,
    14: pictures.figure_14,
    15: pictures.figure_15,
    16: placement.figure_16,
    17: motion.figure_17,
}


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/paper/run.sh", description=__doc__)
    without = "without a bunny there, a generated body takes its place"
    parser.add_argument("folder", type=Path, nargs="?", help=f"meshes; {without}")
    known = ", ".join(map(str, FIGURES))
    parser.add_argument(
        "--only", type=int, nargs="+", choices=FIGURES, metavar="FIGURE", help=f"of {known}"
    )
    parser.add_argument("--quick", action="store_true", help="few sites and seeds, a minute in all")
    parser.add_argument("--threads", type=int, default=0, help="0: all processors")
    parser.add_argument("--out", type=Path, default=Path("build/paper"), metavar="FOLDER")
    parser.add_argument("--page", type=Path, help="write the table without pictures there too")
    given = parser.parse_args()
    if given.folder and not given.folder.is_dir():
        parser.error(f"{given.folder} is no folder: name one that holds meshes, or none")
    given.folder = given.folder or mesh_folder()
    return given


def main() -> None:
    given = arguments()
    given.out.mkdir(parents=True, exist_ok=True)
    setting = Setting(given.out, given.folder, given.quick, given.threads)
    command = " ".join(["benchmarks/paper/run.sh", *sys.argv[1:]])
    plates = []
    for number in given.only or FIGURES:
        began = perf_counter()
        plates.append(FIGURES[number](setting))
        say(f"fig. {number}: done in {perf_counter() - began:.0f} s")
        report.write(plates, command, given.out)
    page = report.markdown(plates, command, pictures=False)
    if given.page:
        given.page.write_text(page)
    print(page, end="")


if __name__ == "__main__":
    main()
