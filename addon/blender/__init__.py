# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the add-on that touches bpy."""

import bpy

from . import operators, overlay, pictures, presets, preview, properties, ui, workfiles

_CLASSES = (*operators.CLASSES, *presets.CLASSES, *ui.CLASSES)


def register() -> None:
    """Add properties, operators, panel and menu entry."""
    properties.register()
    for cls in _CLASSES:
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
    bpy.types.VIEW3D_MT_mesh_add.remove(ui.draw_add_menu)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
    properties.unregister()
