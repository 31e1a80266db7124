# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on changes for a moment and puts back, so that nobody takes it for a change."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy


@dataclass
class _State:
    quiet: bool = False


_state = _State()


def is_quiet() -> bool:
    """Whether current changes are temporary ones of the add-on."""
    return _state.quiet


@contextmanager
def quiet() -> Iterator[None]:
    """Mark changes inside as temporary; earlier changes still count."""
    bpy.context.view_layer.update()
    _state.quiet = True
    try:
        yield
        bpy.context.view_layer.update()
    finally:
        _state.quiet = False
