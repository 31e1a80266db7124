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
    """Whether what Blender evaluates now is nobody's change."""
    return _state.quiet


@contextmanager
def quiet() -> Iterator[None]:
    """Have what is changed inside be nobody's change; what was changed before still is one."""
    bpy.context.view_layer.update()
    _state.quiet = True
    try:
        yield
        bpy.context.view_layer.update()
    finally:
        _state.quiet = False
