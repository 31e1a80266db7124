# SPDX-License-Identifier: GPL-3.0-or-later
"""Digests of contents: whether what a run goes on with is what it was begun with.

They tell damaged and exchanged files, not forged ones.
"""

import hashlib
import json
import zipfile
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...reading import BROKEN, read_npz
from ...writing import replacing, write_npz

SIZE = 16  # bytes of a digest
BANDS = 16  # bands of a grid: a message can say which of them differ


class DamagedError(ValueError):
    """A file of a run that is broken, or belongs elsewhere."""


def _new() -> Any:
    return hashlib.blake2b(digest_size=SIZE)


def of_text(*texts: str) -> str:
    """Digest of one or more texts, in their order."""
    found = _new()
    for text in texts:
        found.update(f"{len(text)}:{text}".encode())
    return str(found.hexdigest())


def of_arrays(arrays: Mapping[str, ArrayLike], *texts: str) -> str:
    """Digest of arrays with their names, types and shapes, and of texts."""
    found = _new()
    found.update(of_text(*texts).encode())
    for name, values in arrays.items():
        array = np.asanyarray(values)
        found.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        if array.nbytes:
            found.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    return str(found.hexdigest())


def of_file(path: Path) -> str:
    """Digest of the bytes of a file, or of all files in a folder.

    Raises:
        OSError: naming what is missing or cannot be read.
    """
    if path.is_dir():
        below = sorted(file for file in path.rglob("*") if file.is_file())
        parts = [(file.relative_to(path).as_posix(), of_file(file)) for file in below]
        return of_text(*(text for part in parts for text in part))
    with path.open("rb") as file:
        return hashlib.file_digest(file, _new).hexdigest()


def of_grid(grid: Any) -> dict[str, str]:
    """Digests of a grid by bands of rows, which are read one after the other."""
    rows, columns = grid.shape
    ends = np.unique(np.arange(BANDS + 1) * rows // BANDS).tolist()
    found = {}
    for start, end in pairwise(ends):
        band = np.asarray(grid[start:end, 0:columns], np.float64)
        found[f"{start}:{end}"] = of_arrays({"band": band})
    return found


def plain(value: Any) -> Any:
    """The value as JSON returns it: numbers of Python, tuples as lists."""
    return json.loads(json.dumps(value, default=_plain_number))


def _plain_number(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"{value!r} is a {type(value).__name__}, which JSON cannot hold")


def of_document(document: Mapping[str, Any]) -> str:
    """Digest of a JSON document without its entry 'digest'."""
    rest = {name: value for name, value in document.items() if name != "digest"}
    return of_text(json.dumps(rest, sort_keys=True))


def write_checked(path: Path, arrays: Mapping[str, Any], key: str) -> None:
    """Write an npz with the digest of its arrays and of a key, which says what it belongs to."""
    stored = {name: np.asanyarray(values) for name, values in arrays.items()}
    with replacing(path) as file:
        write_npz(file, stored, of_arrays(stored, key))


def read_checked(path: Path, key: str) -> dict[str, NDArray]:
    """The arrays of an npz that was written with the same key.

    Raises:
        DamagedError: naming the file.
        OSError: naming it if it is missing.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            comment = archive.comment
        arrays = read_npz(path)
    except BROKEN as error:
        raise DamagedError(f"{path}: could not be read: {' '.join(str(error).split())}") from error
    if comment.decode("ascii", "replace") != of_arrays(arrays, key):
        raise DamagedError(f"{path}: was changed, or does not belong here")
    return arrays


def is_there(path: Path, key: str) -> bool:
    """Whether there is such a file, whole and with the same key."""
    try:
        read_checked(path, key)
    except (DamagedError, FileNotFoundError):
        return False
    return True


def is_foreign(path: Path) -> bool:
    """Whether there is an npz that write_checked() has not written."""
    try:
        with zipfile.ZipFile(path) as archive:
            return len(archive.comment) != 2 * SIZE
    except (*BROKEN, FileNotFoundError):
        return False
