# SPDX-License-Identifier: GPL-3.0-or-later
"""Files are written whole or not at all, and errors name the file."""

import os
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import click
import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray]


@contextmanager
def about(path: Path | str) -> Iterator[None]:
    """Put the file's name before what a ValueError says."""
    try:
        yield
    except ValueError as error:
        raise click.ClickException(f"{path}: {' '.join(str(error).split())}") from error


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """A binary file beside the path that takes its place once all is written."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with part.open("xb") as file:
            yield file
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def check_outputs(inputs: Iterable[Path | None], outputs: Iterable[Path | None]) -> None:
    """Refuse, before the work, what could not be written or would destroy an input.

    Raises:
        ClickException: naming the first such output.
    """
    read = [path.resolve() for path in inputs if path]
    written: list[Path] = []
    for path in (path for path in outputs if path):
        if path.resolve() in read:
            raise click.ClickException(f"{path}: is read as an input, so it cannot be written")
        if path.resolve() in written:
            raise click.ClickException(f"{path}: two outputs cannot go into the same file")
        if not path.parent.is_dir():
            raise click.ClickException(f"{path}: the folder {path.parent} does not exist")
        if path.is_dir():
            raise click.ClickException(f"{path}: is a folder")
        written.append(path.resolve())


def load_npz(path: Path) -> Arrays:
    """All arrays of an npz file, by name.

    Raises:
        ClickException: the file is broken, or holds pickled objects.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            if not isinstance(file, np.lib.npyio.NpzFile):
                raise ValueError("is a single array")
            return {name: file[name] for name in file.files}
    except (ValueError, EOFError, zipfile.BadZipFile, AttributeError) as error:
        raise click.ClickException(f"{path}: could not be read as npz: {error}") from error


def load_npy(path: Path) -> NDArray:
    """The array of an npy file.

    Raises:
        ClickException: the file is broken, or holds pickled objects.
    """
    try:
        found = np.load(path, allow_pickle=False)
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        raise click.ClickException(f"{path}: could not be read as npy: {error}") from error
    if not isinstance(found, np.ndarray):
        raise click.ClickException(f"{path}: holds several arrays, a single one (.npy) is needed")
    return found
