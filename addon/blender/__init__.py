# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the add-on that touches bpy."""

from typing import Any

import bpy

from . import (
    asset_library,
    operators,
    overlay,
    pictures,
    presets,
    preview,
    properties,
    tools,
    translation,
    ui,
    workfiles,
)

_CLASSES = tuple(
    one for room in (operators, tools, presets, ui, asset_library) for one in room.CLASSES
)


def register() -> None:
    """Add properties, operators, panel and menu entry."""
    translation.register()
    properties.register()
    for cls in _CLASSES:
        _describe(cls)
        bpy.utils.register_class(cls)
    bpy.types.VIEW3D_MT_mesh_add.append(ui.draw_add_menu)
    pictures.register()
    workfiles.register()
    preview.register()
    overlay.register()


def unregister() -> None:
    """Take back what register added, in reverse."""
    overlay.unregister()
    preview.unregister()
    workfiles.unregister()
    pictures.unregister()
    asset_library.unregister()
    bpy.types.VIEW3D_MT_mesh_add.remove(ui.draw_add_menu)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    properties.unregister()
    translation.unregister()


def _describe(cls: Any) -> None:
    """Have a tooltip be one line, whatever Python keeps of a docstring's indentation."""
    if issubclass(cls, bpy.types.Operator):
        cls.bl_description = " ".join((cls.__doc__ or "").split())
