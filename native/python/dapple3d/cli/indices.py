# SPDX-License-Identifier: GPL-3.0-or-later
"""Options that select points or faces: numbers and ranges, or a .npy file."""

import re
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from dapple3d.cli.files import about, load_npy

METAVAR = "NUMBERS|FILE.npy"
HELP = "Numbers and ranges from 0, as 0-99,120; or a .npy file of them, or of true and false."
_RANGE = re.compile(r"\s*(\d{1,9})\s*(?:-\s*(\d{1,9})\s*)?")


class IndicesType(click.ParamType):
    """Numbers from 0, or the path of a .npy file."""

    name = "indices"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> NDArray[np.int64] | Path:
        """The numbers, in the order given; a file is read later."""
        if value.lower().endswith(".npy"):
            return Path(value)
        found: list[NDArray[np.int64]] = []
        for part in value.split(","):
            numbers = _RANGE.fullmatch(part)
            if numbers is None:
                self.fail(f"'{part.strip()}': a number or a range such as 0-99", param, ctx)
            first = int(numbers[1])
            last = int(numbers[2] or first)
            if last < first:
                self.fail(f"'{part.strip()}' ends before it begins", param, ctx)
            found.append(np.arange(first, last + 1))
        return np.concatenate(found)


def file_of(given: NDArray[np.int64] | Path | None) -> Path | None:
    """The file that an option names, if it names one."""
    return given if isinstance(given, Path) else None


def indices(
    option: str, given: NDArray[np.int64] | Path | None, count: int, things: str
) -> NDArray[np.int32] | None:
    """The selected indices, of count things.

    Raises:
        ClickException: naming the option or its file, and the first that there is not.
    """
    if given is None:
        return None
    source = str(given) if isinstance(given, Path) else option
    values = load_npy(given) if isinstance(given, Path) else given
    with about(Path(source)):
        return _checked(values, count, things)


def _checked(values: NDArray, count: int, things: str) -> NDArray[np.int32]:
    if values.dtype == bool:
        if values.shape != (count,):
            raise ValueError(f"has the shape {values.shape}: one for each of {count} {things}")
        return np.flatnonzero(values).astype(np.int32)
    if values.ndim != 1 or values.dtype.kind not in "iu":
        raise ValueError(f"is {values.dtype.name} {values.shape}: whole numbers (k,) are needed")
    wrong = np.flatnonzero((values < 0) | (values >= count))
    if len(wrong):
        k = wrong[0]
        raise ValueError(f"entry {k} is {values[k]}: there are {count} {things}, from 0")
    return np.unique(values).astype(np.int32)
