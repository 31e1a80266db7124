# SPDX-License-Identifier: GPL-3.0-or-later
"""Enable the add-on from this checkout as Blender enables an installed extension."""

import importlib
import sys
from pathlib import Path

import addon_utils
import bpy

ADDON = Path(__file__).resolve().parents[2] / "addon"
MODULE = "bl_ext.dapple_tests.dapple"


def add_repository(folder: Path) -> None:
    """A repository of extensions in folder, holding the add-on as it lies in the checkout."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "dapple").symlink_to(ADDON, target_is_directory=True)
    repos = bpy.context.preferences.extensions.repos
    repo = repos.new(name="Dapple tests", module="dapple_tests", custom_directory=str(folder))
    repo.enabled = True


def enable():
    """Enable the extension; its package."""
    addon_utils.enable(MODULE, default_set=True)
    if not addon_utils.check(MODULE)[1]:
        raise RuntimeError(f"{MODULE} could not be enabled")
    return sys.modules[MODULE]


def disable() -> None:
    """Disable the extension."""
    addon_utils.disable(MODULE, default_set=True)


def part(name: str):
    """Module of the extension, such as part("core.frames")."""
    return importlib.import_module(f"{MODULE}.{name}")
