# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of scatters: operators, the menu, and the folder they are kept in."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy
from bpy.props import StringProperty

from ..core import presets
from ..core.errors import ScatterError
from .job import OPTIONS, Answer
from .library import writable
from .meshio import evaluated_mesh
from .scatter import is_scatter
from .surroundings import check_camera, uv_layer
from .translation import reported, told
from .weights import read_weights

_PACKAGE = __package__.removesuffix(".blender")


def folder() -> Path:
    """Where an artist's presets are: the folder that Blender gives each extension."""
    try:
        return Path(bpy.utils.extension_path_user(_PACKAGE, path="presets"))
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
    values = _met(_valid(stored, reasons), surface, context, reasons)
    return values, left_out("; ".join(reasons)) if reasons else ""


def left_out(reasons: str) -> str:
    """What is said where not all of the Default preset fits."""
    return reported(
        "Preset '{name}' does not fit here, skipped: {reasons}",
        name=presets.DEFAULT,
        reasons=reasons,
    )


def _valid(values: presets.Values, reasons: list[str]) -> presets.Values:
    """The values that a scatter can have; the others are told."""
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


def _met(
    values: presets.Values,
    surface: bpy.types.Object,
    context: bpy.types.Context,
    reasons: list[str],
) -> presets.Values:
    """The values without what a density asks of this surface and scene that is not there."""
    density = dict(values.get("density", {}))
    asked: dict[str, Callable[[bpy.types.Mesh], Any]] = {
        "attribute": lambda mesh: read_weights(surface, mesh, density["attribute"]),
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


def _set(obj: bpy.types.Object, values: presets.Values) -> None:
    for group, own in values.items():
        for name, value in own.items():
            setattr(_group(obj, group), name, value)


def _group(obj: bpy.types.Object, name: str) -> bpy.types.PropertyGroup:
    return getattr(obj.dapple, name) if name else obj.dapple


def _plain(value: Any) -> Any:
    """Numbers with the digits that single precision holds."""
    return float(f"{value:.7g}") if isinstance(value, float) else value


class _PresetOperator:
    report: Callable[[set[str], str], None]

    name: StringProperty(name="Name", description="Name of the preset")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object)

    def work(self, obj: bpy.types.Object | None) -> None:
        """What is done, for the active scatter if it is about one."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> Answer:
        try:
            self.work(context.object)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DAPPLE_OT_save_preset(_PresetOperator, bpy.types.Operator):
    """Save the settings of this scatter as a preset. New scatters start with the preset named
    Default"""

    bl_idname = "dapple.save_preset"
    bl_label = "Save Preset"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Answer:
        return context.window_manager.invoke_props_dialog(self)

    def work(self, obj: bpy.types.Object) -> None:
        presets.store(folder(), self.name, values_of(obj))


class DAPPLE_OT_load_preset(_PresetOperator, bpy.types.Operator):
    """Apply the settings of the preset; optimize again to see them"""

    bl_idname = "dapple.load_preset"
    bl_label = "Load Preset"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context)

    def work(self, obj: bpy.types.Object) -> None:
        apply(obj, presets.load(folder(), self.name))


class DAPPLE_OT_remove_preset(_PresetOperator, bpy.types.Operator):
    """Delete the preset file"""

    bl_idname = "dapple.remove_preset"
    bl_label = "Remove Preset"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return True  # a preset is of no object

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Answer:
        return context.window_manager.invoke_confirm(self, event)

    def work(self, obj: bpy.types.Object | None) -> None:
        presets.remove(folder(), self.name)


class DAPPLE_MT_presets(bpy.types.Menu):
    """Saved presets"""

    bl_label = "Presets"

    def draw(self, context: bpy.types.Context) -> None:
        found = presets.names(folder())
        if is_scatter(context.object):
            for name in found:
                load = DAPPLE_OT_load_preset.bl_idname
                self.layout.operator(load, text=name, translate=False).name = name
            if found:
                self.layout.separator()
            self.layout.operator(DAPPLE_OT_save_preset.bl_idname, icon="ADD")
            save = self.layout.operator(DAPPLE_OT_save_preset.bl_idname, text="Save as Default")
            save.name = presets.DEFAULT
        draw_removal(self.layout)


def draw_removal(layout: bpy.types.UILayout) -> None:
    """A button for each preset that removes it."""
    for name in presets.names(folder()):
        text = told("Remove '{name}'", name=name)
        remove = layout.operator(DAPPLE_OT_remove_preset.bl_idname, text=text, icon="TRASH")
        remove.name = name


CLASSES = (
    DAPPLE_OT_save_preset,
    DAPPLE_OT_load_preset,
    DAPPLE_OT_remove_preset,
    DAPPLE_MT_presets,
)
