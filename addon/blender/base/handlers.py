# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that Blender calls when something happens to the file, whichever file is open."""

from collections.abc import Callable, Mapping

import bpy

Handlers = Mapping[str, Callable[..., None]]  # by the names of Blender's lists


def watch(handlers: Handlers) -> None:
    """Have Blender call them, also once another file is opened."""
    for name, handler in handlers.items():
        bpy.app.handlers.persistent(handler)
        getattr(bpy.app.handlers, name).append(handler)


def unwatch(handlers: Handlers) -> None:
    """Have Blender call them no more; those that it does not call are passed over."""
    for name, handler in handlers.items():
        called = getattr(bpy.app.handlers, name)
        if handler in called:
            called.remove(handler)
