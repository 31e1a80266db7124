# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that Blender calls when something happens to the file, whichever file is open."""

from collections.abc import Callable

import bpy


class Handlers:
    """Functions by the names of Blender's lists of handlers."""

    def __init__(self, **functions: Callable[..., None]) -> None:
        self._functions = functions

    def watch(self) -> None:
        """Have Blender call them, also once another file is opened."""
        for name, function in self._functions.items():
            bpy.app.handlers.persistent(function)
            getattr(bpy.app.handlers, name).append(function)

    def unwatch(self) -> None:
        """Have Blender call them no more; those that it does not call are passed over."""
        for name, function in self._functions.items():
            called = getattr(bpy.app.handlers, name)
            if function in called:
                called.remove(function)
