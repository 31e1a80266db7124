# SPDX-License-Identifier: GPL-3.0-or-later
"""Points as text: CSV, OBJ, OFF. Numbers have the digits that give the same bits back."""

import codecs
import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from dapple3d.cli.files import Arrays

WORDS = "object"  # type of a column that is not numeric and is skipped
PLACE, NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")
COLOR, UV = ("red", "green", "blue"), ("u", "v")
SEPARATORS = (";", "\t", ",")  # of columns: the first of these in the first line
WIDE = {codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
OFF = re.compile(r"(ST)?(C)?(N)?OFF(?=\d|$)", re.IGNORECASE)


def write_csv(file: IO[bytes], columns: Arrays) -> None:
    """Write a line with the names, then one line for each point."""
    file.write((",".join(columns) + "\n").encode())
    _write_lines(file, (",".join(row) for row in _rows(columns, columns)))


def write_obj(file: IO[bytes], columns: Arrays) -> None:
    """Write v, vt, vn and p lines, v with a color; OBJ has no room for ids and classes."""
    names = [*PLACE, *(COLOR if "red" in columns else ())]
    places = list(_rows(columns, names))
    _write_lines(file, (f"v {' '.join(row)}" for row in places))
    if "u" in columns:
        _write_lines(file, (f"vt {' '.join(row)}" for row in _rows(columns, UV)))
    if "nx" in columns:
        _write_lines(file, (f"vn {' '.join(row)}" for row in _rows(columns, NORMAL)))
    _write_lines(file, (f"p {k}" for k in range(1, len(places) + 1)))


def write_off(file: IO[bytes], columns: Arrays) -> None:
    """Write OFF, with letters before it for what it has besides; no room for ids and classes."""
    names, head = [*PLACE], "OFF"
    if "nx" in columns:
        names, head = [*names, *NORMAL], "NOFF"
    if "red" in columns:
        names, head = [*names, *COLOR, "alpha"], f"C{head}"
    if "u" in columns:
        names, head = [*names, *UV], f"ST{head}"
    file.write(f"{head}\n{len(columns['x'])} 0 0\n".encode())
    _write_lines(file, (" ".join(row) for row in _rows(columns, names)))


def opened(path: Path) -> io.StringIO:
    """The text of a file in UTF-8 or UTF-16, with its line ends as they are.

    What is neither is replaced: names of things may be in any encoding.
    """
    content = path.read_bytes()
    coding = WIDE.get(content[:2])
    if coding is None and len(content) > 1 and 0 in content[:2]:
        coding = "utf-16-be" if content[0] == 0 else "utf-16-le"
    text = content.decode(coding or "utf-8", "replace").lstrip("\ufeff")
    return io.StringIO(text, newline="")


def _lines(path: Path) -> list[str]:
    """Lines without their ends, which may be LF, CR or both."""
    return re.split(r"\r\n|\r|\n", opened(path).getvalue())


def read_csv(path: Path) -> Arrays:
    """Columns of float64 by the names in the first line; without names two or three: x, y, z.

    Columns are separated by semicolons, tabs or commas, and a comma may stand in a number where it
    separates no columns and no number of the file has a point. Known names may be in capitals.

    Raises:
        ValueError: naming the first line with another number of columns or a word for a number.
    """
    lines = _csv_rows(opened(path).getvalue())
    if not lines:
        raise ValueError("is empty")
    first = [_column_name(name) for name in lines[0][1]]
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


def _column_name(word: str) -> str:
    """Names in lower case, if they are in capitals or begin with one."""
    name = word.strip().lstrip("/#").strip()
    small = name.lower()
    return small if name in (name.upper(), name.capitalize()) else name


def _csv_rows(text: str) -> list[tuple[int, list[str]]]:
    """Lines that are not empty with their numbers, commas in numbers as points."""
    head, skipped = text, 0
    if found := re.match(r"sep=(.)(\r\n|\r|\n)", text):  # written by spreadsheets
        separator, skipped = found[1], 1
        text = text[found.end() :]
    else:
        head = re.split(r"[\r\n]", text.lstrip("\r\n"), maxsplit=1)[0]
        separator = next((one for one in SEPARATORS if one in head), ",")
    try:
        read = csv.reader(io.StringIO(text, newline=""), delimiter=separator)
        rows = [(number, row) for number, row in enumerate(read, 1 + skipped) if row]
    except csv.Error as error:
        raise ValueError(f"is no CSV: {error}") from error
    width = len(rows[0][1]) if rows else 0
    if rows and width > 1 and not rows[0][1][-1].strip():  # each line ends with a separator
        rows = [(number, row[:-1] if not row[-1].strip() else row) for number, row in rows]
    return rows if separator == "," else _with_points(rows)


def _with_points(rows: list[tuple[int, list[str]]]) -> list[tuple[int, list[str]]]:
    """The text with decimal points for decimal commas, if no number of the file has a point."""
    numbers = [word for _, row in rows for word in row if re.fullmatch(r"[\s\d.,eE+-]+", word)]
    if any("." in word or word.count(",") > 1 for word in numbers):
        return rows
    return [
        (number, [w.replace(",", ".") if re.fullmatch(r"[\s\d,eE+-]+", w) else w for w in row])
        for number, row in rows
    ]


def read_obj(path: Path) -> Arrays:
    """The v, vt and vn lines; what else there is, is left out.

    Raises:
        ValueError: naming the first line that is not three numbers.
    """
    places, colors = list[tuple[int, list[str]]](), list[tuple[int, list[str]]]()
    normals, uv = list[tuple[int, list[str]]](), list[tuple[int, list[str]]]()
    kinds = {"v": places, "vn": normals, "vt": uv}
    for number, line in enumerate(_lines(path), 1):
        kind, *words = line.split() or [""]
        if kind in kinds:
            kinds[kind].append((number, words[: 2 if kind == "vt" else 3]))  # w may follow
        if kind == "v" and len(words) == 6:
            colors.append((number, words[3:]))
    columns = _table(places, PLACE)
    for rows, names in ((normals, NORMAL), (uv, UV), (colors, COLOR)):
        if rows and len(rows) == len(places):
            columns |= _table(rows, names)
    return columns


def read_off(path: Path) -> Arrays:
    """The vertices of OFF in text, with normals, colors and texture coordinates.

    Raises:
        ValueError: it is not OFF, or naming the first line that is not as many numbers.
    """
    stripped = ((number, line.split("#")[0].split()) for number, line in enumerate(_lines(path), 1))
    lines = [(number, words) for number, words in stripped if words]
    head = OFF.match(lines[0][1][0]) if lines else None
    if head is None:
        raise ValueError("is not an OFF text file: it does not begin with OFF or NOFF")
    names = [*PLACE, *(NORMAL if head[3] else ())]
    first = [word for word in (lines[0][1][0][head.end() :], *lines[0][1][1:]) if word]
    lines = [(lines[0][0], first), *lines[1:]] if first else lines[1:]
    if not lines or not lines[0][1][0].isdecimal():
        raise ValueError("has no number of vertices in its second line")
    count, rows = int(lines[0][1][0]), lines[1:]
    if len(rows) < count:
        raise ValueError(f"ends after {len(rows)} of {count} vertices")
    if head[2] and count:
        width = len(rows[0][1]) - len(names) - (2 if head[1] else 0)
        names += [*COLOR, "alpha"][:width] if width in (3, 4) else [*COLOR]
    return _table(rows[:count], [*names, *UV] if head[1] else names)


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
