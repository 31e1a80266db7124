# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the core's tables as Blender's properties."""

import inspect
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, TypeVar

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...core.settings.descriptors import DATA_BLOCKS, Changes, Kind, Setting
from ..base.translation import OWN
from ..scatter.object import is_surface
from ..surface.values import matching_names
from .updates import instance_changed, material_changed, settings_changed

STILL: set[str] = set()  # not animatable: update functions do not run during playback
_Class = TypeVar("_Class", bound=type)


def _is_surface(settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return is_surface(obj)


class DAPPLE_PG_material(bpy.types.PropertyGroup):
    """A material of the surface; `name` is shown if the material was deleted."""

    __slots__ = ()  # a misspelled name is an error

    material: PointerProperty(
        name="Material",
        description="Material of the surface",
        type=bpy.types.Material,
        update=material_changed,
    )


def _weight_names(settings: Any, context: bpy.types.Context, text: str) -> list[str]:
    """Names that match the typed text; other names, made by modifiers, can be typed too."""
    return matching_names(settings.id_data.dapple.surface, text)


# The property type of each kind, with arguments for this kind.
_PROPERTIES: dict[Kind, tuple[Callable[..., Any], dict[str, Any]]] = {
    Kind.NUMBER: (FloatProperty, {}),
    Kind.WHOLE: (IntProperty, {}),
    Kind.SWITCH: (BoolProperty, {}),
    Kind.CHOICE: (EnumProperty, {}),
    Kind.VALUES: (StringProperty, {"search": _weight_names, "search_options": {"SUGGESTION"}}),
    Kind.UV_MAP: (StringProperty, {}),
    Kind.OBJECT: (PointerProperty, {"type": bpy.types.Object}),
    Kind.SURFACE: (PointerProperty, {"type": bpy.types.Object, "poll": _is_surface}),
    Kind.IMAGE: (PointerProperty, {"type": bpy.types.Image}),
    Kind.COLLECTION: (PointerProperty, {"type": bpy.types.Collection}),
    Kind.MATERIALS: (CollectionProperty, {"type": DAPPLE_PG_material}),
}
_UPDATES = {
    Changes.INSTANCES: instance_changed,
    Changes.SOLUTION: settings_changed,
    Changes.BAKE: settings_changed,
    Changes.INDIRECTLY: settings_changed,
}


def with_settings(
    settings: Iterable[Setting], updates: Mapping[str, Any] = MappingProxyType({})
) -> Callable[[_Class], _Class]:
    """Give a property group a property for each setting, before its own; some by name have update
    functions of their own.
    """
    return _with(
        {
            one.name: _property(one, updates.get(one.name, _UPDATES.get(one.changes)))
            for one in settings
        }
    )


def with_arguments(settings: Iterable[Setting]) -> Callable[[_Class], _Class]:
    """Give an operator such properties, which have no update functions."""
    return _with({setting.name: _argument(setting) for setting in settings})


def _with(properties: dict[str, Any]) -> Callable[[_Class], _Class]:
    def given(cls: _Class) -> _Class:
        cls.__annotations__ = properties | inspect.get_annotations(cls)
        return cls

    return given


def _property(setting: Setting, update: Any) -> Any:
    make, words = _keywords(setting)
    if setting.kind not in DATA_BLOCKS:
        words["options"] = STILL
    if update is not None and setting.kind is not Kind.MATERIALS:  # each has its own
        words["update"] = update
    return make(**words)


def _argument(setting: Setting) -> Any:
    make, words = _keywords(setting)
    return make(**words)


def _keywords(setting: Setting) -> tuple[Callable[..., Any], dict[str, Any]]:
    """The property type of a setting and its arguments, without Blender's defaults."""
    make, own = _PROPERTIES[setting.kind]
    words = {"name": setting.label, "description": setting.tooltip} | own
    if setting.kind not in DATA_BLOCKS:
        words["default"] = setting.default
    given = {
        "min": setting.low,
        "max": setting.high,
        "soft_min": setting.soft_low,
        "soft_max": setting.soft_high,
        "precision": setting.precision,
        "unit": setting.unit if setting.unit != "NONE" else None,
        "subtype": setting.subtype if setting.subtype != "NONE" else None,
        "items": setting.choices or None,
        "translation_context": OWN if setting.own_words else None,
    }
    return make, words | {name: value for name, value in given.items() if value is not None}
