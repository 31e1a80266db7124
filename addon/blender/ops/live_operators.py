# SPDX-License-Identifier: GPL-3.0-or-later
"""Giving up what is solved in the background: a cross in the panel, and Esc in the 3D View."""

import bpy

from ..base.job import Status
from ..base.translation import told
from ..live import watcher

_keys: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


class DAPPLE_OT_cancel_update(bpy.types.Operator):
    """Stop the update; the points stay as they are until something is changed again"""

    bl_idname = "dapple.cancel_update"
    bl_label = "Cancel Update"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not watcher.is_active():  # then Esc means what it means without the add-on
            cls.poll_message_set(told("No points are being updated"))
        return watcher.is_active()

    def execute(self, context: bpy.types.Context) -> Status:
        watcher.cancel()
        return {"FINISHED"}


CLASSES = (DAPPLE_OT_cancel_update,)


def register() -> None:
    """Have Esc cancel an update."""
    config = bpy.context.window_manager.keyconfigs.addon
    if config is None:  # in background mode
        return
    keymap = config.keymaps.new(name="3D View", space_type="VIEW_3D")
    _keys.append((keymap, keymap.keymap_items.new("dapple.cancel_update", "ESC", "PRESS")))


def unregister() -> None:
    """Have Esc mean nothing more."""
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
