# SPDX-License-Identifier: GPL-3.0-or-later
"""The door to the native package, which may be missing or too old."""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import ModuleType

from .errors import MissingPackageError, ScatterError, StoppedError

PACKAGE = "dapple3d"


def package() -> ModuleType:
    """The native package; MissingPackageError says why it cannot be used."""
    try:
        module = importlib.import_module(PACKAGE)
    except ImportError as error:
        raise MissingPackageError(
            f"Dapple's native Python package '{PACKAGE}' cannot be loaded ({error}): "
            "install it for Blender's Python, then enable the add-on again"
        ) from error
    if not hasattr(module, "density"):
        raise MissingPackageError(
            f"Dapple's native Python package '{PACKAGE}' is older than this add-on: "
            "install the one that belongs to it for Blender's Python, then start Blender again"
        )
    return module


@cache
def missing() -> str:
    """Why the native package cannot be used; empty when it can. Asked at every redraw."""
    try:
        package()
    except MissingPackageError as error:
        return str(error)
    return ""


@contextmanager
def named(name: str) -> Iterator[None]:
    """Raise errors of the native package inside as errors of the surface of that name."""
    try:
        yield
    except package().Cancelled as error:
        raise StoppedError("Canceled: nothing was written") from error
    except (ValueError, MemoryError) as error:
        raise ScatterError(f"Surface '{name}': {error}") from error
