# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatter objects: their properties as settings of the core, and their reports."""

from dataclasses import fields

import bpy

from ...core.base.errors import ScatterError
from ...core.settings.density_table import DENSITY
from ...core.settings.descriptors import DATA_BLOCKS, Kind
from ...core.settings.edge_table import ON_EDGES
from ...core.settings.tables import SCATTER
from ...core.settings.values import (
    BakeSettings,
    ClassSettings,
    DensitySettings,
    Settings,
    TileSettings,
)
from ...core.solve.class_counts import largest_scale
from ...core.solve.solve import Report
from ...core.solve.stale import changed_baking, changed_settings
from ...core.surface.records import SCHEMA_KEY
from ..base.translation import Translate, label_of, translated

# Fields of the core's settings and their properties.
_PROPERTIES = {setting.field_name: setting.name for setting in SCATTER}
_DATA_BLOCKS = {one.name: one.kind for one in DENSITY if one.kind in DATA_BLOCKS}
_QUICK = 1000.0  # milliseconds
_COUNTED = ("count", "spacing", "evaluations", "milliseconds", "converged", "measured")
_SURFACE_TYPES = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
_KINDS = {"SURFACE": "NURBS surface", "FONT": "text", "META": "metaball"}  # as menus call them
TO_MESH = "Object > Convert > Mesh makes a mesh of it"  # what to do where a mesh is needed


def is_scatter(obj: bpy.types.Object | None) -> bool:
    """Whether the object was made by Dapple."""
    return obj is not None and obj.type == "MESH" and SCHEMA_KEY in obj.data


def is_unsolved(obj: bpy.types.Object) -> bool:
    """Whether it is a scatter that never had points, such as one from an asset."""
    return is_scatter(obj) and not (obj.dapple.solved_settings or len(obj.data.vertices))


def is_surface(obj: bpy.types.Object | None) -> bool:
    """Whether points can be bound to an object of this type."""
    return obj is not None and obj.type in _SURFACE_TYPES and not is_scatter(obj)


def kind_of(obj: bpy.types.Object) -> str:
    """The type of an object, for errors."""
    return _KINDS.get(obj.type, obj.type.lower())


def is_fluid(obj: bpy.types.Object) -> bool:
    """Whether the faces of a surface change whenever it moves, and in renders."""
    return obj.type == "META"


def surface_of(obj: bpy.types.Object) -> bpy.types.Object:
    """The surface of a scatter; ScatterError if none is chosen, or the object cannot be one."""
    surface = obj.dapple.surface
    if surface is None:
        raise ScatterError(f"Scatter '{obj.name}' has no surface: choose a mesh object")
    if not is_surface(surface):
        kind = "scatter" if is_scatter(surface) else kind_of(surface)
        raise ScatterError(
            f"Surface '{surface.name}' of '{obj.name}' is a {kind}, not a mesh, curve, text "
            "or metaball: choose another object"
        )
    return surface


def check_all_over(obj: bpy.types.Object, instead: str = "") -> None:
    """ScatterError if the points of a scatter are on edges, with what to do instead: by default
    nothing, because no frame has to be solved.
    """
    if obj.dapple.scatter_on == ON_EDGES:
        instead = instead or (
            "its points stay on them while the surface deforms, and need neither a bake nor a "
            "preview"
        )
        raise ScatterError(f"Scatter '{obj.name}' is on edges: {instead}")


def active_surface(context: bpy.types.Context) -> bpy.types.Object | None:
    """The active object, or the surface of the active scatter."""
    obj = context.object
    if is_scatter(obj):
        return obj.dapple.surface
    return obj if is_surface(obj) else None


def is_automatic(obj: bpy.types.Object) -> bool:
    """Whether Auto Update is on for a scatter, or automatic and the scatter is quickly solved."""
    chosen = obj.dapple.auto_update_mode
    return bool(chosen == "ON" or (chosen != "OFF" and obj.dapple.report.milliseconds < _QUICK))


def settings_reason(obj: bpy.types.Object, translate: Translate = translated) -> str:
    """Message that settings have changed since the result was solved; empty if none has."""
    if not obj.dapple.solved_settings:
        return ""
    names = changed_settings(obj.dapple.solved_settings, settings_of(obj))
    if obj.dapple.baked_keys:
        names += changed_baking(obj.dapple.baked_settings, bake_settings_of(obj))
    if obj.dapple.attach_to not in ("AUTO", obj.dapple.attached_to):
        names.append("attach_to")
    return solve_again(obj, settings_changed(names, translate), translate) if names else ""


def settings_changed(names: list[str], translate: Translate = translated) -> str:
    """Message that settings of these names were changed, with their labels."""
    known = bpy.types.Object.bl_rna.properties["dapple"].fixed_type.properties
    listed = ", ".join(label_of(known[_PROPERTIES.get(name, name)], translate) for name in names)
    return translate("Settings were changed ({names})", names=listed)


def rest_note(obj: bpy.types.Object, translate: Translate = translated) -> str:
    """Message why points are automatically attached to the rest position; empty if they are not."""
    surface, chosen = obj.dapple.surface, obj.dapple.attach_to
    if surface is None or chosen != "AUTO" or obj.dapple.attached_to != "REST":
        return ""
    if is_fluid(surface):
        return translate("Metaballs change their faces: points are attached to the nearest places")
    return translate(
        "Viewport and renders have different faces: points are attached to the rest position"
    )


def solve_again(obj: bpy.types.Object, reason: str, translate: Translate = translated) -> str:
    """A reason why a result does not fit, with advice."""
    if obj.dapple.baked_keys:
        return translate("{reason}: bake again", reason=reason)
    return translate("{reason}: optimize again", reason=reason)


def settings_of(obj: bpy.types.Object) -> Settings:
    """The settings of a scatter that the core uses."""
    names = {field.name for field in fields(Settings)} - {"per_area", "object_types", "density"}
    values = {name: getattr(obj.dapple, name) for name in names}
    return Settings(
        **values,
        per_area=obj.dapple.points_per_area if obj.dapple.amount == "PER_AREA" else 0.0,
        object_types=tuple(map(_class_settings, obj.dapple.object_types)),
        density=_density_settings(obj.dapple.density),
    )


def bake_settings_of(obj: bpy.types.Object) -> BakeSettings:
    """The additional settings of a bake."""
    names = [field.name for field in fields(BakeSettings)]
    values = {name: getattr(obj.dapple, _PROPERTIES[name]) for name in names}
    if obj.dapple.population != "KEEP_DENSITY":
        values["fade"] = 0
    return BakeSettings(**values)


def follows_masks(obj: bpy.types.Object) -> bool:
    """Whether a bake uses the density of each frame, which needs frames solved one by one."""
    settings = obj.dapple
    if settings.population == "KEEP_DENSITY":
        one_by_one = not len(settings.object_types)
    else:
        one_by_one = settings.smoothing == "FORWARD"
    return bool(settings.masks == "EACH_FRAME" and one_by_one)


def _density_settings(density: bpy.types.PropertyGroup) -> DensitySettings:
    """Data-blocks are given by their full names, as two files may use the same short name."""
    values = {field.name: getattr(density, field.name) for field in fields(DensitySettings)}
    for name, kind in _DATA_BLOCKS.items():
        if kind is Kind.MATERIALS:
            values[name] = tuple(map(material_name, values[name]))
        else:
            values[name] = values[name].name_full if values[name] else ""
    return DensitySettings(**values)


def material_name(chosen: bpy.types.PropertyGroup) -> str:
    """Full name of a chosen material; the last known name if it was deleted."""
    return str(chosen.material.name_full if chosen.material else chosen.name)


def tile_settings_of(obj: bpy.types.Object) -> TileSettings:
    """The settings of a scatter's tiles."""
    names = [field.name for field in fields(TileSettings)]
    return TileSettings(**{name: getattr(obj.dapple.tiles, name) for name in names})


def _class_settings(kind: bpy.types.PropertyGroup) -> ClassSettings:
    names = {field.name for field in fields(ClassSettings)} - {"max_clearance", "shrinks"}
    values = {name: getattr(kind, name) for name in names} | {"max_clearance": _max_clearance(kind)}
    values["shrinks"] = kind.radius_from_bounds and kind.fit_to_spacing == 1.0
    values |= {"weight": 0.0} if kind.use_count else {"count": 0}
    return ClassSettings(**values)


def _max_clearance(kind: bpy.types.PropertyGroup) -> float:
    """Largest clearance that instances use, before they are scaled; a radius of bounds is after."""
    scale = scale_of(kind) if kind.radius_from_bounds else 1.0
    return float(kind.radius / scale) if scale > 0.0 else 0.0


def scale_of(kind: bpy.types.PropertyGroup) -> float:
    """The largest horizontal scale of instances of an object type."""
    across = max(abs(kind.scale_x), abs(kind.scale_y))
    return largest_scale(kind.scale * across, kind.random_scale_up, kind.density_scale)


def write_report(obj: bpy.types.Object, report: Report) -> None:
    """Show these figures; until points are measured, other figures of the previous points stay."""
    names = [field.name for field in fields(Report)] if report.measured else _COUNTED
    for name in names:
        setattr(obj.dapple.report, name, getattr(report, name))


def copy_report(source: bpy.types.PropertyGroup, target: bpy.types.PropertyGroup) -> None:
    """Copy the figures of a result."""
    for prop in source.bl_rna.properties:
        if not prop.is_readonly and prop.identifier != "name":
            setattr(target, prop.identifier, getattr(source, prop.identifier))
