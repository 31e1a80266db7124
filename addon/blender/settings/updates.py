# SPDX-License-Identifier: GPL-3.0-or-later
"""Update functions of settings."""

import re
from collections.abc import Callable

import bpy

from ...core.settings.edge_table import COUNT, ON_EDGES
from ...core.settings.solver_options import (
    CUSTOM,
    EVENNESS,
    QUALITIES,
    quality_of,
    quality_settings,
)
from ..scatter.modifier import write_instance_inputs, write_warning
from ..scatter.object import is_automatic
from ..scatter.placed_objects import follow_bounds, follow_members, is_listed

followers: list[Callable[[bpy.types.Object], None]] = []  # of changes; registration lists them
_UNNAMED = re.compile(r"(Type|Class) \d+")


def instance_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of settings of the instances."""
    _name(settings)
    follow_members(settings)
    write_instance_inputs(settings.id_data)
    if getattr(settings, "radius_from_bounds", False):
        settings_changed(settings, context)


def _name(settings: bpy.types.PropertyGroup) -> None:
    """Name an object type after its objects, unless the artist has named it."""
    placed, kinds = settings.collection or settings.instance, settings.id_data.dapple.object_types
    if placed is None or not _UNNAMED.fullmatch(settings.name):
        return
    if settings.id_data.override_library is None and placed.name not in kinds:
        settings.name = placed.name


def settings_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of settings that change the solution."""
    _renew_radius(settings)
    write_warning(settings.id_data)
    for follow in followers:
        follow(settings.id_data)


def count_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of the number of points, which somebody has chosen now."""
    settings.default_count = False
    settings_changed(settings, context)


def scatter_on_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of Scatter On: unless a number of points was chosen, edges have their own."""
    if settings.scatter_on == ON_EDGES and not settings.is_property_set("count"):
        settings.count = COUNT
        settings.default_count = True
    elif settings.scatter_on != ON_EDGES and settings.default_count:
        settings.property_unset("count")
        settings.default_count = False
    settings_changed(settings, context)


def material_changed(chosen: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of a material in the density."""
    if chosen.material is not None:
        chosen.name = chosen.material.name
    settings_changed(chosen, context)


def weight_changed(entry: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of the weight of an object in a collection."""
    obj = entry.id_data
    kinds = [kind for kind in (obj.dapple, *obj.dapple.object_types) if kind.use_weights]
    if all(map(is_listed, kinds)):  # otherwise the list is being updated
        write_instance_inputs(obj)
        for kind in obj.dapple.object_types:
            _renew_radius(kind)


def _renew_radius(settings: bpy.types.PropertyGroup) -> None:
    """Update the radius of an object type that follows the bounds of its instances."""
    if getattr(settings, "radius_from_bounds", False):
        follow_bounds(settings, bpy.context.evaluated_depsgraph_get())


def get_auto_update(settings: bpy.types.PropertyGroup) -> bool:
    """The value of Auto Update."""
    return is_automatic(settings.id_data)


def set_auto_update(settings: bpy.types.PropertyGroup, value: bool) -> None:
    """Turn Auto Update on or off."""
    settings.auto_update_mode = "ON" if value else "OFF"
    for follow in followers:
        follow(settings.id_data)


def get_quality(settings: bpy.types.PropertyGroup) -> int:
    """The value of Quality: the preset with the current settings."""
    names = [name for name, *_ in (*QUALITIES, CUSTOM)]
    return names.index(quality_of({one.name: getattr(settings, one.name) for one in EVENNESS}))


def set_quality(settings: bpy.types.PropertyGroup, number: int) -> None:
    """Apply a preset; the choice Custom changes nothing."""
    if number < len(QUALITIES):
        for name, value in quality_settings(QUALITIES[number][0]).items():
            setattr(settings, name, value)
