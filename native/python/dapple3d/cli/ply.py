# SPDX-License-Identifier: GPL-3.0-or-later
"""The vertices of PLY files, as columns; nothing is rounded.

Greg Turk, The PLY Polygon File Format, 1994.
"""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from dapple3d import _native as native
from dapple3d.cli.files import Arrays
from dapple3d.extras.distributed.streams import ORDERS as BINARY
from dapple3d.extras.distributed.streams import TYPES

WRITTEN = {"f": ("double", "<f8"), "i": ("int", "<i4"), "u": ("uchar", "u1")}
ORDERS = {**BINARY, "ascii": "="}
USUAL = (b"ply\n", b"ply\r\n")  # other files begin with a byte order mark or have other line ends


@dataclass
class _Element:
    name: str
    count: int
    fields: list[tuple[str, str]] = field(default_factory=list)  # name, numpy type
    has_list: bool = False


def write(file: IO[bytes], columns: Arrays) -> None:
    """Write columns of float64, int32 or uint8 as vertices, binary and little-endian."""
    kinds = {name: values.dtype.kind for name, values in columns.items()}
    dtype = [(name, WRITTEN[kind][1]) for name, kind in kinds.items()]
    count = len(next(iter(columns.values())))
    rows = np.empty(count, dtype)
    for name, values in columns.items():
        rows[name] = values
    properties = [f"property {WRITTEN[kind][0]} {name}" for name, kind in kinds.items()]
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}", *properties]
    file.write(("\n".join([*header, "end_header"]) + "\n").encode())
    file.write(rows.tobytes())


def read(path: Path) -> Arrays:
    """The properties of the vertices by name, each (n,) of its own type, or of float64.

    Raises:
        ValueError: the file is broken, or has no vertices.
        FileError: the same, naming the file.
    """
    with path.open("rb") as file:
        if file.readline(20) in USUAL:
            file.seek(0)
            order, elements = _read_header(file)
            if not any(element.has_list for element in elements[:-1]):
                return _read_vertices(file, order, elements)
    found: Arrays = {**native._read_vertex_columns(path)}
    return found


def _read_vertices(file: IO[bytes], order: str, elements: list[_Element]) -> Arrays:
    for element in elements:
        if element.has_list:
            raise ValueError(f"its element '{element.name}' has a list")
        rows = _read_rows(file, order, element)
        if element.name == "vertex":
            return {name: rows[name] for name, _ in element.fields}
    raise ValueError("has no element 'vertex'")


def _read_header(file: IO[bytes]) -> tuple[str, list[_Element]]:
    """The byte order, and the elements up to the vertices."""
    if file.readline().strip() != b"ply":
        raise ValueError("is not a PLY file: it does not begin with 'ply'")
    order, elements = "", list[_Element]()
    for number, line in enumerate(file, 2):
        try:
            match line.decode("ascii", "replace").split():
                case ["end_header"]:
                    break
                case ["format", name, _]:
                    order = ORDERS[name]
                case ["element", name, count]:
                    elements.append(_Element(name, _not_negative(count)))
                case ["property", "list", *_]:
                    elements[-1].has_list = True
                case ["property", kind, name]:
                    elements[-1].fields.append((name, TYPES[kind]))
        except (KeyError, IndexError, ValueError) as error:
            raise ValueError(f"line {number} of its header is wrong: {line!r}") from error
    else:
        raise ValueError("its header has no end")
    if not order:
        raise ValueError("its header has no format")
    last = [element.name == "vertex" for element in elements]
    return order, elements[: last.index(True) + 1] if any(last) else elements


def _not_negative(word: str) -> int:
    if not word.isdecimal():
        raise ValueError(f"{word} is no count")
    return int(word)


def _least_bytes(order: str, element: _Element) -> int:
    """The least length of a row: checked against the file before memory is allocated."""
    if order == ORDERS["ascii"]:
        return max(1, 2 * len(element.fields) - 1)  # digits and separators
    return max(1, np.dtype([(name, order + kind) for name, kind in element.fields]).itemsize)


def _read_rows(file: IO[bytes], order: str, element: _Element) -> NDArray:
    if element.count * _least_bytes(order, element) > os.fstat(file.fileno()).st_size:
        raise ValueError(f"is too short for {element.count} '{element.name}'")
    if order == ORDERS["ascii"]:
        return _read_text(file, element)
    dtype = np.dtype([(name, order + kind) for name, kind in element.fields])
    content = file.read(dtype.itemsize * element.count)
    found = len(content) // dtype.itemsize if dtype.itemsize else 0
    if found < element.count:
        raise ValueError(f"ends after {found} of {element.count} '{element.name}'")
    return np.frombuffer(content, dtype, element.count)


def _read_text(file: IO[bytes], element: _Element) -> NDArray:
    rows = np.empty(element.count, np.dtype(element.fields))
    for k in range(element.count):
        words = file.readline().split()
        try:
            rows[k] = tuple(float(word) for word in words)
        except (ValueError, IndexError, OverflowError) as error:
            raise ValueError(
                f"{element.name} {k} is not {len(element.fields)} numbers: {b' '.join(words)!r}"
            ) from error
    return rows
