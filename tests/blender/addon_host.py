# SPDX-License-Identifier: GPL-3.0-or-later
"""Enable the add-on from this checkout as Blender enables an installed extension.

Where DAPPLE_TESTED_ZIP names the zip of scripts/package.sh, that is installed and enabled instead,
with the native package that it brings. Python must find no other one then.
"""

import importlib
import os
import sys
from pathlib import Path

import addon_utils
import bpy

TESTED_ZIP = os.environ.get("DAPPLE_TESTED_ZIP")
CHECKOUT = Path(__file__).resolve().parents[2] / "addon"
MODULE = "bl_ext.dapple_tests.dapple"


def add_repository(folder: Path) -> None:
    """Add a repository of extensions in a folder, with the add-on of the checkout or of the tested
    zip.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not TESTED_ZIP:
        (folder / "dapple").symlink_to(CHECKOUT, target_is_directory=True)
    repos = bpy.context.preferences.extensions.repos
    repo = repos.new(name="Dapple tests", module="dapple_tests", custom_directory=str(folder))
    repo.use_custom_directory = repo.enabled = True
    if TESTED_ZIP:
        bpy.ops.preferences.addon_enable(module="bl_pkg")
        bpy.ops.extensions.package_install_files(
            filepath=TESTED_ZIP, repo=repo.module, enable_on_install=False
        )


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
    """Module of the extension, such as part("core.surface.frames")."""
    return importlib.import_module(f"{MODULE}.{name}")


def registered(name: str):
    """Class of the extension that is registered under a name, such as DAPPLE_OT_bake."""
    return next(kind for kind in part("blender").CLASSES if kind.__name__ == name)


def sources() -> Path:
    """Folder of the enabled extension."""
    return Path(sys.modules[MODULE].__file__).resolve().parent


def check_package() -> None:
    """RuntimeError unless the native package is the one that the tested zip has installed."""
    found = Path(importlib.import_module("dapple3d").__file__)
    if TESTED_ZIP and not found.is_relative_to(bpy.utils.user_resource("EXTENSIONS")):
        raise RuntimeError(f"the native package is not the installed one: {found}")
