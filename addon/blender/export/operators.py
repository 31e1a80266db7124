# SPDX-License-Identifier: GPL-3.0-or-later
"""File > Export: the instances of scatters, for other programs."""

from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from ...core.base.native import missing
from ...core.export import STILL, SUFFIXES
from ..base.step_operators import AllOrNothing, Status
from ..base.translation import translated, translated_count, translated_report
from ..scatter.object import is_scatter
from .points import Written, export_points

FORMATS = (
    (".usdc", "USD", "Universal Scene Description: a PointInstancer, also of many frames"),
    (".usda", "USD (Text)", "Universal Scene Description as text"),
    (".glb", "glTF", "Instances of one frame for game engines and the web"),
    (".tscn", "Godot", "A scene of Godot 4 with one frame; the meshes are in a folder beside it"),
    (".csv", "CSV", "A table with a line for each instance and frame"),
    (".npz", "NumPy", "Arrays for Python scripts"),
)


class DAPPLE_OT_export_points(AllOrNothing, bpy.types.Operator, ExportHelper):
    """Write the instances of the selected scatters to a file for other programs, with the
    instanced objects"""

    bl_idname = "dapple.export_points"
    bl_label = "Export Dapple Points"

    filter_glob: StringProperty(
        name="File Filter",
        description="Files that the file browser shows",
        default=";".join(f"*{suffix}" for suffix in SUFFIXES),
        options={"HIDDEN"},
    )
    format: EnumProperty(name="Format", description="Format of the file", items=FORMATS)
    animation: BoolProperty(
        name="Animation",
        description="All frames of the scene range, instead of the one that is shown",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if missing():
            cls.poll_message_set(missing())
        elif not chosen(context):
            cls.poll_message_set(translated("Select the scatters to export"))
        elif context.mode != "OBJECT":
            cls.poll_message_set(translated("Needs Object Mode"))
        else:
            return True
        return False

    @property
    def filename_ext(self) -> str:
        """The extension that the file browser adds to a name without one."""
        return str(self.format)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Ask for a file; baked scatters are exported with their animation."""
        self.animation = any(obj.dapple.baked_keys for obj in chosen(context))
        return super().invoke(context, event)

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "format")
        row = layout.row()
        row.enabled = self.format not in STILL
        row.prop(self, "animation")

    def work(self, context: bpy.types.Context) -> None:
        path = Path(bpy.path.abspath(self.filepath))
        written = export_points(path, chosen(context), self._frames(context.scene, path))
        for kind, text in _messages(written):
            self.report({kind}, text)

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        return chosen(context)

    def _frames(self, scene: bpy.types.Scene, path: Path) -> list[int]:
        if not self.animation or path.suffix.lower() in STILL:
            return []
        return list(range(scene.frame_start, scene.frame_end + 1))


def chosen(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The selected scatters, otherwise the active one."""
    found = [obj for obj in context.selected_objects if is_scatter(obj)]
    return found or [obj for obj in (context.object,) if is_scatter(obj)]


def _messages(written: Written) -> list[tuple[str, str]]:
    names = ", ".join(path.name for path in written.files)
    messages = [
        (
            "INFO",
            translated_report("{names}: {count:,} instances", names=names, count=written.instances),
        )
    ]
    if written.left_out:
        left = ", ".join(written.left_out)
        messages.append(
            (
                "WARNING",
                translated_report("Left out because they are not meshes: {names}", names=left),
            )
        )
    if written.skewed:
        text = translated_count(
            written.skewed,
            ("{count} instance is skewed by an object's scale: it is written without the skew"),
            (
                "{count} instances are skewed by an object's scale: they are written without "
                "the skew"
            ),
        )
        messages.append(("WARNING", text))
    return messages


def draw_menu(menu: Any, _context: bpy.types.Context) -> None:
    """Draw the entry of File > Export."""
    menu.layout.operator(
        DAPPLE_OT_export_points.bl_idname, text="Dapple Points (.usd/.glb/.tscn/.csv/.npz)"
    )


def register() -> None:
    """Add the entry to the menu."""
    bpy.types.TOPBAR_MT_file_export.append(draw_menu)


def unregister() -> None:
    """Remove the entry."""
    bpy.types.TOPBAR_MT_file_export.remove(draw_menu)


CLASSES = (DAPPLE_OT_export_points,)
