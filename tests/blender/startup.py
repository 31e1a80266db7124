# SPDX-License-Identifier: GPL-3.0-or-later
"""Files to begin with: an empty one, and an artist's startup file that has the node groups."""

import functools
from pathlib import Path

import addon_host
import bpy


def empty():
    """An empty scene, as Blender has it."""
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)


def begin():
    """An empty scene in a file that has the node groups of a scatter already.

    Building them takes longer than most tests. They are saved only where a scatter uses them.
    """
    bpy.ops.wm.read_homefile(filepath=str(_with_groups()), load_ui=False)
    for group in bpy.data.node_groups:
        group.use_fake_user = False


@functools.cache
def _with_groups():
    """The startup file, which this process writes once."""
    empty()
    addon_host.part("nodes").ensure_group()
    for group in bpy.data.node_groups:
        group.use_fake_user = True  # unused data-blocks are not saved
    path = Path(bpy.app.tempdir, "dapple_startup.blend")
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path
