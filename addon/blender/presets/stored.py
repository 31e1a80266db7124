# SPDX-License-Identifier: GPL-3.0-or-later
"""The contents of presets, and the folder in which they are stored."""

from pathlib import Path
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.settings import presets
from ..base import PACKAGE
from ..scatter.modifier import ensure_modifier, write_instance_inputs


def folder() -> Path:
    """The folder of presets: the one that Blender provides for each extension."""
    try:
        return Path(bpy.utils.extension_path_user(PACKAGE, path="presets"))
    except ValueError:  # imported by a script, not installed
        return Path(bpy.utils.user_resource("CONFIG"), "dapple", "presets")


def values_of(obj: bpy.types.Object) -> presets.Values:
    """The values of a scatter that a preset stores."""
    values: presets.Values = {
        group: _values(_group(obj, group), names) for group, names in presets.NAMES.items()
    }
    if obj.dapple.object_types:
        values[presets.CLASSES] = [
            _values(kind, presets.CLASS_NAMES) for kind in obj.dapple.object_types
        ]
    return values


def apply(obj: bpy.types.Object, values: presets.Values) -> None:
    """Set the values of a preset; ScatterError naming the first value of a wrong type.

    Then nothing is set. Object types keep their objects: those of the type with the same name,
    otherwise of the next one in order. Without types in the preset the existing types stay.
    """
    before = values_of(obj)
    try:
        for own in values.get(presets.CLASSES, ()):
            _check(own)
        _set(obj, values)
    except (TypeError, ValueError) as error:
        _set(obj, {group: before[group] for group in presets.NAMES})
        raise ScatterError(f"The preset does not fit: {error}") from error
    if values.get(presets.CLASSES):
        _set_types(obj, values[presets.CLASSES])


def _set(obj: bpy.types.Object, values: presets.Values) -> None:
    for group in presets.NAMES:
        for name, value in values.get(group, {}).items():
            setattr(_group(obj, group), name, value)


def _check(own: dict[str, Any]) -> None:
    """Raise TypeError for a value that no object type can have."""
    known = type_properties()
    for name, value in own.items():
        if not fits(value, known[name]):
            raise TypeError(f"object type '{own.get('name', '')}' cannot have {name} {value!r}")


def type_properties() -> Any:
    """The properties of an object type, by name."""
    scatter = bpy.types.Object.bl_rna.properties["dapple"].fixed_type
    return scatter.properties[presets.CLASSES].fixed_type.properties


def fits(value: Any, known: bpy.types.Property) -> bool:
    """Whether a property can have a value."""
    if known.type == "ENUM":
        return isinstance(value, str) and value in known.enum_items
    if known.type in {"STRING", "BOOLEAN"}:
        return isinstance(value, str if known.type == "STRING" else bool)
    number = isinstance(value, int if known.type == "INT" else (int, float))
    return number and not isinstance(value, bool) and known.hard_min <= value <= known.hard_max


def _set_types(obj: bpy.types.Object, types: list[dict[str, Any]]) -> None:
    kinds = obj.dapple.object_types
    for at, own in enumerate(types):
        kinds.move(_type_for(kinds, at, [one.get("name") for one in types[at:]]), at)
        for name in sorted(own, key="radius".__eq__):  # last: until then bounds may give it
            setattr(kinds[at], name, own[name])
    while len(kinds) > len(types):
        kinds.remove(len(kinds) - 1)
    obj.dapple.object_type_index = min(obj.dapple.object_type_index, len(kinds) - 1)
    ensure_modifier(obj)
    write_instance_inputs(obj)


def _type_for(kinds: Any, at: int, names: list[str | None]) -> int:
    """Index of the existing type that takes the place `at`, for the first of the names; a new one
    if all remaining types have the name of a later one.
    """
    left = range(at, len(kinds))
    same = (k for k in left if kinds[k].name == names[0])
    unnamed = (k for k in left if kinds[k].name not in names)
    found = next(same, next(unnamed, -1))
    if found < 0:
        kinds.add()
    return found if found >= 0 else len(kinds) - 1


def _values(group: bpy.types.PropertyGroup, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: _plain(getattr(group, name)) for name in names}


def _group(obj: bpy.types.Object, name: str) -> bpy.types.PropertyGroup:
    return getattr(obj.dapple, name) if name else obj.dapple


def _plain(value: Any) -> Any:
    """A number with the digits of single precision."""
    return float(f"{value:.7g}") if isinstance(value, float) else value
