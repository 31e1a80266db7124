# SPDX-License-Identifier: GPL-3.0-or-later
"""Temporary changes of the add-on, which must not count as changes of the artist."""

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
    evaluate_changes()
    before, _state.quiet = _state.quiet, True
    try:
        yield
        evaluate_changes()
    finally:
        _state.quiet = before


def evaluate_changes() -> None:
    """Have Blender evaluate changes now, in all view layers that windows show."""
    windows = bpy.context.window_manager.windows
    for layer in [bpy.context.view_layer, *(window.view_layer for window in windows)]:
        layer.update()
