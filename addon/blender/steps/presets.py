# SPDX-License-Identifier: GPL-3.0-or-later
"""What a preset keeps of a scatter, and the folder that presets are in."""

from pathlib import Path
from typing import Any

import bpy

from ...core import presets
from ...core.errors import ScatterError
from ..base.extension import PACKAGE


def folder() -> Path:
    """Where an artist's presets are: the folder that Blender gives each extension."""
    try:
        return Path(bpy.utils.extension_path_user(PACKAGE, path="presets"))
    except ValueError:  # imported by a script, not installed
        return Path(bpy.utils.user_resource("CONFIG"), "dapple", "presets")


def values_of(obj: bpy.types.Object) -> presets.Values:
    """What a preset keeps of a scatter."""
    return {
        group: {name: _plain(getattr(_group(obj, group), name)) for name in names}
        for group, names in presets.NAMES.items()
    }


def apply(obj: bpy.types.Object, values: presets.Values) -> None:
    """Set what a preset has; ScatterError naming the first value of another type.

    Nothing is set then.
    """
    before = values_of(obj)
    try:
        _set(obj, values)
    except (TypeError, ValueError) as error:
        _set(obj, before)
        raise ScatterError(f"The preset does not fit: {error}") from error


def _set(obj: bpy.types.Object, values: presets.Values) -> None:
    for group, own in values.items():
        for name, value in own.items():
            setattr(_group(obj, group), name, value)


def _group(obj: bpy.types.Object, name: str) -> bpy.types.PropertyGroup:
    return getattr(obj.dapple, name) if name else obj.dapple


def _plain(value: Any) -> Any:
    """Numbers with the digits that single precision holds."""
    return float(f"{value:.7g}") if isinstance(value, float) else value
