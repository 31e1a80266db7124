# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written completely or not at all."""

import os
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any
from uuid import uuid4

import numpy as np

__all__ = ["naming", "replacing", "write_npz"]


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """A binary file beside the path that replaces it once everything is written.

    Its name is unique: files left by killed processes, or written by other machines at the same
    time, do not conflict.

    A link stays a link: its target is replaced. Devices and pipes are written into.

    Raises:
        OSError: naming the path.
    """
    with naming(path):
        target = Path(os.path.realpath(path))
        if target.exists() and not target.is_file():
            with target.open("wb") as file:
                yield file
            return
        part = target.with_name(f".{uuid4().hex}.part")  # however long the target's name is
        try:
            with part.open("xb") as file:
                yield file
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Make errors of the system name the path and not the temporary file."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename == str(path):
            raise
        raise OSError(error.errno, os.strerror(error.errno), str(path)) from error


def write_npz(file: IO[bytes], arrays: Mapping[str, Any], comment: str = "") -> None:
    """Write the bytes of numpy.savez, which leaves its archive open when a write fails.

    Args:
        file: where to.
        arrays: by their names.
        comment: of the archive; numpy.load() does not see it.
    """
    with zipfile.ZipFile(file, "w") as archive:
        archive.comment = comment.encode("ascii")
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                np.save(entry, np.asanyarray(values), allow_pickle=False)
