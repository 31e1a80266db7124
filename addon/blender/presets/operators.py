# SPDX-License-Identifier: GPL-3.0-or-later
"""Saving, loading and removing presets: the operators and the menu."""

import bpy
from bpy.props import StringProperty

from ...core.settings import presets
from ..base.handlers import Subscriber
from ..base.panel_values import CachedValue
from ..base.step_operators import OPTIONS, AllOrNothing, Status
from ..base.translation import operator_label, translated
from ..scatter.object import is_scatter
from ..surface.polls import writable
from .stored import apply, folder, values_of


class _PresetOperator(AllOrNothing):
    name: StringProperty(name="Name", description="Name of the preset")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object)


class DAPPLE_OT_save_preset(_PresetOperator, bpy.types.Operator):
    """Save the settings of this scatter as a preset. New scatters start with the preset named
    Default"""

    bl_idname = "dapple.save_preset"
    bl_label = "Save Preset"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop(self, "name")
        if self.name in PRESETS.of():
            text = translated("Replaces the preset of this name")
            self.layout.label(text=text, icon="INFO", translate=False)

    def work(self, context: bpy.types.Context) -> None:
        presets.store(folder(), self.name, values_of(context.object))


class DAPPLE_OT_load_preset(_PresetOperator, bpy.types.Operator):
    """Apply the settings of the preset; optimize again to see them"""

    bl_idname = "dapple.load_preset"
    bl_label = "Load Preset"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context)

    def work(self, context: bpy.types.Context) -> None:
        apply(context.object, presets.load(folder(), self.name))


class DAPPLE_OT_remove_preset(_PresetOperator, bpy.types.Operator):
    """Delete the preset file"""

    bl_idname = "dapple.remove_preset"
    bl_label = "Remove Preset"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return True  # a preset is of no object

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        return context.window_manager.invoke_confirm(
            self,
            event,
            title=translated("Delete the preset?"),
            message=translated("The file of '{name}' will be deleted from disk", name=self.name),
            confirm_text=operator_label(self.bl_label),
            icon="WARNING",
        )

    def work(self, context: bpy.types.Context) -> None:
        presets.remove(folder(), self.name)


class DAPPLE_MT_presets(bpy.types.Menu):
    """Saved presets"""

    bl_label = "Presets"

    def draw(self, context: bpy.types.Context) -> None:
        found = PRESETS.of()
        if is_scatter(context.object):
            for name in found:
                load = DAPPLE_OT_load_preset.bl_idname
                self.layout.operator(load, text=name, translate=False).name = name
            if found:
                self.layout.separator()
            self.layout.operator(DAPPLE_OT_save_preset.bl_idname, icon="ADD")
            save = self.layout.operator(DAPPLE_OT_save_preset.bl_idname, text="Save as Default")
            save.name = presets.DEFAULT
            self.layout.separator()
            self.layout.operator("dapple.mark_asset", icon="ASSET_MANAGER")
        draw_removal(self.layout)


def draw_presets(row: bpy.types.UILayout) -> None:
    """Draw the button that opens the menu."""
    PRESETS.of()  # requested early, since an opened menu is drawn only once
    row.menu(DAPPLE_MT_presets.__name__, text="", icon="PRESET")


def draw_removal(layout: bpy.types.UILayout) -> None:
    """Draw a button to remove each preset."""
    for name in PRESETS.of():
        text = translated("Remove '{name}'", name=name)
        remove = layout.operator(DAPPLE_OT_remove_preset.bl_idname, text=text, icon="TRASH")
        remove.name = name


def _presets(_: None) -> tuple[str, ...]:
    return tuple(presets.names(folder()))


PRESETS = CachedValue(_presets, ())  # names


def _know_names() -> None:
    """Find the names of presets before a menu is opened."""
    PRESETS.of()


SUBSCRIBER = Subscriber(enabled=_know_names)


CLASSES = (
    DAPPLE_OT_save_preset,
    DAPPLE_OT_load_preset,
    DAPPLE_OT_remove_preset,
    DAPPLE_MT_presets,
)
