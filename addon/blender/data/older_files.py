# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of older versions: their settings get the names of today when they are opened."""

from typing import Any

import bpy

from ...core.older_names import RENAMED, rename
from ..base.handlers import Handlers
from ..base.timers import call_off, call_within
from .scatter import is_scatter


def stored_values(group: bpy.types.PropertyGroup) -> Any:
    """Values that a group stores, by name, also those of names that it has no more."""
    if hasattr(group, "bl_system_properties_get"):  # Blender 5.0 has taken them out of the group
        return group.bl_system_properties_get(do_create=True)
    return group


def _renew(*_: Any) -> None:
    for obj in filter(is_scatter, bpy.data.objects):
        for name in RENAMED:
            rename(name, stored_values(getattr(obj.dapple, name) if name else obj.dapple))


def _begin() -> None:
    _renew()


_HANDLERS = Handlers(load_post=_renew, blend_import_post=_renew)


def register() -> None:
    """Watch files being opened, and data-blocks being linked and appended."""
    _HANDLERS.watch()
    call_within(0.0, _begin)  # no file is there yet


def unregister() -> None:
    """Stop watching."""
    call_off(_begin)
    _HANDLERS.unwatch()
