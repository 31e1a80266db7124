# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the Default preset fits a surface: values that it cannot have are left out."""

from collections.abc import Callable
from typing import Any

import bpy

from ...core import presets
from ...core.errors import ScatterError
from ..base.translation import reported
from ..surface.surface_mesh import evaluated_mesh
from ..surface.surroundings import check_camera, uv_layer
from ..surface.weights import read_weights
from .presets import folder


def first_values(
    surface: bpy.types.Object, context: bpy.types.Context
) -> tuple[presets.Values, str]:
    """What new scatters over a surface begin with, and what of the Default preset is left out.

    Nothing where no default was saved.
    """
    if presets.DEFAULT not in presets.names(folder()):
        return {}, ""
    try:
        stored = presets.load(folder(), presets.DEFAULT)
    except ScatterError as error:
        return {}, str(error)
    reasons: list[str] = []
    values = met(_valid(stored, reasons), surface, context, reasons)
    return values, left_out_note("; ".join(reasons)) if reasons else ""


def left_out_note(reasons: str) -> str:
    """What is said where not all of the Default preset fits."""
    return reported(
        "Preset '{name}' does not fit here, skipped: {reasons}",
        name=presets.DEFAULT,
        reasons=reasons,
    )


def _valid(values: presets.Values, reasons: list[str]) -> presets.Values:
    """The values that a scatter can have; the others are added to the reasons."""
    own = bpy.types.Object.bl_rna.properties["dapple"].fixed_type.properties
    found: presets.Values = {}
    for group, stored in values.items():
        known = own[group].fixed_type.properties if group else own
        found[group] = {name: one for name, one in stored.items() if _fits(one, known[name])}
        reasons += [f"{name} ({one!r})" for name, one in stored.items() if name not in found[group]]
    return found


def _fits(value: Any, known: bpy.types.Property) -> bool:
    """Whether a property can have a value."""
    if known.type == "ENUM":
        return isinstance(value, str) and value in known.enum_items
    if known.type in {"STRING", "BOOLEAN"}:
        return isinstance(value, str if known.type == "STRING" else bool)
    number = isinstance(value, int if known.type == "INT" else (int, float))
    return number and not isinstance(value, bool) and known.hard_min <= value <= known.hard_max


def met(
    values: presets.Values,
    surface: bpy.types.Object,
    context: bpy.types.Context,
    reasons: list[str],
) -> presets.Values:
    """The values without what a density asks of this surface and scene that is not there."""
    density = dict(values.get("density", {}))
    asked: dict[str, Callable[[bpy.types.Mesh], Any]] = {
        "attribute": lambda mesh: read_weights(surface, mesh, density["attribute"]),
        "blocked": lambda mesh: read_weights(surface, mesh, density["blocked"]),
        "use_camera": lambda _: check_camera(context.scene),
        "uv_map": lambda mesh: uv_layer(surface, mesh, density["uv_map"]),
    }
    for name in [name for name in asked if density.get(name)]:
        try:
            with evaluated_mesh(surface, context.evaluated_depsgraph_get()) as mesh:
                asked[name](mesh)
        except ScatterError as error:
            del density[name]
            reasons.append(str(error))
    return {**values, "density": density} if density else values
