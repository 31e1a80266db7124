# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes in files, read in chunks: vertices, then faces, never all of them at once."""

import os
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from ... import _meshes as meshes
from ...reading import check_archive, entry_header, npy_header
from .patches import check_real

ROWS = 1 << 19  # of a chunk
# PLY's names of types, old and new, as numpy has them.
TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"long": "i8", "ulong": "u8", "int64": "i8", "uint64": "u8"},
    **{"float": "f4", "float32": "f4", "double": "f8", "float64": "f8"},
}
INDICES = ("vertex_indices", "vertex_index")
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
Chunks = Iterator[NDArray]


@dataclass(frozen=True)
class Column:
    """Rows of numbers: how many there are, and how to read them from the start.

    chunks: gives arrays of `width` numbers a row, or of one number where that is 0.
    """

    rows: int
    chunks: Callable[[], Chunks]


@dataclass(frozen=True)
class Stream:
    """A mesh: vertices (v, 3), faces (m, 3), and a density of as many as one of them."""

    vertices: Column
    faces: Column
    density: Column | None = None


def open_stream(path: Path) -> Stream:
    """A mesh in a file: npz and binary PLY of triangles are read in chunks, others at once.

    Raises:
        those of dapple3d.reading.BROKEN, saying what is wrong with it, also as it is read on.
        OSError: naming the file.
    """
    if path.suffix.lower() == ".npz":
        return _open_npz(path)
    if path.suffix.lower() == ".ply":
        found = _open_ply(path)
        if found:
            return found
    mesh = meshes.read_mesh(path)
    density = mesh.vertex_attributes.get("density", mesh.face_attributes.get("density"))
    return Stream(
        _column(mesh.vertices), _column(mesh.faces), None if density is None else _column(density)
    )


def _column(values: NDArray) -> Column:
    return Column(len(values), lambda: iter([values]))


def _open_npz(path: Path) -> Stream:
    with zipfile.ZipFile(path) as archive:
        check_archive(archive)
        names = {name.removesuffix(".npy") for name in archive.namelist()}
    for name in ("vertices", "faces"):
        if name not in names:
            raise ValueError(f"has no array '{name}', only {', '.join(sorted(names))}")
    vertices, faces = (_npz_column(path, name, 2) for name in ("vertices", "faces"))
    density = _npz_column(path, "density", 1) if "density" in names else None
    return Stream(vertices, faces, density)


def _npz_column(path: Path, name: str, dimensions: int) -> Column:
    with zipfile.ZipFile(path) as archive:
        shape, fortran, kind = entry_header(archive, f"{name}.npy")
    check_real(f"'{name}'", kind)
    wanted = (shape[0], 3)[:dimensions] if shape else None
    if shape != wanted or fortran:
        raise ValueError(
            f"'{name}' has the shape {shape}{' in Fortran order' if fortran else ''}: "
            f"{'(n, 3)' if dimensions == 2 else '(n,)'} in C order is needed"
        )
    return Column(shape[0], lambda: _npz_chunks(path, name))


def _npz_chunks(path: Path, name: str) -> Chunks:
    with zipfile.ZipFile(path) as archive, archive.open(f"{name}.npy") as file:
        shape, _, dtype = npy_header(file)
        yield from _chunks(file, dtype, shape[0], shape[1:])


def _chunks(file: IO[bytes], dtype: np.dtype, rows: int, shape: tuple[int, ...] = ()) -> Chunks:
    width = int(np.prod(shape, dtype=np.int64)) * dtype.itemsize
    for start in range(0, rows, ROWS):
        wanted = min(ROWS, rows - start)
        content = file.read(wanted * width)
        if len(content) < wanted * width:
            raise ValueError(f"ends after {start + len(content) // width} of {rows} rows")
        yield np.frombuffer(content, dtype).reshape(wanted, *shape)


@dataclass
class _Element:
    name: str
    rows: int
    fields: list[tuple[str, str]] = field(default_factory=list)  # names and types
    indices: str = ""  # the name of a list, of three


def _open_ply(path: Path) -> Stream | None:
    """None of one in text, or with other faces than triangles."""
    with path.open("rb") as file:
        header = _ply_header(file)
        start = file.tell()
    if header is None:
        return None
    order, elements = header
    found: dict[str, tuple[_Element, np.dtype, int]] = {}
    for element in elements:
        dtype = _row_type(element, order)
        found[element.name] = element, dtype, start
        start += dtype.itemsize * element.rows
    if "vertex" not in found or "face" not in found:
        return None
    if start > os.path.getsize(path) or not _of_triangles(path, found["face"]):
        return None
    return _ply_stream(path, found)


def _of_triangles(path: Path, face: tuple[_Element, np.dtype, int]) -> bool:
    name = face[0].indices
    return name in INDICES and all(
        (rows[name]["count"] == 3).all() for rows in _ply_chunks(path, *face)
    )


def _ply_stream(path: Path, found: dict[str, tuple[_Element, np.dtype, int]]) -> Stream:
    vertex, face = found["vertex"][0], found["face"][0]
    names = [name for name, _ in vertex.fields]

    def places() -> Chunks:
        for rows in _ply_chunks(path, *found["vertex"]):
            yield np.stack([rows[name] for name in "xyz"], axis=1)

    def corners() -> Chunks:
        for rows in _ply_chunks(path, *found["face"]):
            yield rows[face.indices]["corners"]

    def densities(owner: str) -> Chunks:
        return (rows["density"] for rows in _ply_chunks(path, *found[owner]))

    density = None
    if "density" in names:
        density = Column(vertex.rows, partial(densities, "vertex"))
    elif "density" in [name for name, _ in face.fields]:
        density = Column(face.rows, partial(densities, "face"))
    return Stream(Column(vertex.rows, places), Column(face.rows, corners), density)


def _ply_chunks(path: Path, element: _Element, dtype: np.dtype, start: int) -> Chunks:
    with path.open("rb") as file:
        file.seek(start)
        yield from _chunks(file, dtype, element.rows)


def _row_type(element: _Element, order: str) -> np.dtype:
    typed: list[tuple[str, object]] = []
    for name, kind in element.fields:
        if name != element.indices:
            typed.append((name, order + kind))
            continue
        count, index = kind.split()
        typed.append((name, [("count", order + count), ("corners", order + index, 3)]))
    return np.dtype(typed)


def _ply_header(file: IO[bytes]) -> tuple[str, list[_Element]] | None:
    """The byte order, and the elements; None if it is no binary file with one list at most."""
    order, elements = "", list[_Element]()
    if file.readline(20).strip() != b"ply":  # other line ends are not supported
        return None
    for number, line in enumerate(file, 2):
        words = line.decode("ascii", "replace").split()
        try:
            match words:
                case ["end_header"]:
                    return (order, elements) if order else None
                case ["format", name, _]:
                    order = ORDERS.get(name, "")
                case ["property", "list", *_] if elements[-1].indices:
                    return None
                case _:
                    _add_to_header(elements, words)
        except (LookupError, ValueError) as error:
            raise ValueError(f"line {number} of its header is wrong: {line!r}") from error
    return None


def _add_to_header(elements: list[_Element], words: list[str]) -> None:
    match words:
        case ["element", name, rows]:
            if not rows.isdecimal():
                raise ValueError(f"{rows} is no count")
            elements.append(_Element(name, int(rows)))
        case ["property", "list", count, index, name]:
            elements[-1].indices = name
            elements[-1].fields.append((name, f"{TYPES[count]} {TYPES[index]}"))
        case ["property", kind, name]:
            elements[-1].fields.append((name, TYPES[kind]))
