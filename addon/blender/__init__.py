# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the add-on that touches bpy."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import bpy

from ..core.base.steps import end_free_threads
from . import duplicate_addon, keymaps, main_panel, preferences
from .add import copied_surfaces, scatter_list
from .add import operators as add_operators
from .add import panel as add_panel
from .assets import dropped
from .assets import library as assets_library
from .assets import operators as assets_operators
from .bake import operators as bake_operators
from .base import activity, handlers, jobs, operator_jobs, panel_values, recent_objects, translation
from .command import entry
from .density import operators as density_operators
from .density import overlay
from .display import preview
from .export import operators as export_operators
from .freshness import findings, unfinished_bakes
from .hair import operators as hair_operators
from .hand_points import operators as hand_points_operators
from .hand_points import spray_operators, tool
from .object_types import operators as object_types_operators
from .presets import operators as presets_operators
from .remesh import operators as remesh_operators
from .scatter import modifier
from .settings import properties, updates
from .solve import auto_update, figure_images, operators, session_solutions
from .surface import subdivision
from .tiles import operators as tiles_operators

_WITH_CLASSES: tuple[Any, ...] = (
    *(
        add_operators,
        operators,
        tiles_operators,
        hair_operators,
        remesh_operators,
        bake_operators,
        subdivision,
        preview,
        object_types_operators,
        density_operators,
        hand_points_operators,
        spray_operators,
        tool,
        scatter_list,
        assets_operators,
        export_operators,
    ),
    *(presets_operators, main_panel, assets_library, preferences),
)
CLASSES = tuple(one for module in _WITH_CLASSES for one in module.CLASSES)
_LISTENING: tuple[Any, ...] = (  # to Blender's events, in this order
    activity,
    unfinished_bakes,
    panel_values,
    presets_operators,
    findings,
    jobs,
    operator_jobs,
    recent_objects,
    preview,
    overlay,
    session_solutions,
    auto_update,
    dropped,
    modifier,
    object_types_operators,
    copied_surfaces,
)
Step = tuple[Callable[[], None], Callable[[], None]]  # adding a part of the add-on, and removing it


def register() -> None:
    """Add properties, operators, panels and menu entries: all of them, or none if one fails.

    If another copy of the add-on is enabled, wait until that copy is disabled.
    """
    if duplicate_addon.other():
        duplicate_addon.wait(_register)
    else:
        _register()


def unregister() -> None:
    """Remove in reverse order what register added, even if a part of it fails."""
    if duplicate_addon.waits():
        duplicate_addon.stop()
        return
    with ExitStack() as back:
        back.callback(end_free_threads)
        for _, take_back in steps():
            back.callback(take_back)
        back.callback(assets_library.unregister)


def _register() -> None:
    with ExitStack() as back:
        for add, take_back in steps():
            back.callback(take_back)  # before: what fails half-way is taken back too
            add()
        back.pop_all()


def steps() -> list[Step]:
    """The steps of enabling the add-on, each with its reverse."""
    first: Any = (translation, properties)
    listening = [module.SUBSCRIBER for module in _LISTENING]
    menus: Any = (export_operators, remesh_operators, hair_operators)
    last: Any = (figure_images, keymaps, tool, *menus, entry)
    return [
        *((one.register, one.unregister) for one in (*first, handlers)),
        (_follow_settings, updates.followers.clear),
        (_add_classes, _remove_classes),
        *((one.register, one.unregister) for one in (*listening, *last)),
    ]


def _follow_settings() -> None:
    updates.followers[:] = [module.touch for module in (overlay, findings, auto_update, dropped)]


def _add_classes() -> None:
    for cls in CLASSES:
        _describe(cls)
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_mesh_add.append(add_panel.draw_add_menu)


def _remove_classes() -> None:
    bpy.types.VIEW3D_MT_mesh_add.remove(add_panel.draw_add_menu)
    for cls in filter(properties.is_registered, reversed(CLASSES)):
        bpy.utils.unregister_class(cls)


def _describe(cls: Any) -> None:
    """Make the tooltip of an operator a single line, without the indentation of its docstring."""
    if issubclass(cls, bpy.types.Operator):
        cls.bl_description = " ".join((cls.__doc__ or "").split())
