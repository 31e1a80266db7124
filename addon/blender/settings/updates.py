# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows when a setting is changed."""

import bpy

from ..data.modifier import write_instance_inputs, write_warning
from ..status import freshness
from ..viewport import overlay


def instance_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of what is placed."""
    write_instance_inputs(settings.id_data)


def settings_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of what a result was solved with."""
    write_warning(settings.id_data)
    overlay.touch(settings.id_data)
    freshness.touch(settings.id_data)
