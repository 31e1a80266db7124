# SPDX-License-Identifier: GPL-3.0-or-later
"""Points as text: CSV, OBJ, OFF. Numbers have the digits that give the same bits back."""

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from dapple3d.cli.files import Arrays

WORDS = "object"  # a column that is no number, and is left out
PLACE, NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")


def write_csv(file: IO[bytes], columns: Arrays) -> None:
    """Write a line with the names, then one line for each point."""
    file.write((",".join(columns) + "\n").encode())
    _write_lines(file, (",".join(row) for row in _rows(columns, columns)))


def write_obj(file: IO[bytes], columns: Arrays) -> None:
    """Write v, vn and p lines; OBJ has no room for ids and classes."""
    places = list(_rows(columns, PLACE))
    _write_lines(file, (f"v {' '.join(row)}" for row in places))
    if "nx" in columns:
        _write_lines(file, (f"vn {' '.join(row)}" for row in _rows(columns, NORMAL)))
    _write_lines(file, (f"p {k}" for k in range(1, len(places) + 1)))


def write_off(file: IO[bytes], columns: Arrays) -> None:
    """Write OFF, or NOFF with normals; it has no room for ids and classes."""
    names = [*PLACE, *(NORMAL if "nx" in columns else ())]
    file.write(f"{'NOFF' if 'nx' in columns else 'OFF'}\n{len(columns['x'])} 0 0\n".encode())
    _write_lines(file, (" ".join(row) for row in _rows(columns, names)))


def read_csv(path: Path) -> Arrays:
    """Columns of float64 by the names in the first line; without names two or three: x, y, z.

    Raises:
        ValueError: naming the first line with another number of columns or a word for a number.
    """
    with path.open(newline="", encoding="utf-8-sig") as file:
        lines = _csv_rows(file)
    if not lines:
        raise ValueError("is empty")
    first = [name.strip() for name in lines[0][1]]
    if all(_is_number(word) for word in first):
        if len(first) not in (2, 3):
            raise ValueError(
                f"has {len(first)} columns and no names: 2 (x, y) or 3 (x, y, z) are needed"
            )
        return _table(lines, PLACE[: len(first)])
    if len(set(first)) < len(first):
        raise ValueError(f"names a column twice: {', '.join(first)}")
    if WORDS in first:
        at = first.index(WORDS)
        first = first[:at] + first[at + 1 :]
        lines = [(number, row[:at] + row[at + 1 :]) for number, row in lines]
    return _table(lines[1:], first)


def _csv_rows(file: IO[str]) -> list[tuple[int, list[str]]]:
    try:
        return [(number, row) for number, row in enumerate(csv.reader(file), 1) if row]
    except csv.Error as error:
        raise ValueError(f"is no CSV: {error}") from error


def read_obj(path: Path) -> Arrays:
    """The v and vn lines; what else there is, is left out.

    Raises:
        ValueError: naming the first line that is not three numbers.
    """
    places, normals = list[tuple[int, list[str]]](), list[tuple[int, list[str]]]()
    kinds = {"v": places, "vn": normals}
    with path.open(encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            kind, *words = line.split() or [""]
            if kind in kinds:
                kinds[kind].append((number, words[:3]))  # w and colors may follow
    columns = _table(places, PLACE)
    return columns | (_table(normals, NORMAL) if len(normals) == len(places) else {})


def read_off(path: Path) -> Arrays:
    """The vertices of OFF and NOFF in text.

    Raises:
        ValueError: it is not OFF, or naming the first line that is not as many numbers.
    """
    with path.open(encoding="utf-8") as file:
        stripped = ((number, line.split("#")[0].split()) for number, line in enumerate(file, 1))
        lines = [(number, words) for number, words in stripped if words]
    names = {"OFF": PLACE, "NOFF": PLACE + NORMAL}.get(lines[0][1][0] if lines else "")
    if names is None:
        raise ValueError("is no OFF file in text: it does not begin with OFF or NOFF")
    if len(lines) < 2 or not lines[1][1][0].isdecimal():
        raise ValueError("has no number of vertices in its second line")
    count, rows = int(lines[1][1][0]), lines[2:]
    if len(rows) < count:
        raise ValueError(f"ends after {len(rows)} of {count} vertices")
    return _table(rows[:count], names)


def _rows(columns: Arrays, names: Iterable[str]) -> Iterator[tuple[str, ...]]:
    return zip(*(map(repr, columns[name].tolist()) for name in names), strict=True)


def _write_lines(file: IO[bytes], lines: Iterable[str]) -> None:
    file.writelines(f"{line}\n".encode() for line in lines)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _table(lines: Sequence[tuple[int, list[str]]], names: Sequence[str]) -> Arrays:
    table: NDArray[np.float64] = np.empty((len(lines), len(names)))
    for k, (number, words) in enumerate(lines):
        if len(words) != len(names):
            raise ValueError(f"line {number} has {len(words)} columns: {len(names)} are needed")
        try:
            table[k] = [float(word) for word in words]
        except ValueError as error:
            wrong = next(word for word in words if not _is_number(word))
            raise ValueError(f"line {number} holds no number: {wrong!r}") from error
    return dict(zip(names, table.T, strict=True))
