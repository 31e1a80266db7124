# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups and ready-made scatters as an asset library in the preferences, on request."""

from dataclasses import dataclass
from pathlib import Path

import bpy

from .. import base
from ..base.panel_values import CachedValue
from ..base.step_operators import AllOrNothing
from ..base.translation import translated, translated_report

NAME = "Dapple"
FOLDER = base.FOLDER / "assets"
ASSETS_FILE = "dapple_nodes.blend"


def missing_assets() -> str:
    """Why there is no library to add; empty if there is one."""
    if (FOLDER / ASSETS_FILE).is_file():
        return ""
    return translated(
        "{file} is missing: it is only part of the extension that Blender installs from a zip",
        file=ASSETS_FILE,
    )


def library() -> bpy.types.UserAssetLibrary | None:
    """The entry of the preferences for the assets."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    return next((one for one in libraries if one.path and Path(one.path) == FOLDER), None)


def remove() -> None:
    """Remove the assets from the preferences."""
    found = library()
    if found is not None:
        bpy.context.preferences.filepaths.asset_libraries.remove(found)


class _LibraryOperator(AllOrNothing):
    bl_options = {"INTERNAL"}  # noqa: RUF012 - as Blender wants it


class DAPPLE_OT_add_asset_library(_LibraryOperator, bpy.types.Operator):
    """Add Dapple's ready-made scatters and node groups to the asset libraries in the preferences,
    so that the asset browser shows them"""

    bl_idname = "dapple.add_asset_library"
    bl_label = "Add Asset Library"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if missing_assets():
            cls.poll_message_set(missing_assets())
        return not missing_assets()

    def work(self, context: bpy.types.Context) -> None:
        found = library()
        if found is not None:
            text = translated_report("The asset library '{name}' already exists", name=found.name)
            self.report({"INFO"}, text)
            return
        libraries = context.preferences.filepaths.asset_libraries
        added = libraries.new(name=NAME, directory=str(FOLDER))
        try:
            _append(added)
        except BaseException:
            libraries.remove(added)
            raise
        context.preferences.is_dirty = True
        self.report({"INFO"}, translated_report("Asset library '{name}' added", name=added.name))


def _append(added: bpy.types.UserAssetLibrary) -> None:
    """Set the library to append its assets, since a linked scatter could not be placed."""
    try:
        added.import_method = "APPEND_REUSE"
    except TypeError:  # Blender 5.2 lists it, but takes it no more
        added.import_method = "APPEND"


class DAPPLE_OT_remove_asset_library(_LibraryOperator, bpy.types.Operator):
    """Remove Dapple's ready-made scatters and node groups from the asset browser; what is in use
    stays in its files"""

    bl_idname = "dapple.remove_asset_library"
    bl_label = "Remove Asset Library"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if library() is None:
            cls.poll_message_set(translated("The preferences have no Dapple asset library"))
        return library() is not None

    def work(self, context: bpy.types.Context) -> None:
        remove()
        context.preferences.is_dirty = True


def unregister() -> None:
    """Remove the library if the preferences say so."""
    addon = bpy.context.preferences.addons.get(base.PACKAGE)
    wanted = addon is not None and addon.preferences is not None
    if wanted and addon.preferences.remove_library:
        remove()


@dataclass(frozen=True)
class Assets:
    """Whether the asset library is in the preferences, and why it cannot be added;
    empty if it can.
    """

    there: bool = False
    trouble: str = ""


def _assets(_: None) -> Assets:
    return Assets(library() is not None, missing_assets())


ASSETS = CachedValue(_assets, Assets())


CLASSES = (
    DAPPLE_OT_add_asset_library,
    DAPPLE_OT_remove_asset_library,
)
