# SPDX-License-Identifier: GPL-3.0-or-later
"""Placing a scatter from an asset on a surface, without settings that the surface cannot have."""

from dataclasses import dataclass
from typing import Any

import bpy
from mathutils import Matrix

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps
from ..base.all_or_nothing import once_done
from ..base.object_handles import ObjectHandle
from ..base.translation import translated_report
from ..presets.fit import without_missing
from ..presets.stored import apply, values_of
from ..scatter.object import surface_of
from ..solve.optimize import optimize_steps
from ..surface.mesh import evaluated_mesh
from ..surface.values import read_weights
from .marking import empty_mesh


def place(obj: bpy.types.Object, surface: bpy.types.Object) -> str:
    """Give a scatter without points a surface; returns a note of settings that do not fit there.

    The scatter gets its own mesh, as the next scatter of the same asset may use the old one.
    """
    reasons: list[str] = []
    if obj.dapple.surface != surface:
        obj.dapple.surface = surface
    surface_of(obj)
    obj.matrix_world = Matrix()
    _own_mesh(obj)
    if obj.asset_data is not None:
        once_done(obj.asset_clear)
    _fit_density(obj, reasons)
    fit_classes(obj, reasons)
    if not reasons:
        return ""
    return translated_report(
        "Not possible on this surface, skipped: {reasons}", reasons="; ".join(reasons)
    )


def place_steps(context: bpy.types.Context, surface: bpy.types.Object) -> Steps:
    """Place the active scatter and solve it; returns a note of settings that do not fit."""
    handle, before = ObjectHandle(context.object), _AssetState.of(context.object)
    try:
        note = place(context.object, surface)
        yield from optimize_steps(handle)
    except BaseException:
        before.restore(handle)
        raise
    return note


def _own_mesh(obj: bpy.types.Object) -> None:
    before, name = obj.data, obj.data.name
    obj.data = empty_mesh(name)
    once_done(lambda: _remove(before, obj.data))


def _remove(before: bpy.types.Mesh, mesh: bpy.types.Mesh) -> None:
    """Remove the previous mesh from the file if nothing uses it, and give its name to
    the new one.
    """
    if not before.users:
        name = before.name
        bpy.data.meshes.remove(before)
        mesh.name = name


def _fit_density(obj: bpy.types.Object, reasons: list[str]) -> None:
    density = values_of(obj)["density"]
    fitting = without_missing({"density": density}, obj.dapple.surface, bpy.context, reasons)
    for name in density.keys() - fitting.get("density", {}).keys():
        obj.dapple.density.property_unset(name)


def fit_classes(obj: bpy.types.Object, reasons: list[str]) -> None:
    surface = obj.dapple.surface
    for kind in [kind for kind in obj.dapple.object_types if kind.density]:
        try:
            with evaluated_mesh(surface, bpy.context.evaluated_depsgraph_get()) as mesh:
                read_weights(surface, mesh, kind.density)
        except ScatterError as error:
            kind.property_unset("density")
            reasons.append(str(error))


@dataclass(frozen=True)
class _AssetState:
    """The state of a scatter before it was placed."""

    surface: bpy.types.Object | None
    matrix: Matrix
    values: Any
    densities: tuple[str, ...]

    @classmethod
    def of(cls, obj: bpy.types.Object) -> "_AssetState":
        densities = tuple(kind.density for kind in obj.dapple.object_types)
        return cls(obj.dapple.surface, obj.matrix_world.copy(), values_of(obj), densities)

    def restore(self, handle: ObjectHandle) -> None:
        try:
            obj = handle.get()
        except ScatterError:  # it was removed
            return
        obj.dapple.surface, obj.matrix_world = self.surface, self.matrix
        apply(obj, self.values)
        for kind, density in zip(obj.dapple.object_types, self.densities, strict=False):
            kind.density = density
