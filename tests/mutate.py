#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaks lines of the library one at a time, and counts how many of them the native tests notice.

build/venv/bin/python tests/mutate.py [--count 100] [--rooms voronoi optimize track] [--seed 0]
                                      [--anew]

A line is broken as a slip of the pen would: a sign, a comparison, a minimum for a maximum, a
statement left out. What does not compile is passed over and does not count, and a run that takes
too long is noticed. It works on a copy of the sources in build/mutants, which the first run builds
as a whole. The lines that nobody noticed are printed; exit status 1 if they are more than a tenth.

What came out is kept in build/mutants/outcomes.json as long as the library's sources stay as they
are: a run that was stopped goes on, and one after tests were added tries the lines again that had
been missed.
"""

from __future__ import annotations

import argparse
import filecmp
import hashlib
import json
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "build" / "mutants"
SOURCE, BUILD = FOLDER / "source", FOLDER / "build"
KEPT = FOLDER / "outcomes.json"
COPIED = ["CMakeLists.txt", "CMakePresets.json", "LICENSE", "cmake", "native", "tests"]
PROGRAMS = [  # those that notice most for their time come first
    "dapple_same_bytes_tests",
    "dapple_referee_tests",
    "dapple_allocations_tests",
    "dapple_tests",
    "dapple_cancel_tests",
    "dapple_out_of_memory_tests",
]
SKIPPED = "Consumer*:*RealMesh*"
PATIENCE = 5.0  # times what the tests take where nothing is broken
TO_NOTICE = 0.9

# What a slip makes of it. Operators have spaces around them, as clang-format leaves them;
# templates' brackets have none.
SLIPS = [
    (" + ", " - "),
    (" - ", " + "),
    (" * ", " / "),
    (" / ", " * "),
    (" += ", " -= "),
    (" -= ", " += "),
    (" < ", " >= "),
    (" > ", " <= "),
    (" <= ", " > "),
    (" >= ", " < "),
    (" == ", " != "),
    (" != ", " == "),
    (" && ", " || "),
    (" || ", " && "),
    ("std::min", "std::max"),
    ("std::max", "std::min"),
    ("true", "false"),
    ("false", "true"),
    ("(!", "("),
]
STATEMENT = re.compile(r"^\s+[\w.:\[\]()>*-]+(\s[-+*/]?=\s.*|\(.*\));$")
NO_CODE = re.compile(r"^\s*(//|#|namespace\b|using\b|template\b|static_assert\b|throw\b|\}|$)")


@dataclass(frozen=True)
class Mutant:
    """A line of a file, and what it is made."""

    path: Path
    number: int  # from 1 on
    line: str
    broken: str

    def __str__(self) -> str:
        place = f"{self.path.relative_to(ROOT)}:{self.number}"
        return f"{place}\n    {self.line.strip()}\n    {self.broken.strip() or '(left out)'}"


def breaks(line: str) -> Iterator[str]:
    """All ways to break a line."""
    if NO_CODE.match(line):
        return
    code = line.split("//")[0]
    for good, bad in SLIPS:
        at = code.find(good)
        while at >= 0:
            yield line[:at] + bad + line[at + len(good) :]
            at = code.find(good, at + len(good))
    if STATEMENT.match(line):
        yield ""


def mutants(rooms: list[str], seed: int) -> Iterator[Mutant]:
    """One of each line that can be broken, in an order that the seed decides."""
    lines = [
        (path, number, line)
        for room in rooms
        for path in sorted((ROOT / "native" / "src" / room).glob("*.?pp"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if any(breaks(line))
    ]
    chance = random.Random(seed)
    chance.shuffle(lines)
    for path, number, line in lines:
        yield Mutant(path, number, line, chance.choice(list(breaks(line))))


@dataclass
class Outcomes:
    """What came of the lines that were broken so far, kept in a file."""

    sources: str  # a sum over the library they are lines of
    of: dict[str, str] = field(default_factory=dict)

    def keep(self, mutant: Mutant, told: str) -> None:
        self.of[str(mutant)] = told
        KEPT.write_text(json.dumps({"sources": self.sources, "of": self.of}), encoding="utf-8")


def outcomes_so_far() -> Outcomes:
    """Those of earlier runs on the same sources."""
    total = hashlib.sha256()
    for path in sorted((ROOT / "native").rglob("*.?pp")):
        total.update(path.read_bytes())
    found = Outcomes(total.hexdigest())
    if KEPT.exists():
        kept = Outcomes(**json.loads(KEPT.read_text(encoding="utf-8")))
        found.of = kept.of if kept.sources == found.sources else {}
    return found


def copy(from_path: Path, to_path: Path) -> None:
    """Make a file or folder the same as another.

    Only what differs is written, and written now: a line that an earlier run broke may still be in
    the object file, which the time of the file it came from would call up to date.
    """
    if from_path.is_dir():
        to_path.mkdir(exist_ok=True)
        names = {path.name for path in from_path.iterdir()}
        for path in to_path.iterdir():
            if path.name not in names:
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        for name in names:
            copy(from_path / name, to_path / name)
    elif not to_path.exists() or not filecmp.cmp(from_path, to_path, shallow=False):
        shutil.copyfile(from_path, to_path)


def prepare() -> float:
    """A copy of the sources as they are, built, whose tests pass; seconds that they may take."""
    SOURCE.mkdir(parents=True, exist_ok=True)
    for name in COPIED:
        copy(ROOT / name, SOURCE / name)
    configure = ["cmake", "-S", str(SOURCE), "-B", str(BUILD), "-G", "Ninja"]
    configure += ["-DCMAKE_BUILD_TYPE=Release", "-DDAPPLE_TESTS=ON"]
    configure += ["-DDAPPLE_PYTHON=OFF", "-DDAPPLE_BENCHMARKS=OFF", "-DDAPPLE_WERROR=OFF"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    is_built, begun = built(), time.monotonic()
    if not is_built or noticed(None):
        sys.exit("error: the tests have to pass before anything is broken")
    return PATIENCE * (time.monotonic() - begun)


def built() -> bool:
    """Whether the programs compile."""
    command = ["cmake", "--build", str(BUILD), "--target", *PROGRAMS]
    return subprocess.run(command, capture_output=True).returncode == 0


def noticed(longest: float | None) -> bool:
    """Whether a test fails, or a program crashes or takes more than so many seconds."""
    for name in PROGRAMS:
        command = [f"{BUILD}/tests/native/{name}", "--gtest_brief=1", "--gtest_fail_fast"]
        command += [f"--gtest_filter=-{SKIPPED}"]
        try:
            done = subprocess.run(command, capture_output=True, timeout=longest)
        except subprocess.TimeoutExpired:
            return True
        if done.returncode:
            return True
    return False


def outcome_of(mutant: Mutant, longest: float) -> str:
    """Whether tests notice it: "noticed", "missed" or "does not compile"."""
    place = SOURCE / mutant.path.relative_to(ROOT)
    lines = place.read_text(encoding="utf-8").splitlines()
    lines[mutant.number - 1] = mutant.broken
    place.write_text("\n".join(lines) + "\n", encoding="utf-8")
    try:
        if not built():
            return "does not compile"
        return "noticed" if noticed(longest) else "missed"
    finally:
        place.write_text(mutant.path.read_text(encoding="utf-8"), encoding="utf-8")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=100, help="lines that are broken")
    parser.add_argument("--rooms", nargs="+", default=["voronoi", "optimize", "track"])
    parser.add_argument("--seed", type=int, default=0, help="another one takes other lines")
    parser.add_argument("--anew", action="store_true", help="forget what came out before")
    return parser.parse_args()


def main() -> int:
    given = arguments()
    if given.anew:
        KEPT.unlink(missing_ok=True)
    longest, outcomes = prepare(), outcomes_so_far()
    found: Counter[str] = Counter()
    for mutant in mutants(given.rooms, given.seed):
        told = outcomes.of.get(str(mutant), "missed")
        if told == "missed":
            told = outcome_of(mutant, longest)
            outcomes.keep(mutant, told)
        found[told] += 1
        if told == "missed":
            print(mutant, flush=True)
        done = found["noticed"] + found["missed"]
        print(f"\r{found['noticed']} of {done} noticed", end=" ", file=sys.stderr, flush=True)
        if done == given.count:
            break
    broken = found["does not compile"]
    print(f"\n{found['noticed']} of {done} lines noticed; {broken} did not compile")
    return 0 if found["noticed"] >= TO_NOTICE * done else 1


if __name__ == "__main__":
    sys.exit(main())
