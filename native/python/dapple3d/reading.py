# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays from files; headers are checked against the size of the file."""

import math
import os
import struct
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import IO, Final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BROKEN",
    "WRONG_ENTRY",
    "check_archive",
    "entry_header",
    "npy_header",
    "read_npy",
    "read_npz",
]

WRONG_ENTRY: Final = (LookupError, TypeError, AttributeError, OverflowError, RecursionError)
"""Raised by a JSON tree with an entry that is missing, of another type, or recursive."""

BROKEN: Final = (
    *(ValueError, EOFError, RuntimeError, SyntaxError, *WRONG_ENTRY),
    *(struct.error, tokenize.TokenError, zipfile.BadZipFile, zlib.error),
)
"""Raised by numpy and zipfile for files that are broken."""

Header = tuple[tuple[int, ...], bool, np.dtype]
MOST_DEFLATED = 1032  # largest ratio of a deflated stream


def npy_header(file: IO[bytes]) -> Header:
    """Shape, whether it is in Fortran order, and type of an array; the file is read up to it.

    Raises:
        ValueError: it is none.
    """
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        return np.lib.format.read_array_header_1_0(file)
    return np.lib.format.read_array_header_2_0(file)


def entry_header(archive: zipfile.ZipFile, name: str) -> Header:
    """Shape, order and type of an array in an archive, checked against the size of its entry.

    Raises:
        ValueError, zipfile.BadZipFile: it is no array, or promises more than it has.
        KeyError: it is not there.
    """
    entry = archive.getinfo(name)
    if entry.file_size > MOST_DEFLATED * (entry.compress_size + 1):
        raise ValueError(f"{name} cannot hold {entry.file_size} bytes in {entry.compress_size}")
    with archive.open(entry) as file:
        return _checked_header(file, entry.file_size, name)


def read_npz(path: Path) -> dict[str, NDArray]:
    """All arrays by name; no more memory is allocated than the file can hold.

    Raises:
        BROKEN: it is, holds objects, or promises more than it has.
        OSError: naming the file.
    """
    with path.open("rb") as file:
        if file.read(len(np.lib.format.MAGIC_PREFIX)) == np.lib.format.MAGIC_PREFIX:
            raise ValueError("it is a single array")
    with zipfile.ZipFile(path) as archive:
        check_archive(archive)
        names = [name for name in archive.namelist() if _is_array(archive, name)]
        for name in names:
            entry_header(archive, name)
    with np.load(path, allow_pickle=False) as found:
        return {name.removesuffix(".npy"): found[name] for name in names}


def _is_array(archive: zipfile.ZipFile, name: str) -> bool:
    with archive.open(name) as file:
        return file.read(len(np.lib.format.MAGIC_PREFIX)) == np.lib.format.MAGIC_PREFIX


def check_archive(archive: zipfile.ZipFile) -> None:
    """Refuse one whose entries cannot all be in its file.

    Raises:
        ValueError: saying so.
    """
    size = os.path.getsize(archive.filename or "")
    if sum(entry.compress_size for entry in archive.infolist()) > size:
        raise ValueError(f"its entries are larger than the {size} bytes of the file")


def read_npy(path: Path) -> NDArray:
    """One array; no more memory is allocated than the file can hold.

    Raises:
        BROKEN: it is, holds objects, or promises more than it has.
        OSError: naming the file.
    """
    with path.open("rb") as file:
        if file.read(2) == b"PK":
            raise ValueError("it holds several arrays")
        file.seek(0)
        _checked_header(file, os.fstat(file.fileno()).st_size, "it")
    found: NDArray = np.load(path, allow_pickle=False)
    return found


def _checked_header(file: IO[bytes], size: int, name: str) -> Header:
    shape, fortran, dtype = npy_header(file)
    promised, there = math.prod(shape) * dtype.itemsize, size - file.tell()
    if promised > there:
        raise ValueError(f"{name} promises {promised} bytes and has {there}")
    return shape, fortran, dtype
