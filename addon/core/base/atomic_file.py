# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written completely or not at all, however the process ends."""

import glob
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path, part: Path) -> Iterator[Path]:
    """Write a part, in the same folder, that takes the place of a file once it is on the disk.

    Raises:
        OSError: the file is as before.
    """
    try:
        yield part
        sync(part, os.O_RDWR)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
    if hasattr(os, "O_DIRECTORY"):  # not on Windows: flush the renaming too
        sync(path.parent, os.O_RDONLY | os.O_DIRECTORY)


def part_of(path: Path) -> Path:
    """A name beside a file that no other process uses, however long that of the file is."""
    return path.with_name(f".{_short(path)}.{os.getpid()}.part{path.suffix}")


def remove_parts(path: Path) -> None:
    """Remove what killed processes have left of a file."""
    for part in path.parent.glob(f".{_short(path)}.*.part{glob.escape(path.suffix)}*"):
        part.unlink(missing_ok=True)


def _short(path: Path) -> str:
    return hashlib.blake2b(os.fsencode(path.name), digest_size=8).hexdigest()


def sync(path: Path, flags: int) -> None:
    handle = os.open(path, flags)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
