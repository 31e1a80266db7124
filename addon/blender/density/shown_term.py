# SPDX-License-Identifier: GPL-3.0-or-later
"""The term of a scatter's density that is shown, and its inputs."""

from dataclasses import dataclass, replace

import bpy

from ...core.density.colors import Colored
from ...core.density.counts import values_of
from ...core.settings.density_table import ALL
from ...core.settings.values import Settings
from ..base.translation import item_label, translated
from ..scatter.object import is_scatter, settings_of, surface_of
from ..surface.scene_objects import obstacles_of, own_objects, targets_of
from ..surface.surroundings import read_camera

_FOOT = 0.3048


@dataclass(frozen=True)
class Request:
    """The contents of the colors, as far as they can be looked up quickly."""

    surface: int  # session_uid
    settings: Settings
    density: str  # values of the class that is shown
    alone: bool  # whether the settings are of one term
    camera: bytes = b""


def request_of(obj: bpy.types.Object) -> Request:
    """The current request for a scatter."""
    surface, settings, at = surface_of(obj), settings_of(obj), obj.dapple.object_type_index
    term = obj.dapple.density.shown_term
    alone, density = term != ALL, ""
    if alone:
        settings = replace(settings, density=settings.density.alone(term), object_types=())
    elif 0 <= at < len(settings.object_types):
        density = values_of(settings)[at]
    camera = b""
    if settings.density.use_camera_view:
        camera = read_camera(bpy.context.evaluated_depsgraph_get()).tobytes()
    return Request(surface.session_uid, settings, density, alone, camera)


def watched_by(obj: bpy.types.Object, request: Request) -> frozenset[int]:
    """Data-blocks whose updates may change the colors, by session_uid."""
    surface, density = surface_of(obj), request.settings.density
    found = [surface, surface.data, obj.dapple.density.image]
    if density.avoid_collection:
        avoided = obstacles_of(density.avoid_collection, surface, obj)
        shaped = [one for one in avoided if is_scatter(one) and density.avoid_shape != "DISC"]
        found += [*avoided, *(block for one in shaped for block in own_objects(one))]
    if density.use_camera_view and density.camera_hidden and density.hiding_collection:
        found += obstacles_of(density.hiding_collection, surface, obj)
    for target in targets_of(density, surface, obj):
        found += [target, target.data]
    return frozenset(one.session_uid for one in found if one is not None)


def legend_of(obj: bpy.types.Object, shown: Colored) -> tuple[str, str, str]:
    """What is shown, and the values of the darkest and the brightest color."""
    prop = obj.dapple.density.bl_rna.properties["shown_term"]
    label = item_label(prop, obj.dapple.density.shown_term)
    if not shown.points:
        return label, "0", f"{shown.most:.3g}"
    unit, area = _unit(bpy.context.scene.unit_settings)
    return (
        label,
        "0",
        translated("{most:.3g} points / {unit}", most=shown.most * shown.points * area, unit=unit),
    )


def _unit(units: bpy.types.UnitSettings) -> tuple[str, float]:
    """The unit of area that the scene uses, and its size in square units of Blender."""
    if units.system == "NONE":
        return "1", 1.0
    length = (1.0 if units.system == "METRIC" else _FOOT) / units.scale_length
    return "m\u00b2" if units.system == "METRIC" else "ft\u00b2", length * length
