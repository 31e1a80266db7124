# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyboard shortcuts. Where an operator cannot run, its key does what it does without
the add-on.
"""

from typing import Any

import bpy

# Name and space of the key map, operator, key, modifiers.
_KEYS: tuple[tuple[str, str, str, str, dict[str, Any]], ...] = (
    ("3D View", "VIEW_3D", "dapple.cancel_update", "ESC", {}),
    ("Mesh", "EMPTY", "dapple.place_point", "RIGHTMOUSE", {"ctrl": True}),
)

_items: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def register() -> None:
    """Add the shortcuts."""
    config = bpy.context.window_manager.keyconfigs.addon
    if config is None:  # in background mode
        return
    for name, space, operator, key, modifiers in _KEYS:
        keymap = config.keymaps.new(name=name, space_type=space)
        _items.append((keymap, keymap.keymap_items.new(operator, key, "PRESS", **modifiers)))


def unregister() -> None:
    """Remove the shortcuts."""
    for keymap, item in _items:
        keymap.keymap_items.remove(item)
    _items.clear()
