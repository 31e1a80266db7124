# SPDX-License-Identifier: GPL-3.0-or-later
"""The same for a long time: does it keep its memory, its speed, and what it has open?"""

import argparse
import importlib
import os
import subprocess
import sys
from collections.abc import Iterator

from soak.meter import HEAD, soaked

from benchmarks.compare.tables import table

CASES = ("tracking", "updates", "playback")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="tests/soak.sh", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--minutes", type=float, default=60.0, help="of tracking, and of updates")
    parser.add_argument("--frames", type=int, default=5000, help="of playback")
    return parser.parse_args()


def steps(name: str, given: argparse.Namespace) -> Iterator[None]:
    """Of a case; only those of Blender need Blender."""
    if name == "tracking":
        from soak import tracking

        return tracking.steps(60.0 * given.minutes)
    importlib.import_module("bpy")  # which brings the modules of Blender
    from soak import blender

    return (
        blender.rounds(60.0 * given.minutes) if name == "updates" else blender.frames(given.frames)
    )


def each_by_itself(given: argparse.Namespace) -> int:
    """A process for each case: what one leaves in memory is none of the next."""
    numbers = ["--minutes", str(given.minutes), "--frames", str(given.frames)]
    words = [sys.executable, "-m", "soak", *numbers, "--only"]
    failed = False
    for name in given.only:
        done = subprocess.run([*words, name], stdout=subprocess.PIPE, text=True)
        lines = done.stdout.splitlines()
        print(*lines[0 if name == given.only[0] else 2 :], sep="\n", flush=True)
        failed |= done.returncode != 0
    return int(failed)


def main() -> int:
    given = arguments()
    if len(given.only) > 1:
        return each_by_itself(given)
    (name,) = given.only
    with os.fdopen(os.dup(1), "w") as shown:
        os.dup2(2, 1)  # Blender tells of each render and file
        found = soaked(name, steps(name, given))
        print(table(HEAD, [found.row()]), file=shown)
    wrong = ["memory grows"] * (not found.keeps_memory())
    wrong += ["something is left behind"] * (not found.keeps_handles())
    for one in wrong:
        print(f"error: {name}: {one}", file=sys.stderr, flush=True)
    return bool(wrong)


if __name__ == "__main__":
    code = int(main())
    sys.stdout.flush()
    os._exit(code)  # Blender hangs at exit when a class is still registered
