# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of any size, whose faces are sorted once by where they are, in files."""

import json
import math
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from ..._native import FileError
from ...reading import BROKEN
from ...writing import naming, replacing
from .digests import of_document, of_file, of_text
from .grids import State, state_of
from .patches import Floats, Patch, Place, check_density
from .streams import Column, Stream, open_stream

ABOUT = "mesh.json"
BUCKET = 20_000  # faces that are read at once
Span = tuple[float, float]


@dataclass(frozen=True)
class SortedMesh:
    """A mesh in a folder: arrays of npy, faces bucket by bucket, and what else there is as JSON.

    A bucket holds the faces with their middle in a rectangle of a grid over the bounding box.
    """

    folder: str

    @cached_property
    def about(self) -> dict[str, Any]:
        """Name, numbers of vertices and faces, axes, bounds, the grid, where the density is, and
        digests: of the arrays, and of the file that they are from."""
        found: dict[str, Any] = json.loads((Path(self.folder) / ABOUT).read_text("utf-8"))
        return found

    @property
    def face_count(self) -> int:
        """Number of faces of the whole mesh."""
        count: int = self.about["faces"]
        return count

    @property
    def axes(self) -> tuple[int, int]:
        """The two longest axes of the mesh."""
        first, second = self.about["axes"]
        return first, second

    def lines(self, rows: int, columns: int) -> tuple[Floats, Floats]:
        """Borders at equal distances."""
        lower, upper = self.about["bounds"]
        first, second = (
            np.linspace(a, b, n + 1) for a, b, n in zip(lower, upper, (rows, columns), strict=True)
        )
        return first, second

    def read(self, rows: Span, columns: Span) -> Patch:
        """All faces of the buckets that reach between the borders."""
        starts = self._array("starts")
        chosen = [slice(starts[b], starts[b + 1]) for b in self._buckets(rows, columns)]
        ids = np.concatenate([np.empty(0, np.int64), *(self._array("ids")[s] for s in chosen)])
        faces = [np.empty((0, 3), np.int32), *(self._array("faces")[s] for s in chosen)]
        order = np.argsort(ids)
        used, corners = np.unique(np.concatenate(faces)[order], return_inverse=True)
        at: Place = "faces" if self.about["density"] == "faces" else "vertices"
        density = None
        if self.about["density"]:
            density = self._array("density")[ids[order] if at == "faces" else used]
        local = corners.reshape(-1, 3).astype(np.int32)
        return Patch(self._array("vertices")[used], local, ids[order], density, at)

    def _buckets(self, rows: Span, columns: Span) -> Iterator[int]:
        shape = self.about["shape"]
        spans = []
        for k, border in enumerate((rows, columns)):
            lower, upper = self.about["bounds"][0][k], self.about["bounds"][1][k]
            ends = _bucket(np.array(border), (lower, upper), shape[k])
            spans.append(range(ends[0], ends[1] + 1))
        return (r * shape[1] + c for r in spans[0] for c in spans[1])

    def _array(self, name: str) -> NDArray:
        path = Path(self.folder) / f"{name}.npy"
        return _mapped(path, state_of(path))

    def describe(self) -> dict[str, Any]:
        """What tells it from another mesh."""
        names = ("name", "vertices", "faces", "density", "content")
        return {"kind": "mesh", **{name: self.about[name] for name in names}}


@lru_cache(maxsize=64)
def _mapped(path: Path, _state: State) -> NDArray:
    found: NDArray = np.load(path, mmap_mode="r", allow_pickle=False)
    return found


def _bucket(values: Floats, span: Span, count: int) -> NDArray[np.int64]:
    """Index of the part of a span, cut into equal parts, that holds each value; clamped."""
    length = span[1] - span[0]
    if not length > 0.0:
        return np.zeros(len(values), np.int64)
    parts = np.floor((values - span[0]) / length * count)
    return np.clip(parts, 0, count - 1).astype(np.int64)


def sorted_mesh(path: Path, folder: Path) -> SortedMesh:
    """The mesh of a file, sorted in a folder unless it is there, from the same file and whole.

    Raises:
        ValueError: naming the file and what is wrong with it.
        OSError: naming what is missing or could not be written.
    """
    source = _source_digest(path)
    if not _is_sorted(folder, source):
        part = folder.with_name(f".{uuid4().hex}.part")
        part.mkdir(parents=True)
        try:
            _sort(path.name, source, open_stream(path), part)
            _exchange(part, folder)
        except FileError as error:  # its message names the file
            raise ValueError(str(error)) from error
        except BROKEN as error:
            raise ValueError(f"{path}: {error}") from error
        finally:
            shutil.rmtree(part, ignore_errors=True)
    return SortedMesh(str(folder.absolute()))


def _source_digest(path: Path) -> str:
    """Digest of a file; empty for glTF text, whose data may be in other files."""
    return "" if path.suffix.lower() == ".gltf" else of_file(path)


def _is_sorted(folder: Path, source: str) -> bool:
    """Whether a folder has all that was sorted into it, from a file of this digest."""
    mesh = SortedMesh(str(folder))
    try:
        about = mesh.about
        if of_document(about) != about["digest"] or not source or about["source"] != source:
            return False
        return all(
            of_file(folder / f"{name}.npy") == digest for name, digest in about["files"].items()
        )
    except (OSError, *BROKEN):
        return False


def _exchange(part: Path, folder: Path) -> None:
    """Give a folder the place of another one, if there is one."""
    if folder.exists():
        old = folder.with_name(f".{uuid4().hex}.part")
        folder.rename(old)
        shutil.rmtree(old, ignore_errors=True)
    part.rename(folder)


def _sort(name: str, source: str, mesh: Stream, folder: Path) -> None:
    vertices = _stored(mesh.vertices, folder / "vertices.npy", np.float64, 3)
    lower, upper = _bounds(vertices)
    first, second = np.sort(np.argsort(upper - lower, kind="stable")[1:])[::-1].tolist()
    axes = (first, second)
    bounds = [[float(lower[a]) for a in axes], [float(upper[a]) for a in axes]]
    shape = _grid_shape(mesh.faces.rows, bounds)
    at = None
    if mesh.density:
        at = _place_of(mesh)
        check_density(_stored(mesh.density, folder / "density.npy", np.float64, 0))
    buckets = _stored(_bucketed(mesh.faces, vertices, axes, bounds, shape),
                      folder / "buckets.npy", np.int32, 0)  # fmt: skip
    _place(mesh.faces, buckets, shape[0] * shape[1], folder)
    (folder / "buckets.npy").unlink()
    files = {file.stem: of_file(file) for file in sorted(folder.glob("*.npy"))}
    content = {"vertices": files["vertices"], "faces": of_text(files["faces"], files["ids"])}
    content |= {"density": files["density"]} if at else {}
    about = {"name": name, "vertices": mesh.vertices.rows, "faces": mesh.faces.rows,
             "axes": list(axes), "bounds": bounds, "shape": list(shape), "density": at,
             "source": source, "files": files, "content": content}  # fmt: skip
    about["digest"] = of_document(about)
    with replacing(folder / ABOUT) as file:
        file.write(json.dumps(about).encode())


def _stored(column: Column, path: Path, kind: type, width: int) -> NDArray:
    """All rows of a column in a file, mapped."""
    stored = _new_array(path, kind, (column.rows, width) if width else (column.rows,))
    start = 0
    for chunk in column.chunks():
        stored[start : start + len(chunk)] = chunk
        start += len(chunk)
    stored.flush()
    return stored


def _new_array(path: Path, kind: type, shape: tuple[int, ...]) -> np.memmap:
    """A new array in a file, mapped.

    Raises:
        OSError: naming the file, if there is no room on the disk, which writing into a map that
            has none would end the process for.
    """
    header = np.lib.format.header_data_from_array_1_0(np.empty(0, kind)) | {"shape": shape}
    with naming(path), path.open("xb") as file:
        np.lib.format.write_array_header_1_0(file, header)
        start, size = file.tell(), int(np.prod(shape)) * np.dtype(kind).itemsize
        file.flush()
        if hasattr(os, "posix_fallocate") and size:
            os.posix_fallocate(file.fileno(), start, size)
        else:
            file.truncate(start + size)
    return np.memmap(path, kind, "r+", start, shape)


def _bounds(vertices: NDArray) -> tuple[Floats, Floats]:
    if len(vertices) == 0:
        raise ValueError("has no vertices")
    lower, upper = vertices.min(axis=0), vertices.max(axis=0)
    if not (np.isfinite(lower).all() and np.isfinite(upper).all()):
        k = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise ValueError(f"vertices[{k}] is not finite: {vertices[k].tolist()}")
    return lower, upper


def _place_of(mesh: Stream) -> Place:
    assert mesh.density
    if mesh.density.rows == mesh.vertices.rows:
        return "vertices"
    if mesh.density.rows == mesh.faces.rows:
        return "faces"
    raise ValueError(
        f"'density' has {mesh.density.rows} numbers, but there are {mesh.vertices.rows} vertices "
        f"and {mesh.faces.rows} faces"
    )


def _grid_shape(faces: int, bounds: list[list[float]]) -> tuple[int, int]:
    height, width = (b - a for a, b in zip(*bounds, strict=True))
    buckets = max(1.0, faces / BUCKET)
    rows = max(1, round(math.sqrt(buckets * height / width))) if width > 0.0 else 1
    return rows, max(1, round(buckets / rows))


def _bucketed(
    faces: Column, vertices: NDArray, axes: tuple[int, int], bounds: list[list[float]],
    shape: tuple[int, int],
) -> Column:  # fmt: skip
    """The bucket of each face."""

    def chunks() -> Iterator[NDArray]:
        checked = 0
        for corners in faces.chunks():
            _check_corners(corners, len(vertices), checked)
            checked += len(corners)
            parts = []
            for k, axis in enumerate(axes):
                a, b, c = (vertices[corners[:, j], axis] for j in range(3))
                parts.append(_bucket((a + b + c) / 3.0, (bounds[0][k], bounds[1][k]), shape[k]))
            yield parts[0] * shape[1] + parts[1]

    return Column(faces.rows, chunks)


def _check_corners(corners: NDArray, vertices: int, first: int) -> None:
    wrong = np.flatnonzero(((corners < 0) | (corners >= vertices)).any(axis=1))
    if len(wrong):
        named = f"faces[{first + wrong[0]}] is {corners[wrong[0]].tolist()}"
        raise ValueError(f"{named}: there are {vertices} vertices")


def _place(faces: Column, buckets: NDArray, count: int, folder: Path) -> None:
    """Write the faces bucket by bucket, in a bucket in their own order."""
    starts = np.concatenate([[0], np.bincount(buckets, minlength=count).cumsum()])
    with naming(folder / "starts.npy"):
        np.save(folder / "starts.npy", starts, allow_pickle=False)
    ids = _new_array(folder / "ids.npy", np.int64, (faces.rows,))
    sorted_faces = _new_array(folder / "faces.npy", np.int32, (faces.rows, 3))
    filled = starts[:-1].copy()
    done = 0
    for corners in faces.chunks():
        theirs = buckets[done : done + len(corners)]
        order = np.argsort(theirs, kind="stable")
        counts = np.bincount(theirs, minlength=count)
        before = np.concatenate([[0], counts.cumsum()[:-1]])
        places = (filled - before)[theirs[order]] + np.arange(len(order))
        ids[places] = done + order
        sorted_faces[places] = corners[order]
        filled += counts
        done += len(corners)
    ids.flush()
    sorted_faces.flush()
