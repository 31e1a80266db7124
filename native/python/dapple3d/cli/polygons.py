# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles in files: PLY, OBJ, OFF, STL and npz, by the extension."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import IO, Any

import click
import numpy as np
from numpy.typing import NDArray

import dapple3d as dapple
from dapple3d.cli.files import listed
from dapple3d.writing import replacing, write_npz

MORE = 4  # numbers of a polygon in a PLY file beside the corners: their number, cell, class, side


def check_extension(path: Path) -> str:
    """The extension, in lower case, of a file that tiles can be written to.

    Raises:
        ClickException: naming those that there are.
    """
    suffix = path.suffix.lower()
    if suffix not in WRITERS:
        raise click.ClickException(
            f"{path}: unknown format '{suffix}'; tiles are written as {listed(WRITERS)}"
        )
    return suffix


def needs_convex(path: Path) -> bool:
    """Whether the file holds triangles only, so that polygons must not be merged."""
    return path.suffix.lower() == ".stl"


def write_tiles(path: Path, mosaic: dapple.Mosaic, ids: NDArray[np.int32]) -> None:
    """Write in the format of the extension; the file is complete or not written.

    Args:
        path: where to.
        mosaic: the tiles.
        ids: (n,) of the samples, which name the cells.

    Raises:
        ClickException: tiles cannot be written with this extension.
        OSError: naming the file.
    """
    write = WRITERS[check_extension(path)]
    with replacing(path) as file:
        write(file, mosaic, ids[mosaic.sites])


def _write_ply(file: IO[bytes], mosaic: dapple.Mosaic, cells: NDArray[np.int32]) -> None:
    header = [
        *("ply", "format binary_little_endian 1.0", f"element vertex {len(mosaic.vertices)}"),
        *("property double x", "property double y", "property double z"),
        *(f"element face {len(mosaic)}", "property list int int vertex_indices"),
        *("property int cell", "property int class", "property int side", "end_header"),
    ]
    file.write(("\n".join(header) + "\n").encode())
    file.write(mosaic.vertices.astype("<f8").tobytes())
    file.write(_ply_rows(mosaic, cells).astype("<i4").tobytes())


def _ply_rows(mosaic: dapple.Mosaic, cells: NDArray[np.int32]) -> NDArray[np.int32]:
    """Rows of a PLY file: the number of corners, the corners, cell, class and side."""
    counts = np.diff(mosaic.starts)
    ends = np.cumsum(counts + MORE)
    begins = ends - counts - MORE
    rows = np.empty(ends[-1] if len(ends) else 0, np.int32)
    rows[begins] = counts
    for back, values in enumerate((mosaic.sides, mosaic.classes, cells), 1):
        rows[ends - back] = values
    within = np.arange(len(mosaic.corners)) - np.repeat(mosaic.starts[:-1], counts)
    rows[np.repeat(begins + 1, counts) + within] = mosaic.corners
    return rows


def _write_obj(file: IO[bytes], mosaic: dapple.Mosaic, cells: NDArray[np.int32]) -> None:
    file.writelines(f"v {x!r} {y!r} {z!r}\n".encode() for x, y, z in mosaic.vertices.tolist())
    cell = kind = None
    for k, corners in enumerate(_polygons(mosaic)):
        if cells[k] != cell:
            cell = cells[k]
            file.write(f"g cell_{cell}\n".encode())
        if mosaic.classes[k] != kind:
            kind = mosaic.classes[k]
            file.write(f"usemtl class_{kind}\n".encode())
        file.write(f"f {' '.join(str(v + 1) for v in corners)}\n".encode())


def _write_off(file: IO[bytes], mosaic: dapple.Mosaic, _: NDArray[np.int32]) -> None:
    file.write(f"OFF\n{len(mosaic.vertices)} {len(mosaic)} 0\n".encode())
    file.writelines(f"{x!r} {y!r} {z!r}\n".encode() for x, y, z in mosaic.vertices.tolist())
    for corners in _polygons(mosaic):
        file.write(f"{len(corners)} {' '.join(map(str, corners))}\n".encode())


def _write_stl(file: IO[bytes], mosaic: dapple.Mosaic, _: NDArray[np.int32]) -> None:
    """Triangles, binary: single precision is all that STL has."""
    triangles = mosaic.vertices[_fans(mosaic)]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.zeros(len(triangles), [("normal", "<f4", 3), ("at", "<f4", (3, 3)), ("more", "<u2")])
    rows["normal"] = normals / np.where(lengths > 0, lengths, 1)
    rows["at"] = triangles
    file.write(b"\0" * 80 + np.uint32(len(rows)).astype("<u4").tobytes() + rows.tobytes())


def _write_npz(file: IO[bytes], mosaic: dapple.Mosaic, cells: NDArray[np.int32]) -> None:
    per_polygon: dict[str, Any] = {"cells": cells, "classes": mosaic.classes, "sides": mosaic.sides}
    per_tile = {name: getattr(mosaic, name) for name in ("cell_areas", "areas", "parts", "loops")}
    shape = {name: getattr(mosaic, name) for name in ("vertices", "corners", "starts")}
    write_npz(file, shape | per_polygon | per_tile)


def _polygons(mosaic: dapple.Mosaic) -> list[list[int]]:
    return [row.tolist() for row in np.split(mosaic.corners, mosaic.starts[1:-1])] if mosaic else []


def _fans(mosaic: dapple.Mosaic) -> NDArray[np.int32]:
    """(t, 3): triangles of convex polygons."""
    fans = ((row[0], a, b) for row in _polygons(mosaic) for a, b in pairwise(row[1:]))
    return np.array(list(fans), np.int32).reshape(-1, 3)


WRITERS: dict[str, Callable[[IO[bytes], dapple.Mosaic, NDArray[np.int32]], None]] = {
    ".ply": _write_ply,
    ".obj": _write_obj,
    ".off": _write_off,
    ".stl": _write_stl,
    ".npz": _write_npz,
}
