# SPDX-License-Identifier: GPL-3.0-or-later
"""Fitting the Default preset to a surface: values that it cannot have are skipped."""

from collections.abc import Callable, Iterator
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.settings import presets
from ..base.translation import translated_report
from ..surface.mesh import evaluated_mesh, uv_layer
from ..surface.surroundings import check_camera
from ..surface.values import read_weights
from .stored import fits, folder, type_properties


def first_values(
    surface: bpy.types.Object, context: bpy.types.Context
) -> tuple[presets.Values, str]:
    """Settings of new scatters on a surface, and skipped settings of the Default preset.

    Both are empty if no default was saved.
    """
    if presets.DEFAULT not in presets.names(folder()):
        return {}, ""
    try:
        stored = presets.load(folder(), presets.DEFAULT)
    except ScatterError as error:
        return {}, str(error)
    reasons: list[str] = []
    values = without_missing(_valid(stored, reasons), surface, context, reasons)
    return values, left_out_note("; ".join(reasons)) if reasons else ""


def left_out_note(reasons: str) -> str:
    """The message about skipped settings of the Default preset."""
    return translated_report(
        "Preset '{name}' does not fit here, skipped: {reasons}",
        name=presets.DEFAULT,
        reasons=reasons,
    )


def fallbacks(
    preset: presets.Values, chosen: dict[str, Any]
) -> Iterator[tuple[presets.Values, str]]:
    """Values of a preset with fewer and fewer settings, each with the name of what is left out."""
    yield preset, ""
    if not preset:
        return
    bound = {name: value for name, value in preset.get("", {}).items() if name != "attach_to"}
    even = {name: group for name, group in preset.items() if name != "density"}
    if presets.CLASSES in even:
        even[presets.CLASSES] = [{**own, "density": ""} for own in even[presets.CLASSES]]
    if "attach_to" in preset.get("", {}) and "attach_to" not in chosen:
        yield {**preset, "": bound}, translated_report("attachment")
    if even != preset:
        yield even, translated_report("density")
        yield {**even, "": bound}, translated_report("attachment and density")
    yield {}, translated_report("all settings")


def _valid(values: presets.Values, reasons: list[str]) -> presets.Values:
    """The values that a scatter can have; the others are added to the reasons."""
    own = bpy.types.Object.bl_rna.properties["dapple"].fixed_type.properties
    found: presets.Values = {}
    for group in presets.NAMES:
        known = own[group].fixed_type.properties if group else own
        found[group] = _fitting(values.get(group, {}), known, reasons)
    if presets.CLASSES in values:
        found[presets.CLASSES] = [
            _fitting(one, type_properties(), reasons) for one in values[presets.CLASSES]
        ]
    return found


def _fitting(stored: dict[str, Any], known: Any, reasons: list[str]) -> dict[str, Any]:
    """The values that a group of properties can have; the others are added to the reasons."""
    found = {name: one for name, one in stored.items() if fits(one, known[name])}
    reasons += [f"{name} ({one!r})" for name, one in stored.items() if name not in found]
    return found


def without_missing(
    values: presets.Values,
    surface: bpy.types.Object,
    context: bpy.types.Context,
    reasons: list[str],
) -> presets.Values:
    """The values without parts of the density that this surface or scene does not have."""
    density = dict(values.get("density", {}))
    checks: dict[str, Callable[[bpy.types.Mesh], Any]] = {
        "attribute": lambda mesh: read_weights(surface, mesh, density["attribute"]),
        "blocked_areas": lambda mesh: read_weights(surface, mesh, density["blocked_areas"]),
        "use_camera_view": lambda _: check_camera(context.scene),
        "uv_map": lambda mesh: uv_layer(surface, mesh, density["uv_map"]),
    }
    for name in [name for name in checks if density.get(name)]:
        try:
            with evaluated_mesh(surface, context.evaluated_depsgraph_get()) as mesh:
                checks[name](mesh)
        except ScatterError as error:
            del density[name]
            reasons.append(str(error))
    found = {**values, "density": density} if density else dict(values)
    if presets.CLASSES in values:
        found[presets.CLASSES] = [
            _with_density_of(one, surface, context, reasons) for one in values[presets.CLASSES]
        ]
    return found


def _with_density_of(
    own: dict[str, Any], surface: bpy.types.Object, context: bpy.types.Context, reasons: list[str]
) -> dict[str, Any]:
    """The values of an object type, without a density that the surface does not have."""
    if not own.get("density"):
        return own
    try:
        with evaluated_mesh(surface, context.evaluated_depsgraph_get()) as mesh:
            read_weights(surface, mesh, own["density"])
    except ScatterError as error:
        reasons.append(str(error))
        return {name: value for name, value in own.items() if name != "density"}
    return own
