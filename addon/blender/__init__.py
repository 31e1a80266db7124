# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the add-on that touches bpy."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import bpy

from ..core.worker import end_free_threads
from . import copies, ui
from .base import prepared, recent, renders, translation, under_way
from .command import entry
from .live import copied, instanced, modifier_tab, placing, watcher
from .ops import (
    add_operators,
    asset_operators,
    bake_operators,
    export_operators,
    keymaps,
    live_operators,
    operators,
    paint_operators,
    point_operators,
    point_tool,
    scatter_operators,
    subdivision_operators,
    tile_operators,
    tools,
    viewport_operators,
)
from .panels import asset_library, collections, pictures, preferences, preset_operators
from .settings import properties, updates
from .status import freshness, workfiles
from .steps import remembered
from .viewport import overlay, preview

_WITH_CLASSES: tuple[Any, ...] = (
    *(
        add_operators,
        operators,
        tile_operators,
        bake_operators,
        live_operators,
        subdivision_operators,
        viewport_operators,
        tools,
        paint_operators,
        point_operators,
        point_tool,
        scatter_operators,
        asset_operators,
        export_operators,
    ),
    *(preset_operators, ui, asset_library, preferences),
)
_CLASSES = tuple(one for module in _WITH_CLASSES for one in module.CLASSES)
Step = tuple[Callable[[], None], Callable[[], None]]  # what it adds, and what takes that back


def register() -> None:
    """Add properties, operators, panel and menu entry: all of them, or none if one fails.

    Beside another enabled copy of the add-on, wait until that is disabled.
    """
    if copies.other():
        copies.wait(_register)
    else:
        _register()


def unregister() -> None:
    """Take back what register added, in reverse, also when some of that fails."""
    if copies.waits():
        copies.stop()
        return
    with ExitStack() as back:
        back.callback(end_free_threads)
        for _, take_back in _steps():
            back.callback(take_back)
        back.callback(asset_library.unregister)


def _register() -> None:
    with ExitStack() as back:
        for add, take_back in _steps():
            back.callback(take_back)  # before: what fails half-way is taken back too
            add()
        back.pop_all()


def _steps() -> list[Step]:
    first: Any = (translation, properties)
    early: Any = (pictures, prepared, preset_operators, workfiles, freshness, renders, under_way)
    later: Any = (*early, recent, preview)
    edge: Any = (keymaps, point_tool, export_operators, entry)
    last: Any = (overlay, remembered, watcher, placing, modifier_tab, instanced, copied, *edge)
    return [
        *((module.register, module.unregister) for module in first),
        (_follow_settings, updates.followers.clear),
        (_add_classes, _remove_classes),
        *((module.register, module.unregister) for module in (*later, *last)),
    ]


def _follow_settings() -> None:
    updates.followers[:] = [module.touch for module in (overlay, freshness, watcher, placing)]


def _add_classes() -> None:
    for cls in _CLASSES:
        _describe(cls)
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_mesh_add.append(collections.draw_add_menu)


def _remove_classes() -> None:
    bpy.types.VIEW3D_MT_mesh_add.remove(collections.draw_add_menu)
    for cls in filter(properties.is_registered, reversed(_CLASSES)):
        bpy.utils.unregister_class(cls)


def _describe(cls: Any) -> None:
    """Have a tooltip be one line, whatever Python keeps of a docstring's indentation."""
    if issubclass(cls, bpy.types.Operator):
        cls.bl_description = " ".join((cls.__doc__ or "").split())
