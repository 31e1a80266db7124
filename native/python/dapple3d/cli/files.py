# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are read and written: errors name the file."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click
from numpy.typing import NDArray

from dapple3d import reading
from dapple3d.reading import BROKEN

Arrays = dict[str, NDArray]


@contextmanager
def about(path: Path | str) -> Iterator[None]:
    """Prefix the message of a ValueError with the name of the file."""
    try:
        yield
    except ValueError as error:
        raise click.ClickException(f"{path}: {' '.join(str(error).split())}") from error


def check_outputs(inputs: Iterable[Path | None], outputs: Iterable[Path | None]) -> None:
    """Refuse outputs, before the work, that cannot be written or would destroy an input.

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
            raise click.ClickException(f"{path}: is a folder that exists already")
        written.append(path.resolve())


@contextmanager
def _reading(path: Path, form: str) -> Iterator[None]:
    """Report the exceptions of numpy and zipfile for a broken file as ClickException."""
    try:
        yield
    except FileNotFoundError:
        raise
    except (OSError, *BROKEN) as error:
        reason = " ".join(str(error).split())
        raise click.ClickException(f"{path}: could not be read as {form}: {reason}") from error


def load_npz(path: Path) -> Arrays:
    """All arrays of an npz file, by name; other entries are skipped.

    Raises:
        ClickException: the file is broken, or holds pickled objects.
    """
    with _reading(path, "npz"):
        return reading.read_npz(path)


def load_npy(path: Path) -> NDArray:
    """The array of an npy file.

    Raises:
        ClickException: the file is broken, or holds pickled objects.
    """
    with _reading(path, "npy"):
        return reading.read_npy(path)


def unknown_format(path: Path) -> str:
    """What is wrong with the extension of a file."""
    return f"unknown format '{path.suffix.lower()}'" if path.suffix else "has no extension"


def quoted(names: Iterable[str]) -> str:
    """Names in quotes."""
    return ", ".join(f"'{name}'" for name in names) or "none"


def listed(formats: Iterable[str]) -> str:
    """The extensions of several formats, in words."""
    *first, last = formats
    return f"{', '.join(first)} or {last}"
