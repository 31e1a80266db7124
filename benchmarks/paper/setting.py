# SPDX-License-Identifier: GPL-3.0-or-later
"""What every figure is made with, and the two ways that stand side by side."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, TypeVar

import dapple3d as dapple

T = TypeVar("T")

# The paper sets no limit; from white noise some runs without the capacity term take hundreds.
PRESET: dict[str, Any] = {**dapple.PAPER, "max_evaluations": 5000}
DEFAULT: dict[str, Any] = {"max_evaluations": 5000}
WAYS: dict[str, dict[str, Any]] = {"the paper's preset": PRESET, "our default": DEFAULT}

# The library always minimizes the CVT term too; from 1e3 on results hardly change any more.
CAPVT = 1e6
ENERGIES: dict[str, float] = {"CVT": 0.0, "CapVT": CAPVT, "CapCVT": 30.0}
PICTURE_ONLY = "picture only"


@dataclass(frozen=True)
class Setting:
    """Options of a run of the report."""

    out: Path  # folder of the pictures
    folder: Path  # of meshes; one without a bunny is fine
    quick: bool = False
    threads: int = 0

    def size(self, full: T, quick: T) -> T:
        """How many of something, in a full run and in a quick one."""
        return quick if self.quick else full

    @property
    def runs(self) -> int:
        """Over how many seeds means are taken: the paper's 10."""
        return self.size(10, 2)

    def each_seed(self, make: Callable[[int], T], seeds: int) -> list[T]:
        """make(seed) for so many seeds, side by side; each is to use one thread."""
        with ThreadPoolExecutor(self.threads or os.cpu_count()) as pool:
            return list(pool.map(make, range(seeds)))

    def picture(self, figure: int) -> Path:
        return self.out / f"figure-{figure:02d}.png"


class Reported(Protocol):
    @property
    def report(self) -> dapple.Report: ...


R = TypeVar("R", bound=Reported)


def fastest(make: Callable[[], R], times: int = 3) -> R:
    """The quickest of several equal runs: the one that other work disturbed least."""
    return min((make() for _ in range(times)), key=lambda one: one.report.seconds)


@dataclass(frozen=True)
class Row:
    """A figured quantity: every cell is text, and none is empty."""

    quantity: str
    paper: str
    preset: str
    default: str
    remark: str  # what differs, and why


def row(quantity: str, paper: str, ours: Sequence[str], remark: str) -> Row:
    """ours: in the order of WAYS."""
    preset, default = ours
    return Row(quantity, paper, preset, default, remark)


@dataclass(frozen=True)
class Plate:
    """One of the paper's figures, made again."""

    figure: int
    title: str
    picture: Path
    rows: list[Row] = field(default_factory=list)


Maker = Callable[[Setting], Plate]
